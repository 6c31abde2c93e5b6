"""The summaries of a material that was fitted to measured strips, and of a law."""

from __future__ import annotations

from typing import Any, ClassVar

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


class CampaignRecord(Record):
    """The campaign of unit cells from which a law was made."""

    command: str = key("Command line that made the law.", default=ABSENT)
    code: str = key("Hash of the code that solved the cells.", default=ABSENT)
    versions: dict[str, str] = key("Versions of asterism and of the packages that solved the cells.", default=ABSENT)
    machine: dict[str, Any] = key("Cores and kind of the machine, and version of Python.", default=ABSENT)
    cell_seconds: float = key("Sum of the wall times of all cells, in s.", default=ABSENT)
    wall_seconds_of_last_run: float = key("Wall time of the run that finished the campaign, in s.", default=ABSENT)


class QuantityErrorRecord(Record):
    """Errors of one quantity of a law, in percent of the cell's value."""

    rms_percent: float = key("Rms error.")
    median_percent: float = key("Median of the absolute errors.")
    largest_percent: float = key("Largest absolute error.")


class NotScaleSeparatedRecord(Record):
    """Cells of stars that are not scale-separated."""

    count: int = key("Number of these cells.")
    errors: dict[str, QuantityErrorRecord] = key("Errors by quantity.")


class HeldOutCellRecord(Record):
    """A cell that did not make the law, compared with the law. Its sizes are keys of their own."""

    last = ("inside", "tight", "law", "cell", "error_percent")

    inside: bool = key("The cell is inside the range of the law.")
    tight: bool = key("The star is not scale-separated.")
    law: dict[str, float] = key("Quantities of the law of stars.")
    cell: dict[str, float] = key("Quantities of the star's cell.")
    error_percent: dict[str, float] = key("Errors of the law, in percent of the cell's values.")


class HeldOutRecord(Record):
    """Errors of a law at cells that did not make it."""

    count: int = key("Cells inside the range of the law, but for stars that are not scale-separated.")
    without_answer: int = key("Held-out cells without a law.")
    outside: int = key("Held-out cells outside the range of the law.")
    errors: dict[str, QuantityErrorRecord] = key(
        "Errors by quantity; of a motif `stretch` of lengths, `membrane` and `bending` of energies, `curvature` of its "
        "norm."
    )
    tight: NotScaleSeparatedRecord = key("Held-out cells of stars that are not scale-separated.")
    cells: list[HeldOutCellRecord] = key("All held-out cells with a law.")


class LawErrorsRecord(Record):
    """Errors of a law at one stretch."""

    held_out: HeldOutRecord = key("Errors at cells that did not make the law.")


def _material(record: LawRecord) -> str:
    design = record.plan["design"]
    fabric, plastic = design["fabric"], design["plastic"]
    return (
        f"{design['name']}: fabric {fabric['thickness_mm']:g} mm, "
        f"modulus ratio {plastic['modulus_ratio']:g}, bending {fabric['bending']}, "
        f"rest curvature {plastic['rest_curvature']}"
    )


def _pattern(record: LawRecord) -> str:
    design = record.plan["design"]
    lines = len(design["rods"]["motif"]) if "rods" in design else 0
    parts = [f"{lines} line{'s' if lines > 1 else ''}" if lines else f"stars of {design['lattice']['arms']} arms"]
    for size in record.plan["sizes"]:
        nodes = size["nodes"]
        values = f"{nodes[0]:g}" if len(nodes) == 1 else f"{nodes[0]:g} to {nodes[-1]:g}"
        of = f" of lines {', '.join(map(str, size['lines']))}" if len(size.get("lines", ())) not in (0, lines) else ""
        parts.append(f"{size['key'].removesuffix('_mm')}{of} {values} mm")
    return f"{parts[0]}; {', '.join(parts[1:])}" if parts[1:] else parts[0]


def _stretch(stretch: Any) -> str:
    return f"{stretch:g}" if isinstance(stretch, int | float) else " x ".join(f"{each:g}" for each in stretch)


def made_by(made: CampaignRecord) -> str:
    """The command and the version that made a law."""
    return f"{made.get('command', '-')} (asterism {made.get('versions', {}).get('asterism', '-')})"


def _cells(record: LawRecord) -> str:
    seconds = record.made.get("cell_seconds", 0.0)
    return f"{record.cells}, mesh edges of {record.edge_mm:g} mm, {seconds:.0f} s in all"


class LawRecord(Record):
    """The summary of a law."""

    rows: ClassVar = {
        "plan": ("plan", lambda record: {"material": _material(record), "pattern": _pattern(record)}),
        "stretches": ("stretches", lambda record: ", ".join(map(_stretch, record.stretches))),
        "cells": ("cells", _cells),
        "made": ("made by", lambda record: made_by(record.made)),
    }

    plan: dict[str, Any] = key(
        "The `design` of one cell, and `sizes`, over which the law is tabulated: `key`, `nodes` in mm, and numbers of "
        "a motif's `lines`; further `stretches`, `edge_mm` and the number of cells `held_out` per stretch."
    )
    digest: str = key("Hash of the law's content.")
    made: CampaignRecord = key("How the law was made.")
    residuals: dict[str, LawErrorsRecord] = key("Errors by stretch, such as `1.35`.")
    stretches: list[Any] = key("Stretches for which the law has a table: numbers, or pairs along x and y.")
    edge_mm: float = key("Edge length of the cells' mesh.")
    cells: int = key("Number of cells.")
    cells_without_law: list[dict[str, Any]] = key("Stretch and sizes of the cells without a law, and why (`problem`).")
