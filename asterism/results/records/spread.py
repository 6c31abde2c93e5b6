"""The summary of the range of shapes that prints of one design may have."""

from __future__ import annotations

from asterism.results.record import Record, key

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
