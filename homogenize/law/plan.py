"""The plan of a law: what it is for, and the stretches and sizes at which its unit cells are solved.

Stars and motifs of drawn rods differ in what carries the sizes: the arms of the star, or some lines of the motif. The
sizes of a star are `pattern.design.stars.STAR_SIZES`, lengths first. A star of length 0 has no arms: its cell is the
bare fabric, whatever its other sizes are.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.rods import DrawnLine, Rods
from asterism.pattern.design.rounding import rounded
from asterism.pattern.design.sizing.profiles import Profile, SizingField, sample
from asterism.pattern.design.stars import LENGTH, ROD_SIZE_KEYS, SIZE_KEYS, SIZE_OF, STAR_SIZES, SizeName, StarSize
from asterism.pattern.layout.layout import Layout

# relative difference between numbers of a design and of the law: rounding of the machine
LATTICE_TOLERANCE = 1e-6
# keys of a material that may differ. Without gravity, shapes depend on the ratio of the moduli only; the fabric's own
# stiffnesses are compared over its modulus
FREE_KEYS = {
    "fabric": {
        "stretch",
        "modulus_mpa",
        "shear_modulus_mpa",
        "grain_deg",
        "density_kg_m3",
        "bending_stiffness_n_mm",
    },
    "plastic": {"density_kg_m3"},
}


def same_sites(one: Lattice, other: Lattice) -> bool:
    """Whether two lattices have the same sites, up to their origins and bases."""
    steps = one.vectors @ np.linalg.inv(other.vectors)
    return bool(np.abs(steps - np.rint(steps)).max() < 1e-6 and round(abs(np.linalg.det(steps))) == 1)


def same_values(a: Any, b: Any, part: float = LATTICE_TOLERANCE) -> bool:
    """Whether numbers, also in lists and tables, differ by no more than this part of them.

    >>> same_values([1.0, 2.0], [1.0, 2.0000001]), same_values({"a": 1.0}, {"a": 1.1})
    (True, False)
    """
    if isinstance(a, int | float) and isinstance(b, int | float):
        return math.isclose(a, b, rel_tol=part, abs_tol=1e-12)
    if isinstance(a, list | tuple) and isinstance(b, list | tuple):
        return len(a) == len(b) and all(same_values(one, other, part) for one, other in zip(a, b, strict=True))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(same_values(a[key], b[key], part) for key in a)
    return bool(a == b)


Sizes: TypeAlias = tuple[float, ...]
# of the fabric, the same in x and y or one for each
Stretch: TypeAlias = float | tuple[float, float]
# mm, sizes that differ by less are one node
SAME_SIZE_MM = 1e-6
_EXACT = "use the exact model: asterism simulate"
# without bending, bare fabric has no stiffness or no equilibrium, and the natural curvature of the paper's star jumps
# between 0.027 and 0.079 per mm for mesh edges from 3.5 to 0.8 mm
WITHOUT_BENDING = f"has no law: bare fabric without bending stiffness makes unit cells depend on their mesh; {_EXACT}"


@dataclass(frozen=True)
class Size:
    """A size that a law is a function of."""

    key: SizeName  # of design files
    nodes: Sizes  # mm, increasing
    lines: tuple[int, ...] | None = None  # numbers of the lines of a motif that have it; None for the arms of stars

    @property
    def axis(self) -> StarSize:
        """What a size of this key is like."""
        return SIZE_OF[self.key]

    @property
    def varies(self) -> bool:
        """Whether the law has more than one value of it."""
        return len(self.nodes) > 1


@dataclass(frozen=True, order=True)
class CellTask:
    """One unit cell to solve."""

    stretch: Stretch  # of the fabric
    held_out: bool  # the cell tests the law; the fit does not use it
    sizes: Sizes  # mm, in the order of `LawPlan.sizes`

    @property
    def is_bare(self) -> bool:
        """Whether the star has no arms, so that the cell is the bare fabric."""
        return bool(self.sizes) and self.sizes[0] == 0.0


@dataclass(frozen=True)
class SampleRecord:
    """The result of one unit cell."""

    task: CellTask  # the cell
    label: str  # the cell, for messages
    sample: dict[str, Any] | None  # the responses as plain data; None for a cell without an answer
    failed: str | None  # why the cell has no answer, or does not stand for a sheet, in one line
    seconds: float  # wall time of the cell


class Trait(NamedTuple):
    """A value of a design that its cells depend on."""

    field: str  # of the design file
    kind: str  # "material", "lattice" or "motif"
    value: Any
    words: str  # the value for people, if it is not readable itself


@dataclass(frozen=True)
class LawPlan:
    """The cells of a law."""

    # of one cell. The stretch of its fabric and its `sizes` are replaced; other sizes of lines are numbers.
    design: Design
    sizes: tuple[Size, ...]  # what the law is a function of. Those of stars are `STAR_SIZES`.
    stretches: tuple[Stretch, ...]  # the law has one table for each
    edge_mm: float  # of the cells' mesh
    held_out: int = 0  # number of random cells per stretch that test the law

    @property
    def is_motif(self) -> bool:
        """Whether the law is for a motif of drawn rods, and not for stars."""
        return self.design.rods is not None

    @cached_property
    def axis_nodes(self) -> tuple[Floats, ...]:
        """Increasing nodes of each size; the bare fabric is an arm of length 0."""
        return tuple(np.array([*([0.0] if size.axis is LENGTH else []), *size.nodes]) for size in self.sizes)

    @cached_property
    def limits(self) -> Floats:
        """(2, A) mm, smallest and largest sizes that the law covers."""
        low = [
            min_length(size.nodes, self.design.lattice.spacing_mm) if size.axis is LENGTH else size.nodes[0]
            for size in self.sizes
        ]
        return np.array([low, [size.nodes[-1] for size in self.sizes]])

    @cached_property
    def names(self) -> tuple[str, ...]:
        """A name for each size: its key, and its lines if other lines have another one."""
        keys = [size.key for size in self.sizes]
        return tuple(
            size.key if keys.count(size.key) == 1 else f"{size.key}_of_lines_{'_'.join(map(str, size.lines or ()))}"
            for size in self.sizes
        )

    def named(self, sizes: Sequence[float] | Floats) -> dict[str, float]:
        """Sizes by their `names`."""
        return dict(zip(self.names, map(float, sizes), strict=True))

    def label(self, task: CellTask) -> str:
        """A cell in one line: what differs between the cells of the plan, or all its sizes."""
        shown = [(size, value) for size, value in zip(self.sizes, task.sizes, strict=True) if size.varies]
        parts = [f"stretch {stretch_text(task.stretch)}"] if len(self.stretches) > 1 else []
        for size, value in shown or list(zip(self.sizes, task.sizes, strict=True)):
            parts.append(f"{size.axis.name} {value:.6g} mm")
        return ", ".join(parts) or "the motif"

    def tasks(self) -> list[CellTask]:
        """Every cell, sorted: all combinations of the nodes, the bare fabric, and random ones within their range."""
        fitted = list(product(*(size.nodes for size in self.sizes)))
        if not self.is_motif:
            fitted.append((0.0, *(size.nodes[0] for size in self.sizes[1:])))
        return sorted(
            {
                CellTask(stretch, held_out, sizes)
                for stretch in self.stretches
                for held_out, rows in ((False, fitted), (True, self._test_sizes()))
                for sizes in rows
            }
        )

    def _test_sizes(self) -> list[Sizes]:
        """Sizes of the held-out cells, rounded so that files stay readable.

        Their arms have 1.5 mm at least, unless the law covers shorter or only longer ones.
        """
        low, high = self.limits
        low = np.array(
            [
                max(least, min(1.5, most)) if size.axis is LENGTH else least
                for size, least, most in zip(self.sizes, low, high, strict=True)
            ]
        )
        points = np.random.default_rng(1).random((self.held_out, len(self.sizes)))
        rows = np.clip(np.round(low + points * (high - low), 3), low, high)
        return [tuple(map(float, row)) for row in rows]

    def tasks_for_sizes(self, sizes: Floats, known: Collection[Sizes] = ()) -> list[CellTask]:
        """Those cells of the fit that sizes (n, A) depend on, and those that are known already.

        Each depends on the two nodes around it along each axis, or on the one that it has.
        """
        around = []
        for nodes, column in zip(self.axis_nodes, sizes.T, strict=True):
            lower = np.clip(np.searchsorted(nodes, column + SAME_SIZE_MM) - 1, 0, len(nodes) - 1)
            upper = np.clip(np.searchsorted(nodes, column - SAME_SIZE_MM), 0, len(nodes) - 1)
            around.append((nodes[lower], nodes[upper]))
        wanted = {row for corner in product(*around) for row in zip(*(each.tolist() for each in corner), strict=True)}
        return [
            task
            for task in self.tasks()
            if not task.held_out and (task.is_bare or not task.sizes or task.sizes in wanted or task.sizes in known)
        ]

    def cell_design(self, task: CellTask) -> Design:
        """The design whose unit cell is solved."""
        data = self.design.to_dict()
        data["fabric"]["stretch"] = task.stretch
        for size, value in zip(self.sizes, task.sizes, strict=True):
            places = [data["stars"]] if size.lines is None else [data["rods"]["motif"][line] for line in size.lines]
            for place in places:
                place[size.key] = value
        return Design.from_dict(data)

    def check(self, design: Design) -> None:
        """Compare another design with this plan, but for its stretch.

        Moduli and densities may differ: without gravity, shapes depend on the ratio of the moduli only. Raises
        `ForeignLaw` if the law is for another material, lattice or motif, or for other sizes of some lines. Raises
        `LawError` if designs of this kind have no law.
        """
        if self.is_motif != (design.rods is not None):
            ours, theirs = ("a motif of drawn rods", "stars") if self.is_motif else ("stars", "drawn rods")
            raise ForeignLaw(f"{theirs}: the law is for {ours}", field="rods" if design.rods else "stars")
        if (refused := without_law(design)) is not None:
            raise LawError(str(refused), field=refused.field)
        both = (self._traits(each, design) for each in (self.design, design))
        for known, asked in zip(*both, strict=False):
            # people copy the numbers of a measured material from a printed text; the law is less accurate than this
            tolerance = 2e-3 if known.kind == "material" else LATTICE_TOLERANCE
            if not same_values(known.value, asked.value, tolerance):
                field, other = known.field, f"the law is for another {known.kind}"
                if isinstance(asked.value, list) and not asked.words:  # places of a line
                    raise ForeignLaw(f"{field}: {other}", field=field)
                ours, theirs = known.words or known.value, asked.words or asked.value
                raise ForeignLaw(f"{field} = {theirs}: {other}, of {ours}", field=field)
        if design.rods is not None:
            self.sources(design)

    def _traits(self, design: Design, like: Design) -> Iterator[Trait]:
        """Everything in a design that its cells depend on, except stretches and sizes.

        The traits of two designs are compared in pairs; `like` is the second design of such a comparison.
        """
        fabric, rods = design.fabric, design.rods
        for section, free in FREE_KEYS.items():
            for key, value in getattr(design, section).model_dump(mode="json").items():
                if key not in free:
                    yield Trait(f"{section}.{key}", "material", value, "")
        if rods is None:
            for key, value in _star_lattice(design.lattice, like.lattice).items():
                yield Trait(f"lattice.{key}", "lattice", value, "")
        else:
            lattice = like.lattice if same_sites(design.lattice, like.lattice) else design.lattice
            yield Trait("lattice", "lattice", lattice.vectors.tolist(), "")
        moduli: list[float] = []
        if any(each.fabric.is_orthotropic for each in (self.design, like)):
            moduli = [*(e / fabric.modulus for e in (*fabric.moduli, fabric.shear_modulus)), *fabric.axes.ravel()]
        yield Trait("fabric.modulus_mpa", "material", moduli, fabric.modulus_text)
        bending = [d / fabric.modulus for d in fabric.bending_tensor]
        along, across = f"{bending[0]:.3g}", f"{bending[2]:.3g}"
        words = f"{along if along == across else f'[{along}, {across}]'} mm^3 over the modulus"
        yield Trait("fabric.bending_stiffness_n_mm", "material", bending, words)
        if rods is None:
            return
        yield Trait("rods.motif", "motif", len(rods.motif), f"{len(rods.motif)} lines")
        yield Trait("rods.curve_mm", "motif", rods.curve_mm, "")
        yield Trait("rods.join_mm", "motif", rods.join_mm, "")
        for number, line in enumerate(rods.motif):
            # names are for people; with all faces exchanged, the sheet is the mirror image
            free = {"name", "side", *(size.key for size in self.sizes if number in (size.lines or ()))}
            for key, value in line.model_dump(mode="json").items():
                if key not in free:
                    value = _number(rods, line, key) if key in ROD_SIZE_KEYS else value
                    yield Trait(f"rods.motif[{number}].{key}", "motif", value, "")
            side = "the same face as" if rods.face(line) == rods.face(rods.motif[0]) else "the other face than"
            yield Trait(f"rods.motif[{number}].side", "motif", side, f"{side} line 0")

    def sources(self, design: Design) -> list[SizingField]:
        """The sizing field of a design's motif for each of `sizes`.

        Raises `ForeignLaw` if lines that have a size in common here have different ones.
        """
        rods, fields = design.required_rods, []
        for size in self.sizes:
            lines = size.lines or ()
            own = [rods.size_of(rods.motif[line], size.key) for line in lines]
            if any(each != own[0] for each in own):
                field = f"rods.motif[{lines[0]}].{size.key}"
                raise ForeignLaw(f"{field}: the law is for lines with the same {size.key}", field=field)
            fields.append(own[0])
        return fields

    def sizes_at(self, design: Design, points: Floats) -> Floats:
        """(n, A) mm, sizes of a design's motif at printed points (n, 2) mm, rounded as its rods are.

        Raises `ForeignLaw` as `sources` does.
        """
        columns = [
            rounded(design.required_rods.rounding, size.key, sample(field, points))
            for size, field in zip(self.sizes, self.sources(design), strict=True)
        ]
        return np.stack(columns, axis=-1) if columns else np.empty((len(points), 0))

    def sizes_on(self, design: Design, layout: Layout) -> Floats:
        """(n, A) mm, the sizes that occur on a sheet: of its stars, or along its rods and at its corners.

        Raises `ForeignLaw` as `sources` does.
        """
        if not self.is_motif:
            return law_coordinates(layout, design.lattice.arms)
        points = [rod.points for rod in layout.graph.rods]
        return self.sizes_at(design, np.concatenate([layout.outline, *points, layout.points_on_rods]))

    def to_dict(self) -> dict[str, Any]:
        """Plain data; the inverse of `from_dict`."""
        sizes = [
            {"key": size.key, "nodes": list(size.nodes), **({} if size.lines is None else {"lines": list(size.lines)})}
            for size in self.sizes
        ]
        stretches = [list(each) if isinstance(each, tuple) else each for each in self.stretches]
        return {
            "design": self.design.to_dict(),
            "sizes": sizes,
            "stretches": stretches,
            "edge_mm": self.edge_mm,
            "held_out": self.held_out,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> LawPlan:
        """A plan from plain data.

        Raises `DesignError`, `KeyError`, `TypeError` or `ValueError` if the data are not those of a plan.
        """
        design = Design.from_dict(data["design"])
        sizes = tuple(
            Size(
                each["key"],
                tuple(map(float, each["nodes"])),
                tuple(map(int, each["lines"])) if "lines" in each else None,
            )
            for each in data["sizes"]
        )
        keys = [size.key for size in sizes]
        of_stars = keys == [key for key in SIZE_KEYS if key in keys]
        if not (of_stars if design.rods is None else set(keys) <= {*ROD_SIZE_KEYS}):
            raise ValueError("sizes must be those of stars or rods, in their order")
        if design.rods is None:  # a law that was made before a size was known is for its usual value
            known = {size.key: size for size in sizes}
            sizes = tuple(known.get(size.key) or Size(size.key, (size.usual,)) for size in STAR_SIZES)
        if any((size.lines is None) != (design.rods is None) for size in sizes):
            raise ValueError("sizes and design do not belong together")
        if not all((np.diff([0.0, *size.nodes]) > 0).all() for size in sizes):
            raise ValueError("sizes must be positive and increase")
        stretches = tuple((float(s[0]), float(s[1])) if isinstance(s, list) else float(s) for s in data["stretches"])
        return cls(design, sizes, stretches, float(data["edge_mm"]), int(data["held_out"]))


def without_law(design: Design) -> DesignError | None:
    """Why no law serves a design: bare fabric without bending stiffness, or lines that do not repeat or have stars
    beside them."""
    rods = design.rods
    if rods is not None and not rods.motif:
        return DesignError("rods.motif", f"is missing: lines that do not repeat have no law; {_EXACT}")
    if rods is not None and (rods.on_sheet or design.stars is not None):
        beside = "stars" if design.stars is not None else "rods.draw" if rods.draw else "rods.import"
        return DesignError(beside, f"must be left out: a law is for a motif alone; {_EXACT}")
    if not design.fabric.has_bending:
        return DesignError("fabric.bending", WITHOUT_BENDING, design.fabric.bending)
    return None


def _number(rods: Rods, line: DrawnLine, key: str) -> float | str:
    """A size of a line as it is printed."""
    source = rods.size_of(line, key)
    return "a profile" if isinstance(source, Profile) else float(rounded(rods.rounding, key, np.array([source]))[0])


def stretch_text(stretch: Stretch) -> str:
    """A stretch in words: one number, or those along x and y.

    >>> stretch_text(1.35), stretch_text((1.35, 1.2)), stretch_text((1.2, 1.2))
    ('1.35', '[1.35, 1.2]', '1.2')
    """
    sx, sy = np.broadcast_to(stretch, 2)
    return f"{sx:g}" if same_values(float(sx), float(sy)) else f"[{sx:g}, {sy:g}]"


def _star_lattice(lattice: Lattice, like: Lattice) -> dict[str, Any]:
    """The data of a lattice that shape its cells, those of another one (`like`) where its sites are the same.

    The origin is left out, and the orientation is reduced by the symmetry of star and lattice. A lattice repeats after
    half a turn: stars that are turned by it make the same sheet.
    """
    turn = (lattice.orientation_deg + 1e-7) % (360 / lattice.arms / (1 + lattice.arms % 2)) - 1e-7
    sites = (like if same_sites(lattice, like) else lattice).model_dump(mode="json")
    return {
        "arms": lattice.arms,
        "kind": sites["kind"],
        "spacing_mm": sites["spacing_mm"],
        "vectors_mm": sites["vectors_mm"],
        "orientation_deg": round(turn, 6),
    }


def law_coordinates(layout: Layout, arms: int) -> Floats:
    """(S, L) sizes of the stars of a layout, one column for each of `STAR_SIZES`; whole stars have so many arms.

    Lengths are means over the arms, and arms that the outline cuts away count as length 0. The other sizes are means
    along the arms.
    """

    def sums(of_arms: Floats) -> Floats:
        return np.asarray(np.bincount(layout.arm_star, of_arms, len(layout.centres)))

    length = sums(layout.arm_length) / arms
    share = layout.arm_length / (arms * length[layout.arm_star])
    return np.column_stack([length, *map(sums, (share[:, None] * layout.arm_sections.mean(axis=1)).T)])


def min_length(lengths_mm: Iterable[float], spacing_mm: float) -> float:
    """mm, the shortest arms that a law from cells of these lengths covers; 0 if it covers all.

    >>> min_length([0.0, 3.4, 6.0], 17.3), min_length([0.0, 3.6, 6.0], 17.3)
    (0.0, 3.6)
    """
    first = min((float(length) for length in lengths_mm if length > 0), default=0.0)
    # Up to arms of this length a sheet departs so smoothly from bare fabric that a curve from there to the first cell
    # gives all lengths between: the paper's law without its shorter cells keeps contractions within 0.5 % there for
    # thicknesses from 0.3 mm. Longer arms begin to curl their sheet.
    return first if first > 0.2 * spacing_mm else 0.0
