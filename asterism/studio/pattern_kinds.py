"""The kinds of patterns on a sheet."""

from __future__ import annotations

from asterism.pattern.design.design import Design


def pattern_kinds(design: Design) -> tuple[bool, bool, bool]:
    """Whether the sheet has stars, lines that repeat on a lattice, and other lines. A preview is of one kind.

    Examples
    --------
    >>> pattern_kinds(Design.from_dict({"stars": {"length_mm": 10}, "border": {"rings": 2}}))
    (True, False, False)
    """
    rods = design.rods
    return design.stars is not None, rods is not None and bool(rods.motif), rods is not None and bool(rods.on_sheet)
