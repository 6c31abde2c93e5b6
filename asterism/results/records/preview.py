"""The summary of a preview."""

from __future__ import annotations

from typing import ClassVar

from asterism.results.record import ABSENT, Record, key
from asterism.results.records.shape import ENERGY_ROW, HEIGHT_ROW, SIZE_ROWS, STABLE_ROW, WORK_ROW, ShapeRecord
from asterism.results.words import distance_error


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
