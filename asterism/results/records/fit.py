"""The summaries of a fit, which says how near a design comes to its target, and of a sweep over many designs."""

from __future__ import annotations

from typing import Any, ClassVar

from asterism.results.record import Record, key


def _reached(record: FitRecord) -> str:
    best = record.exact or record.preview
    by = "exact model" if record.exact else "preview; not checked with the exact model"
    weighted = "" if best.weighted_percent == best.mean_percent else f", {best.weighted_percent:.2f} % by the weights"
    return f"{best.mean_percent:.2f} % of the diameter rms{weighted}, {best.largest_percent:.1f} % at most ({by})"


class TargetDistanceRecord(Record):
    """Distance of a shape to a target, in % of the target's diameter.

    The sheet is compared at each place with the nearest point of the target. A free sheet is laid on the target first.
    """

    mean_percent: float = key(
        "Rms over the printed area of the signed distance, averaged over a cell of the lattice, so that the bumps of "
        "the stars cancel."
    )
    weighted_percent: float = key("The same by the weights of the places; `mean_percent` without weights.")
    surface_percent: float = key("Rms of the distance with the bumps.")
    largest_percent: float = key("Largest distance with the bumps.")
    largest_at_mm: list[float] = key("Where that is, in the pose of the fit.")
    is_minimum: bool = key("The shape is certified as a minimum of the energy.")


class ReachRecord(Record):
    """What a target needs, and what stars can do."""

    needed_ratio: float = key("Largest contraction that the target needs over the smallest one.")
    available_ratio: float = key("The same ratio of the stars that the law covers.")
    largest_curvature_per_mm: float = key("Largest principal curvature of the target over a cell.")
    available_curvature_per_mm: float = key("Largest curvature that stars can follow.")
    wrong_side_share: float = key("Share of the stars whose place curves to the other side than stars can.")
    warnings: list[str] = key("What limits the fit, one line each.")


class StagesRecord(Record):
    """Distances to the target at the stages of a fit."""

    first_guess: TargetDistanceRecord = key("Preview of the first guess, from the flattening and the law alone.")
    unrounded: TargetDistanceRecord | None = key("Preview before corrections and rounding; null without rounding.")
    preview: TargetDistanceRecord = key("Preview of the design as written; after corrections with the preview's error.")
    exact: TargetDistanceRecord | None = key("Exact shape of the design as written; null if it was not computed.")
    other_exact: TargetDistanceRecord | None = key("Exact shape of the other start, if it is another minimum.")
    exact_agrees: bool | None = key("Both exact starts find one minimum; null if this was not computed.")
    rounding_loss_percent: float | None = key(
        "Increase of the distance by rounding: of the exact shape if there are corrections, else of the preview; null "
        "without rounding."
    )


class FitRecord(StagesRecord, ReachRecord):
    """The summary of a fit."""

    last = ("warnings", "version", "design")
    rows: ClassVar = {
        "target": ("target", "{target}, {diameter_mm:.1f} mm"),
        "stars": ("print", lambda record: f"{record.stars} stars, {record.held_by}, stretch {record.stretch:g}"),
        "needed_ratio": ("contraction", "ratio {needed_ratio:.3f} needed, {available_ratio:.3f} available"),
        "reached": ("distance", _reached),
        "preview": ("preview", "{preview[mean_percent]:.2f} %, first guess {first_guess[mean_percent]:.2f} %"),
        "rounding_loss_percent": ("loss by rounding", "{rounding_loss_percent:.3f} % of the diameter"),
    }

    model: str = key("The kind of the summary: `fit`.")
    target: str = key("Name of the target.")
    diameter_mm: float = key("Largest distance of two points of the target.")
    motion: list[list[float]] = key(
        "Rotation and scale of the pose: a point x of the file is at `motion x + shift_mm`."
    )
    shift_mm: list[float] = key("Shift of that pose.")
    stretch: float = key("Stretch of the fabric.")
    stars: int = key("Number of stars.")
    needles: int = key("Number of needles; 0 for a free sheet or a held border.")
    held_border: bool = key("The whole border is held along that of the target.")
    share_at_bounds: float = key("Share of the stars with the shortest or the longest arms that the law covers.")
    interrupted: bool = key("The fit was interrupted: the design is the best one until then, by the preview.")
    reached: bool = key("The distance is within the limit that was asked for.")
    within_percent: float = key("That limit, for `mean_percent` of the exact shape, or of the preview.")
    steps: list[dict[str, Any]] = key("Steps of the fit: `kind`, and the preview's weighted `rms_percent` after it.")
    corrections: list[dict[str, Any]] = key(
        "Exact shapes on the way: `mean_percent`, `step_mm`, the largest change of a length since the one kept "
        "before, and whether it was `kept`. Those of rounded thicknesses come last."
    )
    restarts: int = key("How often a fresh preview took another form than the followed one.")
    version: str = key("Version of asterism.")
    design: dict[str, Any] = key("The design as written.")

    @property
    def held_by(self) -> str:
        """What holds the sheet: its border, or so many needles."""
        return "held border" if self.held_border else f"{self.needles} needles"


class SweepParameterRecord(Record):
    """A parameter of a sweep."""

    path: str = key("Dotted path of the entry in the design.")
    listed: list[Any] = key("Its listed values; empty for a range.")
    limits: list[float] | None = key("Smallest and largest value of a range; null for listed values.")


class SweepColumnRecord(Record):
    """A column of the table of a sweep."""

    name: str = key("Name of the column.")
    unit: str = key("Unit; empty for counts, ratios and texts.")
    label: str = key("The column in words.")


class SweepRowRecord(Record):
    """One design of a sweep."""

    number: int = key("Number of the design, from 1.")
    parameters: dict[str, Any] = key("Values of the parameters by path.")
    results: dict[str, Any] | None = key("Values of the other columns by name; null for a design without a shape.")
    problem: str | None = key("Why the design has no shape; null if it has one.")


def _failed(record: SweepRecord) -> str:
    count = sum(row.problem is not None for row in record.table_rows)
    return f"{len(record.table_rows)}, of which {count} failed" if count else f"{len(record.table_rows)}"


class SweepRecord(Record):
    """The summary of a sweep."""

    model_name = "sweep"
    rows: ClassVar = {
        "table_rows": ("designs", _failed),
        "sampling": ("sampling", "{sampling}"),
        "by": ("shapes by", "{by}"),
        "parameters": ("parameters", lambda record: ", ".join(each.path for each in record.parameters)),
    }
    last = ("table_rows", "version", "design")

    model: str = key("`sweep`.")
    by: str = key("The model of the shapes: `preview` or `exact`.")
    sampling: str = key("`grid` for all combinations, or `latin hypercube`.")
    seed: int | None = key("Seed of the Latin hypercube; null for a grid.")
    parameters: list[SweepParameterRecord] = key("The parameters.")
    columns: list[SweepColumnRecord] = key("The columns of the table after the number and the parameters.")
    table_rows: list[SweepRowRecord] = key("The designs.")
    law: str | None = key("Digest of the law of the previews; null for exact shapes, and if none was given.")
    version: str = key("Version of asterism.")
    design: dict[str, Any] = key("The design that is varied, with all defaults.")
