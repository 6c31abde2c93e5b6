"""The summary of a material that was fitted to measured strips."""

from __future__ import annotations

from typing import ClassVar

from asterism.results.record import ABSENT, Record, key


class StripOptionsRecord(Record):
    """The options with which the table of strips was read."""

    outside: bool = key("The boxes enclose the thickness of the strips.")
    flat_height_mm: float = key("Strips whose arc is lower count as flat.")
    stretch: float = key("Stretch of all strips, if the table gives none.", default=ABSENT)
    fabric_thickness_mm: float = key("Thickness of the fabric, if the table gives none.", default=ABSENT)


class RatioIntervalRecord(Record):
    """An estimate of E1/E2 with its confidence interval."""

    value: float = key("Estimate.")
    low: float = key("Lower end of the interval.")
    high: float | None = key("Upper end of the interval; null if there is no upper bound.")

    def in_words(self) -> str:
        """The row of this estimate in the table on the terminal."""
        return f"{self.value:.0f}   {self.low:.0f} to " + ("without bound" if self.high is None else f"{self.high:.0f}")


class KappaBarRecord(Record):
    """An estimate of kappa_bar, the curvature of peeled plastic, with its confidence interval."""

    thickness_mm: float | None = key("Thickness of the strips; null if one value holds for all.")
    value_per_mm: float = key("Estimate.")
    low_per_mm: float = key("Lower end of the interval.")
    high_per_mm: float = key("Upper end of the interval.")

    def in_words(self) -> str:
        """The row of this estimate in the table on the terminal."""
        return f"{self.value_per_mm:.5f} /mm   {self.low_per_mm:.5f} to {self.high_per_mm:.5f}"


class LeftOutReadingRecord(Record):
    """A reading that was not used."""

    strip: str = key("Name of the strip.")
    row: int = key("Row of the table; the header is row 1.")
    peeled: bool = key("The strip was measured without its fabric.")
    reason: str = key("Why the reading was not used.")


def _readings(record: StripFitRecord) -> str:
    total = record.readings_used + len(record.left_out)
    flat = f", {record.readings_flat} of them flat" if record.readings_flat else ""
    return f"{total}, {record.readings_used} used{flat}"


def _ratios(record: StripFitRecord) -> dict[str, str]:
    along = " along" if "modulus_ratio_across" in record else ""
    return {f"E1/E2{along}, {name}": interval.in_words() for name, interval in record.modulus_ratio.items()}


def _ratios_across(record: StripFitRecord) -> dict[str, str]:
    return {f"E1/E2 across, {name}": each.in_words() for name, each in record.modulus_ratio_across.items()}


def _kappa_bars(record: StripFitRecord) -> dict[str, str]:
    if not record.kappa_bar:
        return {"kappa_bar": "taken for 0"}
    return {
        "kappa_bar" if each.thickness_mm is None else f"kappa_bar, {each.thickness_mm:g} mm": each.in_words()
        for each in record.kappa_bar
    }


class StripFitRecord(Record):
    """The summary of a fit of strips."""

    rows: ClassVar = {
        "readings_used": ("readings", _readings),
        "modulus_ratio": ("E1/E2", _ratios),
        "modulus_ratio_across": ("E1/E2 across", _ratios_across),
        "kappa_bar": ("kappa_bar", _kappa_bars),
        "confidence": (
            "intervals",
            lambda record: f"{100 * record.confidence:g} %, {record.degrees_of_freedom:.1f} degrees of freedom",
        ),
    }

    version: str = key("Version of asterism.")
    strips: str = key("Name of the table of strips.")
    options: StripOptionsRecord = key("Options with which the table was read.")
    rest_curvature: str = key("Convention of the material's E1/E2: `paper` or `timoshenko`.")
    confidence: float = key("Probability with which the intervals contain the true values, from 0 to 1.")
    degrees_of_freedom: float = key("Degrees of freedom of the interval of E1/E2.")
    modulus_ratio: dict[str, RatioIntervalRecord] = key("E1/E2 for each convention, along the grain.")
    modulus_ratio_across: dict[str, RatioIntervalRecord] = key("E1/E2 across the grain.", default=ABSENT)
    kappa_bar_kind: str = key("Model of kappa_bar: `constant`, `per-thickness` or `zero`.")
    kappa_bar: list[KappaBarRecord] = key("kappa_bar: one value, one for each thickness, or none if it is taken for 0.")
    readings_used: int = key("Readings that were used.")
    readings_flat: int = key("Flat readings among them, which count as straight within a bound.")
    left_out: list[LeftOutReadingRecord] = key("Readings that were not used.")
    warnings: list[str] = key("Reasons to doubt the numbers; readings named here are used.")
