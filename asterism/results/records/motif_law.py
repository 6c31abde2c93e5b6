"""The summary of the law of a motif: its plan, its cells and its errors."""

from __future__ import annotations

from typing import Any

from asterism.results.record import Record, key
from asterism.results.records.law import CampaignRecord, QuantityErrorRecord, made_by


class MotifErrorsRecord(Record):
    """Errors of the law of a motif at held-out cells."""

    count: int = key("Held-out cells inside the range of the law.")
    errors: dict[str, QuantityErrorRecord] = key(
        "Errors by quantity: `stretch` of lengths, `membrane` and `bending` of energies, `curvature` of its norm."
    )


def _material(record: MotifLawRecord) -> str:
    design = record.plan["design"]
    fabric, plastic = design["fabric"], design["plastic"]
    stretch = fabric["stretch"]
    shown = f"{stretch:g}" if isinstance(stretch, int | float) else " x ".join(f"{each:g}" for each in stretch)
    return (
        f"{design['name']}: fabric {fabric['thickness_mm']:g} mm, stretch {shown}, "
        f"modulus ratio {plastic['modulus_ratio']:g}, bending {fabric['bending']}, "
        f"rest curvature {plastic['rest_curvature']}"
    )


def _motif(record: MotifLawRecord) -> str:
    lines = len(record.plan["design"]["rods"]["motif"])
    parts = []
    for size in record.plan["sizes"]:
        nodes = size["nodes"]
        values = f"{nodes[0]:g}" if len(nodes) == 1 else f"{nodes[0]:g} to {nodes[-1]:g}"
        of = "" if len(size["lines"]) == lines else f" of lines {', '.join(map(str, size['lines']))}"
        parts.append(f"{size['key'].removesuffix('_mm')}{of} {values} mm")
    return f"{lines} line{'s' if lines > 1 else ''}; {', '.join(parts)}" if parts else f"{lines} lines"


def _cells(record: MotifLawRecord) -> str:
    seconds = record.made.get("cell_seconds", 0.0)
    return f"{record.cells}, mesh edges of {record.edge_mm:g} mm, {seconds:.0f} s in all"


class MotifLawRecord(Record):
    """The summary of the law of a motif."""

    rows = ("plan", "cells", "made")

    plan: dict[str, Any] = key(
        "The `design` of one cell, and `sizes`, over which the law is tabulated: `key`, numbers of the motif's "
        "`lines`, and `nodes` in mm.",
        label="plan",
        show=lambda record: {"material": _material(record), "motif": _motif(record)},
    )
    digest: str = key("Hash of the law's content.")
    made: CampaignRecord = key("How the law was made.", label="made by", show=lambda record: made_by(record.made))
    held_out: MotifErrorsRecord = key("Errors at random cells that did not make the law.")
    edge_mm: float = key("Edge length of the cells' mesh.", unit="mm")
    cells: int = key("Number of cells.", label="cells", show=_cells)
    cells_without_law: list[dict[str, Any]] = key("Sizes of the cells without a law, and why (`problem`).")
