"""What the law of a motif is for: fabric, plastic, lattice and lines, and the sizes over which it is tabulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import WITHOUT_BENDING
from asterism.homogenize.law.same_material import (
    FREE_KEYS,
    LATTICE_TOLERANCE,
    MATERIAL_TOLERANCE,
    check_bending,
    check_same,
    same_sites,
    same_values,
)
from asterism.pattern.design.design import Design
from asterism.pattern.design.rods import DrawnLine, Rods
from asterism.pattern.design.sizing.field import SizingField, sample
from asterism.pattern.design.sizing.profile import Profile

RodSizeKey = Literal["thickness_mm", "width_mm"]
ROD_SIZE_KEYS: tuple[RodSizeKey, ...] = ("thickness_mm", "width_mm")
_EXACT = "use the exact model: asterism simulate"
# parts of a line that no law needs: sizes are compared by themselves, names are for people
_ASIDE = {"name", *ROD_SIZE_KEYS}
# of the random cells that test a law
RANDOM_SEED = 0
TEST_SIZE_DECIMALS = 3


@dataclass(frozen=True)
class MotifSize:
    """A size that some lines of a motif have in common, and the nodes of its cells.

    Attributes
    ----------
    key : of design files.
    lines : numbers of the lines.
    nodes : mm, increasing.
    """

    key: RodSizeKey
    lines: tuple[int, ...]
    nodes: tuple[float, ...]

    @property
    def varies(self) -> bool:
        """Whether the law has more than one value of it."""
        return len(self.nodes) > 1


@dataclass(frozen=True, order=True)
class MotifTask:
    """One unit cell to solve.

    Attributes
    ----------
    held_out : the cell tests the law; the fit does not use it.
    sizes : mm, in the order of `MotifPlan.sizes`.
    """

    held_out: bool
    sizes: tuple[float, ...]


@dataclass(frozen=True)
class MotifPlan:
    """The cells of the law of a motif.

    Attributes
    ----------
    design : of one cell: every line has numbers as its own sizes. Those of `sizes` are replaced.
    sizes : what the law is a function of.
    edge_mm : of the cells' mesh. Sheets that use the law have meshes with the same edge length.
    held_out : number of random cells that test the law.
    """

    design: Design
    sizes: tuple[MotifSize, ...]
    edge_mm: float
    held_out: int = 0

    @property
    def rods(self) -> Rods:
        """The section `[rods]` of the cell."""
        rods = self.design.rods
        assert rods is not None, "a motif has rods"
        return rods

    def tasks(self) -> list[MotifTask]:
        """Every cell: all combinations of the nodes, then random ones within their range."""
        fitted = [MotifTask(False, sizes) for sizes in product(*(size.nodes for size in self.sizes))]
        rng = np.random.default_rng(RANDOM_SEED)
        ends = np.log([[size.nodes[0], size.nodes[-1]] for size in self.sizes]).reshape(-1, 2)
        shares = rng.random((self.held_out, len(self.sizes)))
        places = np.exp(ends[:, 0] + shares * (ends[:, 1] - ends[:, 0]))
        is_fixed = np.array([not size.varies for size in self.sizes], dtype=bool)
        rows = np.where(is_fixed, np.exp(ends[:, 0]), np.round(places, TEST_SIZE_DECIMALS))
        return [*fitted, *(MotifTask(True, tuple(row)) for row in rows.tolist())]

    def cell_design(self, sizes: tuple[float, ...]) -> Design:
        """The design whose unit cell is solved."""
        data = self.design.to_dict()
        for size, value in zip(self.sizes, sizes, strict=True):
            for line in size.lines:
                data["rods"]["motif"][line][size.key] = value
        return Design.from_dict(data)

    def check(self, design: Design) -> None:
        """Compare another design with this plan.

        Moduli and densities may differ: without gravity, shapes depend on the ratio of the moduli only.

        Raises
        ------
        ForeignLaw
            The law is for another material, stretch, lattice or motif, or for other sizes of some lines.
        LawError
            Designs of this kind have no law of a motif.
        """
        rods = motif_alone(design)
        for section, free in FREE_KEYS.items():
            ours, theirs = (getattr(each, section).model_dump(mode="json") for each in (self.design, design))
            check_same(section, ours, theirs, MATERIAL_TOLERANCE, free)
        check_bending(self.design.fabric, design.fabric)
        known, asked = (list(each.fabric.stretch_xy) for each in (self.design, design))
        if not same_values(known, asked):
            problem = f"fabric.stretch = {_stretch(asked)}: the law was made for {_stretch(known)}"
            raise ForeignLaw(problem, field="fabric.stretch")
        if not same_sites(self.design.lattice, design.lattice):
            known, asked = (np.round(each.lattice.vectors, 4).tolist() for each in (self.design, design))
            problem = f"lattice: the law is for another lattice, of the vectors {known}, not {asked}"
            raise ForeignLaw(problem, field="lattice")
        self._check_lines(rods)
        self.sources(design)

    def _check_lines(self, rods: Rods) -> None:
        ours, theirs = self.rods.motif, rods.motif
        if len(ours) != len(theirs):
            raise ForeignLaw(f"rods.motif: the law is for {len(ours)} lines, not {len(theirs)}", field="rods.motif")
        for number, (known, asked) in enumerate(zip(ours, theirs, strict=True)):
            one, other = (each.model_dump(mode="json", exclude=_ASIDE) for each in (known, asked))
            if not same_values(one, other, LATTICE_TOLERANCE):
                field = f"rods.motif[{number}]"
                raise ForeignLaw(f"{field}: the law is for another line", field=field)
        for key in ("curve_mm", "join_mm"):
            known_mm, asked_mm = getattr(self.rods, key), getattr(rods, key)
            if not same_values(known_mm, asked_mm):
                problem = f"rods.{key} = {asked_mm:g}: the law is for {known_mm:g}"
                raise ForeignLaw(problem, field=f"rods.{key}")
        free = {(size.key, line) for size in self.sizes for line in size.lines}
        for key in ROD_SIZE_KEYS:
            for number, line in enumerate(theirs):
                size = source_of(rods, line, key)
                if (key, number) in free:
                    continue
                known_mm = getattr(ours[number], key)
                if isinstance(size, Profile) or not same_values(rounded(rods, key, np.array([size]))[0], known_mm):
                    field = f"rods.motif[{number}].{key}"
                    shown = "a profile" if isinstance(size, Profile) else f"{size:g}"
                    raise ForeignLaw(f"{field} = {shown}: the law is for {known_mm:g}", field=field)

    def sources(self, design: Design) -> list[SizingField]:
        """The sizing field of a design for each of `sizes`.

        Raises
        ------
        ForeignLaw
            Lines that have a size in common here have different ones.
        """
        rods = motif_alone(design)
        fields = []
        for size in self.sizes:
            own = [source_of(rods, rods.motif[line], size.key) for line in size.lines]
            if any(each != own[0] for each in own):
                field = f"rods.motif[{size.lines[0]}].{size.key}"
                raise ForeignLaw(f"{field}: the law is for lines with the same {size.key}", field=field)
            fields.append(own[0])
        return fields

    def sizes_at(self, design: Design, points: Floats) -> Floats:
        """(n, A) mm, sizes of a design's motif at printed points (n, 2) mm, rounded as its rods are.

        Raises
        ------
        ForeignLaw
            As of `sources`.
        """
        rods, fields = motif_alone(design), self.sources(design)
        columns = [
            rounded(rods, size.key, sample(field, points)) for size, field in zip(self.sizes, fields, strict=True)
        ]
        return np.stack(columns, axis=-1) if columns else np.empty((len(points), 0))

    def to_dict(self) -> dict[str, Any]:
        """Plain data; the inverse of `from_dict`."""
        sizes = [{"key": size.key, "lines": list(size.lines), "nodes": list(size.nodes)} for size in self.sizes]
        return {"design": self.design.to_dict(), "sizes": sizes, "edge_mm": self.edge_mm, "held_out": self.held_out}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> MotifPlan:
        """A plan from plain data.

        Raises
        ------
        DesignError, KeyError, TypeError, ValueError
            The data are not those of a plan.
        """
        sizes = tuple(
            MotifSize(_key(each["key"]), tuple(map(int, each["lines"])), tuple(map(float, each["nodes"])))
            for each in data["sizes"]
        )
        return cls(Design.from_dict(data["design"]), sizes, float(data["edge_mm"]), int(data["held_out"]))


def motif_alone(design: Design) -> Rods:
    """The section `[rods]` of a design whose pattern is a motif and nothing else.

    Raises
    ------
    ForeignLaw
        The design has stars alone.
    LawError
        No law serves, see `without_motif_law`.
    """
    if design.rods is None:
        raise ForeignLaw("stars: the law is for a motif of rods, [[rods.motif]]", field="stars")
    if (refused := without_motif_law(design)) is not None:
        raise LawError(": ".join(refused), field=refused[0])
    return design.rods


def without_motif_law(design: Design) -> tuple[str, str] | None:
    """Field and reason, if no law of a motif serves a design with rods: lines that do not repeat, stars, or bare fabric
    without bending stiffness."""
    rods = design.rods
    if rods is None or not rods.motif:
        return "rods.motif", f"is missing: lines that do not repeat have no law; {_EXACT}"
    if rods.on_sheet or design.stars is not None:
        beside = "stars" if design.stars is not None else "rods.draw" if rods.draw else "rods.import"
        return beside, f"must be left out: a law is for a motif alone; {_EXACT}"
    return None if design.fabric.has_bending else ("fabric.bending", WITHOUT_BENDING)


def source_of(rods: Rods, line: DrawnLine, key: RodSizeKey) -> SizingField:
    """The thickness or width of a line: its own, or else that of all lines."""
    own: SizingField | None = getattr(line, key)
    shared: SizingField = getattr(rods, key)
    return shared if own is None else own


def rounded(rods: Rods, key: RodSizeKey, values: Floats) -> Floats:
    """Sizes (...) as they are printed."""
    if rods.rounding is None:
        return values
    return rods.rounding.thickness(values) if key == "thickness_mm" else rods.rounding.width(values)


def _stretch(pair: list[float]) -> str:
    return f"{pair[0]:g}" if same_values(pair[0], pair[1]) else f"[{pair[0]:g}, {pair[1]:g}]"


def _key(name: str) -> RodSizeKey:
    for key in ROD_SIZE_KEYS:
        if key == name:
            return key
    raise ValueError(f"{name} is no size of a line")
