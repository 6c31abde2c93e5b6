"""The design as the printer makes it, and what is different."""

from __future__ import annotations

import numpy as np

from asterism.print.printer import Printer
from asterism.results.records.export import SizeChangeRecord, TinyStarRecord
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.design.rounding import Rounding
from pattern.geometry.arrays import Floats
from pattern.layout.build import layout
from pattern.layout.layout import Layout

# layers that common printers can do, the coarsest first, and first layers as parts of the nozzle
_LAYERS = (0.2, 0.15, 0.1, 0.05)
_FIRST_LAYERS = (0.2, 0.3, 0.15, 0.25, 0.1)
THICKEST_LAYER = 0.75
# changes of a thickness that are worth another setting, as a fraction
_WORTH_IT = 0.02


def without_rounding(design: Design) -> Design:
    """The design without rounding."""
    return with_rounding(design, None)


def with_rounding(design: Design, rounding: Rounding | None) -> Design:
    """The design with another rounding."""
    return design.model_copy(update={"stars": design.stars.model_copy(update={"rounding": rounding})})


def choose_rounding(plan: Layout, printer: Printer) -> Rounding:
    """With the first layer that changes the thicknesses of an exact layout least; the usual one among equals."""
    return min(printer.roundings(), key=lambda rounding: round(_thickness_change(plan, rounding), 6))


def rounded_layout(design: Design, printer: Printer) -> Layout:
    """The layout of a rounded design; `DesignError` says if wider arms run into each other."""
    try:
        return layout(design)
    except DesignError as error:
        raise DesignError(error.field, f"{error.allowed} (sizes rounded for the {printer.name})", error.value) from None


def size_changes(before: Layout, after: Layout) -> dict[str, SizeChangeRecord]:
    """What rounding does to the sizes of the arms: `thickness` and `width`."""
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
    """Layers that would print an exact layout much better; None if there is nothing to gain."""
    now = _thickness_change(plan, rounding)
    if now < _WORTH_IT:
        return None
    others = [
        rounding.model_copy(update={"first_layer_mm": first, "layer_mm": layer})
        for layer in _LAYERS
        for first in _FIRST_LAYERS
        if max(first, layer) <= THICKEST_LAYER * rounding.line_mm + 1e-9
    ]
    if not others:
        return None
    # the coarsest that is good enough, or else the best
    good = [other for other in others if _thickness_change(plan, other) < _WORTH_IT]
    best = good[0] if good else min(others, key=lambda other: _thickness_change(plan, other))
    return best if _thickness_change(plan, best) < now / 2 else None


def tiny_stars(plan: Layout, arm_mm: float) -> list[TinyStarRecord]:
    """Stars whose longest arm is shorter than `arm_mm`, by their place."""
    longest = np.zeros(len(plan.centres))
    np.maximum.at(longest, plan.arm_star, plan.arm_length)
    return [
        TinyStarRecord(at_mm=[round(float(c), 2) for c in plan.centres[star]], arm_mm=round(float(longest[star]), 2))
        for star in np.flatnonzero(longest < arm_mm)
    ]


def _thickness_change(plan: Layout, rounding: Rounding) -> float:
    """Mean change of the thickness as a fraction."""
    old: Floats = plan.arm_thickness
    return float(np.mean(np.abs(rounding.thickness(old) - old) / old))
