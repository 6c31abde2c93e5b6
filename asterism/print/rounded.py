"""Rounding of a design to the layers and lines of a printer."""

from __future__ import annotations

import numpy as np

from asterism.print.printer import Printer
from asterism.results.records.export import SizeChangeRecord, TinyStarRecord
from equilibrium.arrays import Floats
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.design.rounding import Rounding
from pattern.layout.build import layout
from pattern.layout.layout import Layout

# layer heights of common printers, the largest first
_LAYERS_MM = (0.2, 0.15, 0.1, 0.05)
# heights of the first layer, the preferred first
_FIRST_LAYERS_MM = (0.2, 0.3, 0.15, 0.25, 0.1)
# largest height of a layer over the width of a line
MAX_LAYER_OVER_LINE = 0.75
# relative change of the thickness from which other layers are proposed
_MIN_CHANGE_FOR_PROPOSAL = 0.02


def without_rounding(design: Design) -> Design:
    """The design without rounding."""
    return with_rounding(design, None)


def with_rounding(design: Design, rounding: Rounding | None) -> Design:
    """The design with another rounding."""
    return design.model_copy(update={"stars": design.required_stars.model_copy(update={"rounding": rounding})})


def choose_rounding(plan: Layout, printer: Printer) -> Rounding:
    """The rounding whose first layer changes the thicknesses least; the printer's preferred one among equals."""
    return min(printer.roundings(), key=lambda rounding: round(_thickness_change(plan, rounding), 6))


def rounded_layout(design: Design, printer: Printer) -> Layout:
    """The layout of a rounded design; `DesignError` if wider arms overlap."""
    try:
        return layout(design)
    except DesignError as error:
        raise DesignError(error.field, f"{error.allowed} (sizes rounded for the {printer.name})", error.value) from None


def size_changes(before: Layout, after: Layout) -> dict[str, SizeChangeRecord]:
    """Changes of the sizes of the arms by rounding: `thickness` and `width`."""
    result: dict[str, SizeChangeRecord] = {}
    for name in ("thickness", "width"):
        old, new = getattr(before, f"arm_{name}"), getattr(after, f"arm_{name}")
        other = np.abs(new - old) > 1e-6
        worst = np.unravel_index(np.abs(new - old).argmax(), new.shape)
        result[name] = SizeChangeRecord(
            values_mm=[float(value) for value in np.unique(np.round(new, 6))],
            stars_changed=len(np.unique(after.arm_star[other.any(axis=1)])),
            largest_change_mm=float(np.round((new - old)[worst], 6)),
            mean_change_percent=float(100 * np.mean(np.abs(new - old) / old)),
        )
    return result


def better_layers(plan: Layout, rounding: Rounding) -> Rounding | None:
    """Layers whose rounding changes a layout much less; None if there are none."""
    now = _thickness_change(plan, rounding)
    if now < _MIN_CHANGE_FOR_PROPOSAL:
        return None
    others = [
        rounding.model_copy(update={"first_layer_mm": first, "layer_mm": layer})
        for layer in _LAYERS_MM
        for first in _FIRST_LAYERS_MM
        if max(first, layer) <= MAX_LAYER_OVER_LINE * rounding.line_mm + 1e-9
    ]
    if not others:
        return None
    # the largest layers whose change is small enough, or else the best
    good = [other for other in others if _thickness_change(plan, other) < _MIN_CHANGE_FOR_PROPOSAL]
    best = good[0] if good else min(others, key=lambda other: _thickness_change(plan, other))
    return best if _thickness_change(plan, best) < now / 2 else None


def tiny_stars(plan: Layout, arm_mm: float) -> list[TinyStarRecord]:
    """Stars whose longest arm is shorter than `arm_mm`."""
    longest = np.zeros(len(plan.centres))
    np.maximum.at(longest, plan.arm_star, plan.arm_length)
    return [
        TinyStarRecord(at_mm=[round(float(c), 2) for c in plan.centres[star]], arm_mm=round(float(longest[star]), 2))
        for star in np.flatnonzero(longest < arm_mm)
    ]


def _thickness_change(plan: Layout, rounding: Rounding) -> float:
    """Mean relative change of the thickness."""
    old: Floats = plan.arm_thickness
    return float(np.mean(np.abs(rounding.thickness(old) - old) / old))
