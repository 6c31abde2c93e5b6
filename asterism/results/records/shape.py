"""The summaries of a shape: what those of both models have in common, and that of a preview."""

from __future__ import annotations

from typing import Any, ClassVar

from asterism.results.record import ABSENT, Record, Show, key
from asterism.results.words import VISIBLE_SAG_MM, box_in_words, direction, distance_error, height_error, roll


def _height(record: ShapeRecord) -> str:
    error = record.get("expected_height_percent")
    doubt = "" if error is None else f", give or take {height_error(error, record.height_mm)}"
    return f"{record.height_mm:.2f} mm{doubt}"


def _above(record: ShapeRecord) -> str | None:
    above = record.above_needles_mm
    return None if above is None else f"{above:.1f} mm over its needles"


def _below(record: ShapeRecord) -> str | None:
    below = record.below_needles_mm
    return None if below is None or below <= VISIBLE_SAG_MM else f"{below:.1f} mm below its needles"


def _rolled(record: ShapeRecord) -> str:
    text, axis = roll(record.roll_axis_deg, record.get("roll_radius_mm")), record.roll_axis_deg
    equivalent = record.get("equivalent_axes_deg", []) if axis is not None else []
    others = [direction(each) for each in equivalent if 1.0 < abs(each - axis) < 179.0]
    return text + (f"; or {', '.join(others)} deg" if others else "")


HEIGHT_ROW: dict[str, tuple[str, Show]] = {"height_mm": ("height", _height)}
SIZE_ROWS: dict[str, tuple[str, Show]] = {
    "above_needles_mm": ("rises", _above),
    "below_needles_mm": ("hangs", _below),
    "extent_mm": ("extent", lambda record: box_in_words(record.extent_mm)),
    "printed_mm": ("printed", lambda record: box_in_words(record.printed_mm)),
    "contraction": ("contraction", "{contraction:.4f}"),
    "roll_axis_deg": ("rolled about", _rolled),
}
ENERGY_ROW: dict[str, tuple[str, Show]] = {"energy_n_mm": ("energy", "{energy_n_mm:.4f} N mm")}
STABLE_ROW: dict[str, tuple[str, Show]] = {
    "is_minimum": ("equilibrium", lambda record: "stable" if record.is_minimum else "no")
}
WORK_ROW: dict[str, tuple[str, Show]] = {
    "iterations": ("work", "{iterations} iterations, {factorisations} factorisations, {wall_s:.2f} s")
}


class CertificateRecord(Record):
    """Where the search for a shape has ended, and the evidence whether it is a minimum."""

    model: str = key("Which model computed the shape: `exact` or `preview`.")
    converged: bool = key("The norm of the gradient is below its tolerance.")
    is_minimum: bool = key("The shape is certified: it has converged, and its energy grows in every direction.")
    gradient_norm: float = key("2-norm of the gradient of the energy over the free unknowns, in N.")
    gradient_tolerance: float = key("Largest norm of the gradient that counts as converged, in N.")
    energy_n_mm: float = key("Energy of the shape, in a preview of the homogenised sheet.")
    energy_parts_n_mm: dict[str, float] = key("The parts of the energy by name. Their sum is the energy.")
    iterations: int = key("Newton iterations in all.")
    factorisations: int = key("Factorisations of the Hessian in all.")
    saddles_left: int = key("Saddle points at which the search left along a direction of negative curvature.")


class MeasuresRecord(Record):
    """What is measured of a shape."""

    roll_axis_deg: float | None = key("Axis of the roll on the print, from the x axis; null if not rolled.")
    roll_radius_mm: float | None = key(
        "Radius of the circular cylinder nearest to the mean surface at the star centres, or at sites of drawn rods; "
        "null if the sheet is not rolled, or if a plane is nearly as close."
    )
    height_mm: float = key("Extent along z; of a free sheet, on its principal axes, the smallest extent.")
    extent_mm: list[float] = key(
        "Sizes of the box around the sheet: of a supported sheet along x, y and z; of a free sheet along its principal "
        "axes, the largest first."
    )
    printed_mm: list[float] = key("Width and depth of the printed sheet, on the stretched fabric.")
    above_needles_mm: float | None = key("Height of the highest point over the highest support; null for a free sheet.")
    below_needles_mm: float | None = key("Depth of the lowest point below the lowest support; null for a free sheet.")
    contraction: float | None = key(
        "Mean distance of neighbouring star centres over the printed distance; null for a single star. Of drawn rods, "
        "that of sites of their lattice, or of a square lattice with the mean distance of the rods."
    )
    vertices: int = key("Vertices of the mesh that the files hold.")
    triangles: int = key("Triangles of that mesh.")


class ShapeRecord(MeasuresRecord, CertificateRecord):  # the keys of the second class come first
    """The summary of a shape, whichever model computed it."""

    last = ("warnings", "version", "design")

    mesh: str = key("Kind of the mesh: `aligned` with the arms, or `free`.")
    dofs: int = key("Unknowns of the model that are not held.")
    wall_s: float = key("Wall time.")
    wall_s_by_stage: dict[str, float] = key("Wall time of each stage by name, in s.")
    self_intersections: int = key("Pairs of triangles that pass through each other.")
    warnings: list[str] = key("What to know before you trust the shape, one sentence each.", default_factory=list)
    version: str = key("Version of asterism.")
    design: dict[str, Any] = key("The design with all defaults, as in a design file.")


class TrialRecord(Record):
    """An initial guess that the search followed."""

    name: str = key("Name of the initial guess.")
    energy: float = key("Energy of the equilibrium that it led to, in N mm.")
    is_minimum: bool = key("That equilibrium is stable.")
    iterations: int = key("Newton iterations.")


class OtherFormRecord(Record):
    """A minimum of the homogenised sheet other than the one shown."""

    start: str = key("Name of the initial guess that led to it.")
    energy_n_mm: float = key("Its energy.")
    gap: float = key(
        "Its energy less that of the form shown, as a part of the energy at stake, which is the sum of the absolute "
        "values of all parts of the energy."
    )
    distance_percent: float = key(
        "Rms distance of the star centres from the form shown, up to free motions and symmetries of the design, in "
        "percent of the diameter."
    )

    def in_words(self) -> str:
        """The row of this form in the table on the terminal."""
        energy = f"{100.0 * abs(self.gap):.1f} % {'more' if self.gap >= 0.0 else 'less'} energy"
        return f"{self.distance_percent:.0f} % away, {energy}"


class LawOriginRecord(Record):
    """The law that the preview used."""

    material: str = key("Name of the material.")
    stretch: float = key("Stretch at which the law was computed.")
    edge_mm: float = key("Edge length of the meshes of its unit cells.")
    made_by: str | None = key("Command that made the law; null if the law's file does not name it.")


def _other_forms(record: PreviewRecord) -> dict[str, str] | None:
    """A row for each other form."""
    return {f"other form {number}": form.in_words() for number, form in enumerate(record.other_forms, 1)} or None


def _stars(record: PreviewRecord) -> str | None:
    """The row on the stars; None for the motif of drawn rods."""
    outside, tight = len(record.stars_outside_law), len(record.stars_tight)
    return f"{record.stars}, {outside} outside the law, {tight} curled tightly" if record.stars else None


def _expected_distance(record: PreviewRecord) -> str:
    percent = record.expected_rms_percent
    return "not known" if percent is None else distance_error(percent, record.get("diameter_mm"))


class ExpectedErrorRecord(Record):
    """The estimated error of a preview."""

    expected_rms_percent: float | None = key(
        "Estimated error: rms distance from the exact shape in percent of the diameter, within which nine of ten exact "
        "shapes of sheets of this kind were found; null with many stars that the law does not describe."
    )
    expected_height_percent: float | None = key("Estimated error of the height with its bumps, in percent of it.")


class PreviewRecord(ExpectedErrorRecord, ShapeRecord):
    """The summary of a preview."""

    model_name = "preview"
    rows: ClassVar = {
        "stars": ("stars", _stars),
        "rods_total": ("rods", "{rods_total}"),
        **HEIGHT_ROW,
        **SIZE_ROWS,
        **ENERGY_ROW,
        "soft_modes_n_mm3": (
            "softest modes",
            lambda record: ", ".join(f"{value:.1e}" for value in record.soft_modes_n_mm3) + " N/mm3",
        ),
        **STABLE_ROW,
        "expected_rms_percent": ("estimated error", _expected_distance),
        "other_forms": ("other form", _other_forms),
        "law": ("law", "{law[material]}, stretch {law[stretch]:g}, edges of {law[edge_mm]:g} mm"),
        "shell_triangles": ("shell", "{shell_triangles} triangles, {dofs} unknowns"),
        **WORK_ROW,
    }

    soft_modes_n_mm3: list[float] = key("Smallest eigenvalues of the Hessian against the printed area.")
    stars: int = key("Stars of the design.")
    rods_total: int = key("Rods between nodes, of a motif.", default=ABSENT)
    equivalent_axes_deg: list[float] = key("Axes of the roll that are as good by symmetry, its own among them.")
    side: str = key("Side to which the edges were asked to go: `auto`, `up` or `down`.")
    start: str = key("Name of the initial guess that led to the shape.")
    stars_overstretched: list[int] = key("Stars where the preview is longer than the fabric can be.", default=ABSENT)
    starts: list[TrialRecord] = key("All initial guesses that were followed.")
    other_forms: list[OtherFormRecord] = key("Other minima that the search met, the lowest first.")
    law: LawOriginRecord = key("The law that was used.")
    diameter_mm: float = key("Largest distance of two points of the sheet.")
    law_in_range: bool = key("All stars are within the range of the law.")
    stars_outside_law: list[str] = key("The stars outside the range of the law, with the reason, one sentence each.")
    stars_tight: list[int] = key("Stars that curl to a radius below two thirds of their spacing.")
    stars_uneven: list[int] = key("Stars that curl far more in some directions than in others.")
    shell_triangles: int = key("Triangles of the mesh of the shell.")
    load_steps: int = key("Load steps that were needed; 0 if the full loads could be applied at once.")
