"""The summary of a law: its material, its cells and its errors."""

from __future__ import annotations

from typing import Any, ClassVar

from asterism.results.record import ABSENT, Record, key


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
