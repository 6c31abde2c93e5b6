"""The summary of an exact shape, with the range of shapes that prints of its design may have."""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from asterism.results.record import ABSENT, Record, key
from asterism.results.records.shape import ENERGY_ROW, HEIGHT_ROW, SIZE_ROWS, STABLE_ROW, WORK_ROW, ShapeRecord
from asterism.results.words import star_numbers

# the keys of `[spread]` in words
VALUES = {
    "modulus_ratio_factor": "modulus ratio",
    "kappa_bar_error_per_mm": "kappa_bar",
    "stretch_percent": "stretch",
    "bending_factor": "bending stiffness",
    "thickness_error_mm": "thickness",
    "grain_error_deg": "grain",
}


class SpreadEndRecord(Record):
    """The exact shape with one value at an end of its interval, and the others as in the design."""

    value: str = key("Key of `[spread]`.")
    end: int = key("1: the upper end of the interval, -1: its lower end.")
    height_mm: float = key("Height of this shape.")
    distance_percent: float = key("Rms distance from the shape of the design, in percent of the diameter.")
    is_minimum: bool = key("The shape is certified.")
    stars_turned: int = key("Stars that bump to another side than in the shape of the design.")
    comes_back: bool | None = key(
        "With the value of the design again, the shape becomes that of the design. It is computed for the shapes that "
        "are furthest away, and null for others."
    )


class SpreadShareRecord(Record):
    """What one value contributes to the range."""

    value: str = key("Key of `[spread]`.")
    variance_percent: float = key("Share in the variance of the height; all shares together are 100 %.")
    heights_mm: list[float] = key("Height at the lower and at the upper end of its interval.")


class MeasurementRecord(Record):
    """A measurement, and the range of heights that it would leave."""

    name: str = key("What is measured.")
    low_mm: float = key("Height that one print in twenty stays below.")
    high_mm: float = key("Height that one print in twenty exceeds.")


class SpreadRecord(Record):
    """The range of shapes that prints of one design may have."""

    intervals: dict[str, float] = key("The section `[spread]` that was used, with its defaults.")
    height_low_mm: float = key("Height that one print in twenty stays below.")
    height_median_mm: float = key("Median of the height.")
    height_high_mm: float = key("Height that one print in twenty exceeds.")
    size_low_mm: list[float] = key("First two entries of `extent_mm`; one print in twenty is smaller.")
    size_high_mm: list[float] = key("The same; one print in twenty is larger.")
    shares: list[SpreadShareRecord] = key("What each value contributes, the largest first.")
    measurements: list[MeasurementRecord] = key("What measurements would leave of the range, the narrowest first.")
    ends: list[SpreadEndRecord] = key("The shapes that were computed.")
    line_low_mm: list[list[float]] = key(
        "A straight line on the print through the highest point, seen from the side: distance along the ground and "
        "height of its points, in the mean shape of prints with the lower height."
    )
    line_median_mm: list[list[float]] = key("The same of prints with the median of the height.")
    line_high_mm: list[list[float]] = key("The same of prints with the upper height.")
    solves: int = key("Exact shapes that were computed for the range, on the mesh of the shape.")
    wall_s: float = key("Wall time.")

    @property
    def range_in_words(self) -> str:
        """The range of the height, for the table and the picture."""
        low, high = self.height_low_mm, self.height_high_mm
        return f"height {self.height_median_mm:.1f} mm, {low:.1f} to {high:.1f} in nine of ten prints"

    @property
    def best_measurement(self) -> str | None:
        """The measurement that would narrow the range most; None if none is worth it."""
        width = self.height_high_mm - self.height_low_mm
        for best in self.measurements[:1]:
            # a measurement that narrows the range of heights by less than this part is not worth its row in the table
            if best.high_mm - best.low_mm < 0.95 * width:
                before = f"{self.height_low_mm:.1f}-{self.height_high_mm:.1f}"
                return f"{best.name}: would narrow {before} to {best.low_mm:.1f}-{best.high_mm:.1f} mm"
        return None

    def rows_in_words(self) -> dict[str, str]:
        """The rows of the table on the terminal."""
        large = [each for each in self.shares if each.variance_percent >= 1.0]
        parts = ", ".join(f"{VALUES[each.value]} {each.variance_percent:.0f} %" for each in large)
        rows = {"prints": self.range_in_words, "range comes from": parts}
        best = self.best_measurement
        return rows if best is None else rows | {"measure": best}


class ContactRecord(Record):
    """Contact of the sheet with itself."""

    begins_at_mm: float = key("Distance from which parts of the sheet repel each other.")
    closest_possible_mm: float = key("Distance that the contact energy never lets two parts reach.")
    least_distance_mm: float | None = key("Smallest distance of two parts that repel each other; null if none do.")
    pairs: int = key("Pairs of mesh entities that repel each other.")


class LevelRecord(Record):
    """The cost of one mesh of the sequence from coarse to fine."""

    vertices: int = key("Vertices of the mesh.")
    iterations: int = key("Newton iterations on this mesh.")
    factorisations: int = key("Factorisations of the Hessian on this mesh.")
    seconds: dict[str, float] = key("Wall time on this mesh by stage, in s.")
    change_percent: float | None = key("Rms distance to the shape on the mesh before; null for the first mesh.")


class PathStepRecord(Record):
    """One step of the continuation that leads to the shape."""

    step: int = key("0 while the fabric is released; then the step of the pins that take hold.")
    release: float = key("Part of the stretch that is released, from 0 to 1.")
    moved: float = key("Part of their way that the pins of this step have gone, from 0 to 1.")
    vertices: int = key("Vertices of the mesh.")
    energy_n_mm: float = key("Energy at the end of the step.")
    iterations: int = key("Newton iterations of the step.")
    kicks: int = key("Times that the path lost its stability and went on along the unstable direction.")


class MinimumRecord(Record):
    """One of the minima that the starts have reached. A single start records the first four keys it has."""

    file: str = key("Name of the files of this minimum, without their ending.", default=ABSENT)
    energy_n_mm: float = key("Energy of the minimum.")
    is_minimum: bool = key("The minimum is certified.", default=ABSENT)
    stars_up: int = key("Stars that bump to the plastic side.")
    stars_off_branch: int = key("Stars that are not on the side to which the design sends them.", default=ABSENT)
    roll_axis_deg: float | None = key("Axis about which the sheet is rolled, on the print; null if not.")
    starts: int = key("Starts that ended in this minimum.")
    start_names: list[str] = key("Names of these starts.", default=ABSENT)
    default: bool = key("The start that the design asks for ended in this minimum.", default=ABSENT)
    distance_percent: float = key(
        "Rms distance of star centres from the first minimum, up to symmetry.", default=ABSENT
    )
    smallest_eigenvalue: float = key("Smallest eigenvalue of the Hessian, in N/mm.", default=ABSENT)
    vertices: int = key("Vertices of the mesh.", default=ABSENT)
    carried: bool = key("The minimum of the coarse mesh was solved on the fine mesh too.", default=ABSENT)

    def in_words(self, with_stars: bool) -> str:
        """The row of this minimum in the table on the terminal, of a design with or without stars."""
        axis = "" if self.roll_axis_deg is None else f", rolled about {self.roll_axis_deg:.0f} deg"
        away = f"{self.distance_percent:.1f} % away, " if self.distance_percent >= 0.05 else ""
        names = self.get("start_names", [])
        # more starts that end in one minimum are counted in its row of the table
        starts = f"from {' and '.join(names)}" if 0 < len(names) <= 2 else f"{self.starts} starts"
        up = f", {self.stars_up} up" if with_stars else ""
        return f"{self.energy_n_mm:.4f} N mm{up}{axis}; {away}{starts}"


class StartsRecord(Record):
    """The minima to which the starts of the exact model lead."""

    starts: int = key("Starts that were tried.")
    starts_lost: int = key("Starts that ended in no minimum.", default=ABSENT)
    result_is: str = key("Which of the minima is the result, and why.")
    minima_seen: int = key("Distinct minima that were reached on any mesh.")
    minima_not_carried: int = key("Minima among them that only the coarse mesh has seen.", default=ABSENT)
    next_minimum_percent: float | None = key(
        "How much higher the next minimum is, in percent of the energy without that of the weight; negative if a "
        "minimum with stars off their branch is lower; null if there is no other minimum."
    )
    next_minimum_n_mm: float | None = key("The same as an energy.", default=ABSENT)
    symmetries: int = key("Symmetries of the design, the identity included.", default=ABSENT)
    minima: list[MinimumRecord] = key("The minima on the fine mesh. The first one is the result.")
    minima_distance_percent: list[list[float]] = key("Distances of all minima on the fine mesh.", default=ABSENT)
    minima_coarse: list[MinimumRecord] = key("Minima on the coarse mesh, whose energies are others.", default=ABSENT)


class BondRecord(Record):
    """The largest forces between fabric and plastic."""

    peel_n_per_mm: float | None = key(
        "Largest force that pulls the fabric off an arm or drawn rod, for each mm of it and at a right angle to it, as "
        "a mean over two widths; 0 if the fabric presses on all plastic. Null without `fabric.modulus_mpa`, whose "
        "default only sets the scale of a ratio, and without plastic."
    )
    peel_star: int | None = key("Number of the star with that force; null for drawn rods.")
    peel_at_mm: list[float] | None = key("Printed place of that force.")
    shear_n_per_mm: float | None = key("The same in the plane of the bond, largest at the tips of arms.")


class PatternRecord(Record):
    """The plastic of an exact shape, and the sides of its stars."""

    stars_total: int = key("Stars of the design.")
    rods_total: int = key("Rods between nodes: of stars one an arm.", default=ABSENT)
    joints_total: int = key("Corners, branches and crossings of the rods, and ends that meet.", default=ABSENT)
    stars_up: int = key("Stars that bump to the plastic side.")
    stars_down: list[int] = key("Numbers of the stars that bump to the other side.")
    stars_off_branch: list[int] = key("Numbers of the stars that are not on the side to which the design sends them.")


class MeshErrorRecord(Record):
    """What the sequence of meshes shows about the error of an exact shape."""

    mesh_error_percent: float | None = key(
        "Estimated rms distance to the shape on an infinitely fine mesh, in percent of the diameter; null with one "
        "mesh, with two meshes of different forms, and for the paper's hinges, whose stiffness follows the mesh."
    )
    mesh_change_percent: float | None = key("Rms distance to the shape on the next coarser mesh; null with one mesh.")
    mesh_forms_differ: bool = key("The shapes on the last two meshes have different forms.")
    mesh_tolerance_percent: float | None = key("Mesh error at which the search ends; null if the design gives an edge.")


def mesh_error_in_words(record: ExactRecord) -> str:
    """What is known about the mesh error of an exact shape."""
    percent, change = record.mesh_error_percent, record.get("mesh_change_percent")
    if percent is not None:
        return f"about {percent:.1f} % of the diameter"
    if change is None:
        return "not known, one mesh was solved"
    apart = f"{change:.1f} % of the diameter from the next coarser mesh"
    if record.get("mesh_forms_differ"):
        return f"not known, the last two meshes have different forms; {apart}"
    return f"not known, the stiffness of the hinges follows the mesh; {apart}"


def off_branch(record: ExactRecord) -> Iterator[str]:
    """Yield a line if an exact shape has such stars."""
    if off := record.stars_off_branch:
        stars = f"{len(off)} of {record.stars_total} stars of the exact shape {'is' if len(off) == 1 else 'are'}"
        yield f"{stars} not on the side that the design asks for: {star_numbers(off)}"


def _bond(record: ExactRecord) -> str | None:
    if record.peel_n_per_mm is None or record.peel_at_mm is None:
        return None
    x, y = record.peel_at_mm
    place = f"{x:.0f}, {y:.0f} mm" if record.peel_star is None else f"star {record.peel_star}"
    peel, shear = f"{record.peel_n_per_mm:.2g} N/mm at {place}", f"{record.shear_n_per_mm:.2g} N/mm"
    return f"pulls at the plastic with up to {peel}, and with {shear} along it"


def _starts(record: ExactRecord) -> str | None:
    lost = record.get("starts_lost", 0)
    return f"{record.starts}, of which {lost} came to no equilibrium" if lost else None


def _minima(record: ExactRecord) -> dict[str, str] | None:
    """One row for each minimum if several starts were tried."""
    if record.get("starts", 1) < 2:
        return None
    with_stars = record.stars_total > 0
    return {f"minimum {number}": each.in_words(with_stars) for number, each in enumerate(record.minima, 1)}


class ExactRecord(StartsRecord, MeshErrorRecord, BondRecord, PatternRecord, ShapeRecord):
    """The summary of an exact shape.

    Besides the declared keys, the parts of `energy_parts_n_mm` are keys of their own, such as `membrane`.
    """

    model_name = "exact"
    rows: ClassVar = {
        "stars_up": ("stars", lambda r: f"{r.stars_up} of {r.stars_total} up" if r.stars_total else None),
        "rods_total": ("rods", lambda r: None if r.stars_total else f"{r.rods_total}, {r.joints_total} joints"),
        **HEIGHT_ROW,
        "spread": ("prints", lambda record: record.spread.rows_in_words()),
        **SIZE_ROWS,
        "peel_n_per_mm": ("fabric", _bond),
        **ENERGY_ROW,
        "gradient_norm": ("gradient", "{gradient_norm:.1e} N"),
        "smallest_eigenvalue": ("smallest eigenvalue", "{smallest_eigenvalue:.3e} N/mm"),
        **STABLE_ROW,
        "vertices": ("mesh", "{vertices} vertices, {mesh}"),
        "mesh_error_percent": ("mesh error", mesh_error_in_words),
        **WORK_ROW,
        "starts_lost": ("starts", _starts),
        "minima": ("minimum", _minima),
    }

    smallest_eigenvalue: float = key("Smallest eigenvalue of the Hessian in mm and rad, without rigid motions, N/mm.")
    eigenvalue_error: float = key("Norm of the residual of that eigenvalue: a bound of its error.")
    edge_mm: float = key("Edge length of the mesh.")
    self_contact: ContactRecord | None = key(
        "Contact of the sheet with itself; null if parts may pass through another."
    )
    fabric_bending: str = key("Bending energy of the fabric: `paper`, `plate`, `consistent` or `none`.")
    fabric_bending_n_mm: float = key("Energy of the fabric's bending.")
    instabilities_passed: int = key("Times that the path to the shape lost its stability.")
    backend: str = key("Linear solver.")
    levels: list[LevelRecord] = key("Cost of each mesh, the coarsest first.")
    joined_at_vertices: int = key(
        "Vertices of the coarse mesh on which this search reached the state of that from the flat print. It ended "
        "there: on finer meshes both are one, and those of `levels` and `path` cost it nothing.",
        default=ABSENT,
    )
    path: list[PathStepRecord] = key("The way to the shape, step by step.")
    spread: SpreadRecord = key("The range of shapes that prints may have, if it was computed.", default=ABSENT)
