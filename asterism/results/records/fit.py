"""The summary of a fit: how near a design comes to its target, and what limits it."""

from __future__ import annotations

from typing import Any

from asterism.results.record import Record, key


def _reached(record: FitRecord) -> str:
    best = record.exact or record.preview
    by = "exact model" if record.exact else "preview; not checked with the exact model"
    weighted = "" if best.weighted_percent == best.mean_percent else f", {best.weighted_percent:.2f} % by the weights"
    return f"{best.mean_percent:.2f} % of the diameter rms{weighted}, {best.largest_percent:.1f} % at most ({by})"


def _preview(record: FitRecord) -> str:
    return f"{record.preview.mean_percent:.2f} %, first guess {record.first_guess.mean_percent:.2f} %"


def _print(record: FitRecord) -> str:
    return f"{record.stars} stars, {record.held_by}, stretch {record.stretch:g}"


def _contraction(record: FitRecord) -> str:
    return f"ratio {record.needed_ratio:.3f} needed, {record.available_ratio:.3f} available"


class TargetDistanceRecord(Record):
    """Distance of a shape to a target, in % of the target's diameter.

    The sheet is compared at each place with the nearest point of the target. A free sheet is laid on the target first.
    """

    mean_percent: float = key(
        "Rms over the printed area of the signed distance, averaged over a cell of the lattice, so that the bumps of "
        "the stars cancel.",
        unit="%",
    )
    weighted_percent: float = key("The same by the weights of the places; `mean_percent` without weights.", unit="%")
    surface_percent: float = key("Rms of the distance with the bumps.", unit="%")
    largest_percent: float = key("Largest distance with the bumps.", unit="%")
    largest_at_mm: list[float] = key("Where that is, in the pose of the fit.", unit="mm")
    is_minimum: bool = key("The shape is certified as a minimum of the energy.")


class FitRecord(Record):
    """The summary of a fit."""

    last = ("warnings", "version", "design")
    rows = (
        "target",
        "stars",
        "needed_ratio",
        "reached",
        "preview",
        "rounding_loss_percent",
    )

    model: str = key("The kind of the summary: `fit`.")
    target: str = key("Name of the target.", label="target", show="{target}, {diameter_mm:.1f} mm")
    diameter_mm: float = key("Largest distance of two points of the target.", unit="mm")
    motion: list[list[float]] = key(
        "Rotation, times the scale, of the pose of the fit: a point x of the file stands at `motion x + shift_mm`."
    )
    shift_mm: list[float] = key("Shift of that pose.", unit="mm")
    stretch: float = key("Stretch of the fabric.")
    stars: int = key("Number of stars.", label="print", show=_print)
    needles: int = key("Number of needles; 0 for a free sheet or a held border.")
    held_border: bool = key("The whole border is held along that of the target.")
    needed_ratio: float = key(
        "Largest contraction that the target needs over the smallest one.", label="contraction", show=_contraction
    )
    available_ratio: float = key("The same ratio of the stars that the law covers.")
    largest_curvature_per_mm: float = key("Largest principal curvature of the target over a cell.", unit="1/mm")
    available_curvature_per_mm: float = key("Largest curvature that stars can follow.", unit="1/mm")
    wrong_side_share: float = key("Share of the stars whose place curves to the other side than stars can.")
    share_at_bounds: float = key("Share of the stars with the shortest or the longest arms that the law covers.")
    first_guess: TargetDistanceRecord = key("Preview of the first guess, from the flattening and the law alone.")
    unrounded: TargetDistanceRecord | None = key(
        "Fresh preview of the fit by the preview alone, before corrections and rounding; null without rounding."
    )
    preview: TargetDistanceRecord = key(
        "Fresh preview of the design as written. After corrections, its distance contains the error of the preview.",
        label="preview",
        show=_preview,
    )
    exact: TargetDistanceRecord | None = key("Exact shape of the design as written; null if it was not computed.")
    other_exact: TargetDistanceRecord | None = key(
        "Exact shape of the other start, if it is another minimum than `exact`; null otherwise."
    )
    exact_agrees: bool | None = key(
        "The exact model finds one minimum from the flat print, and from the preview or by the corrections; null if it "
        "was not computed."
    )
    interrupted: bool = key("The fit was interrupted: the design is the best one until then, by the preview.")
    reached: bool = key("The distance is within the limit that was asked for.", label="distance", show=_reached)
    within_percent: float = key("That limit, for `mean_percent` of the exact shape, or of the preview.", unit="%")
    rounding_loss_percent: float | None = key(
        "Increase of the distance by rounding: of the exact shape if there are corrections, else of the preview; null "
        "without rounding.",
        unit="%",
        label="loss by rounding",
        show="{rounding_loss_percent:.3f} % of the diameter",
    )
    steps: list[dict[str, Any]] = key(
        "Steps of the fit: `kind`, and `rms_percent` of the preview after it, by the weights of the places."
    )
    corrections: list[dict[str, Any]] = key(
        "Exact shapes on the way: `mean_percent`, `step_mm`, the largest change of a length since the one kept "
        "before, and whether it was `kept`. Those of rounded thicknesses come last."
    )
    restarts: int = key("How often a fresh preview took another form than the followed one.")
    warnings: list[str] = key("What limits the fit, one line each.")
    version: str = key("Version of asterism.")
    design: dict[str, Any] = key("The design as written.")

    @property
    def held_by(self) -> str:
        """What holds the sheet: its border, or so many needles."""
        return "held border" if self.held_border else f"{self.needles} needles"
