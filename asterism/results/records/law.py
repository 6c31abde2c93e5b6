"""The summary of a law: its material, its cells and its errors."""

from __future__ import annotations

from typing import Any

from asterism.results.record import ABSENT, Record, key


class CampaignRecord(Record):
    """The campaign of unit cells from which a law was made."""

    command: str = key("Command line that made the law.", default=ABSENT)
    code: str = key("Hash of the code that solved the cells.", default=ABSENT)
    versions: dict[str, str] = key("Versions of asterism and of the packages that solved the cells.", default=ABSENT)
    machine: dict[str, Any] = key("Cores and kind of the machine, and version of Python.", default=ABSENT)
    cell_seconds: float = key("Sum of the wall times of all cells.", unit="s", default=ABSENT)
    wall_seconds_of_last_run: float = key("Wall time of the run that finished the campaign.", unit="s", default=ABSENT)


class QuantityErrorRecord(Record):
    """Errors of one quantity of a law, in percent of the cell's value."""

    rms_percent: float = key("Rms error.", unit="%")
    median_percent: float = key("Median of the absolute errors.", unit="%")
    largest_percent: float = key("Largest absolute error.", unit="%")


class NotScaleSeparatedRecord(Record):
    """Cells of stars that are not scale-separated."""

    count: int = key("Number of these cells.")
    errors: dict[str, QuantityErrorRecord] = key("Errors by quantity.")


class HeldOutCellRecord(Record):
    """A cell that did not make the law, compared with the law. The sizes of its star are keys of their own."""

    last = ("inside", "tight", "law", "cell", "error_percent")

    inside: bool = key("The cell is inside the range of the law.")
    tight: bool = key("The star is not scale-separated.")
    law: dict[str, float] = key("Quantities of the law.")
    cell: dict[str, float] = key("Quantities of the cell.")
    error_percent: dict[str, float] = key("Errors of the law, in percent of the cell's values.", unit="%")


class LawErrorsRecord(Record):
    """Errors of a law at one stretch: at held-out cells, or at the law's own cells, left out one by one."""

    count: int = key("Cells of scale-separated stars inside the range of the law.")
    without_answer: int = key("Held-out cells without an equilibrium.", default=ABSENT)
    outside: int = key("Held-out cells outside the range of the law.", default=ABSENT)
    errors: dict[str, QuantityErrorRecord] = key("Errors by quantity.")
    tight: NotScaleSeparatedRecord = key("Held-out cells of stars that are not scale-separated.", default=ABSENT)
    cells: list[HeldOutCellRecord] = key("All held-out cells with an equilibrium.", default=ABSENT)


def _material(record: LawRecord) -> str:
    fabric, plastic = record.material["fabric"], record.material["plastic"]
    return (
        f"{record.material['name']}: fabric {fabric['thickness_mm']:g} mm, "
        f"modulus ratio {plastic['modulus_ratio']:g}, bending {fabric['bending']}, "
        f"rest curvature {plastic['rest_curvature']}"
    )


def made_by(made: CampaignRecord) -> str:
    """The command and the version that made a law."""
    return f"{made.get('command', '-')} (asterism {made.get('versions', {}).get('asterism', '-')})"


def _cells(record: LawRecord) -> str:
    seconds = record.made.get("cell_seconds", 0.0)
    return f"{record.cells}, mesh edges of {record.edge_mm:g} mm, {seconds:.0f} s in all"


class LawRecord(Record):
    """The summary of a law."""

    rows = ("material", "stretches", "cells", "made")

    material: dict[str, Any] = key(
        "Fabric, plastic, lattice and plan of the cells, as in a material file.", label="material", show=_material
    )
    digest: str = key("Hash of the law's content.")
    made: CampaignRecord = key("How the law was made.", label="made by", show=lambda record: made_by(record.made))
    residuals: dict[str, dict[str, LawErrorsRecord]] = key(
        "Errors by stretch, such as `1.35`, then by kind of test: `held_out`, `leave_one_out`."
    )
    stretches: list[float] = key(
        "Stretches for which the law has a table.",
        label="stretches",
        show=lambda record: ", ".join(f"{stretch:g}" for stretch in record.stretches),
    )
    edge_mm: float = key("Edge length of the cells' mesh.", unit="mm")
    cells: int = key("Number of cells.", label="cells", show=_cells)
    cells_without_answer: list[dict[str, Any]] = key(
        "Stretch and sizes of the cells without an equilibrium, and why (`problem`)."
    )
