"""Rounding of a design to the layers and lines of a printer."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.print.printer import Printer
from asterism.results.records.export import SizeChangeRecord, TinyStarRecord

# largest height of a layer over the width of a line
MAX_LAYER_OVER_LINE = 0.75


def with_rounding(design: Design, rounding: Rounding | None) -> Design:
    """The design with another rounding of its stars and drawn rods."""
    patterns = {name: section for name in ("stars", "rods") if (section := getattr(design, name)) is not None}
    changed = {name: section.model_copy(update={"rounding": rounding}) for name, section in patterns.items()}
    return design.model_copy(update=changed)


def choose_rounding(plan: Layout, printer: Printer) -> Rounding:
    """The rounding whose first layer changes the thicknesses least; the printer's preferred one among equals."""
    return min(printer.roundings(), key=lambda rounding: round(_thickness_change(plan, rounding), 6))


def rounded_layout(design: Design, printer: Printer) -> Layout:
    """The layout of a rounded design; `DesignError` if wider arms or rods overlap."""
    try:
        return layout(design)
    except DesignError as error:
        raise DesignError(error.field, f"{error.allowed} (sizes rounded for the {printer.name})", error.value) from None


def size_changes(before: Layout, after: Layout) -> dict[str, SizeChangeRecord]:
    """Changes of the sizes of the arms and rods by rounding: `thickness` and `width`."""
    result: dict[str, SizeChangeRecord] = {}
    groups = len(after.centres)
    owners = [*after.arm_star, *(groups + np.arange(len(after.drawn_rods)))]
    owner = np.repeat(owners, [len(rod.points) for rod in after.graph.rods])
    for name in ("thickness", "width"):
        old, new = _sizes(before, name), _sizes(after, name)
        changed = np.unique(owner[np.abs(new - old) > 1e-6])
        worst = int(np.abs(new - old).argmax())
        result[name] = SizeChangeRecord(
            values_mm=[float(value) for value in np.unique(np.round(new, 6))],
            stars_changed=int((changed < groups).sum()),
            rods_changed=int((changed >= groups).sum()),
            largest_change_mm=float(np.round((new - old)[worst], 6)),
            mean_change_percent=float(100 * np.mean(np.abs(new - old) / old)),
        )
    return result


def _sizes(plan: Layout, name: str) -> Floats:
    """(n,) mm, `thickness` or `width` at both ends of all arms, then at the points of all drawn rods."""
    return np.concatenate([getattr(rod, name) for rod in plan.graph.rods])


def better_layers(plan: Layout, rounding: Rounding) -> Rounding | None:
    """Layers whose rounding changes a layout much less; None if there are none."""
    now, small = _thickness_change(plan, rounding), 0.02  # relative change, below which no others are proposed
    if now < small:
        return None
    others = [
        rounding.model_copy(update={"first_layer_mm": first, "layer_mm": layer})
        for layer in (0.2, 0.15, 0.1, 0.05)  # those of common printers, the largest first
        for first in (0.2, 0.3, 0.15, 0.25, 0.1)  # the preferred first
        if max(first, layer) <= MAX_LAYER_OVER_LINE * rounding.line_mm + 1e-9
    ]
    if not others:
        return None
    # the largest layers whose change is small enough, or else the best
    good = [other for other in others if _thickness_change(plan, other) < small]
    best = good[0] if good else min(others, key=lambda other: _thickness_change(plan, other))
    return best if _thickness_change(plan, best) < now / 2 else None


def tiny_pieces(plan: Layout, arm_mm: float) -> list[TinyStarRecord]:
    """Stars whose longest arm is shorter than `arm_mm`, and drawn rods that are shorter with all that they meet."""
    longest = np.zeros(len(plan.centres))
    np.maximum.at(longest, plan.arm_star, plan.arm_length)
    found = list(zip(plan.centres, longest, strict=True))
    if plan.drawn_rods:
        nodes, ends = plan.graph.nodes, np.array([[rod.start, rod.end] for rod in plan.drawn_rods])
        links = coo_array((np.ones(len(ends)), ends.T), shape=(len(nodes), len(nodes)))
        island = connected_components(links, directed=False)[1][ends[:, 0]]
        length = np.bincount(island, [rod.length for rod in plan.drawn_rods])
        found += [(nodes[ends[island == k]].reshape(-1, 2).mean(axis=0), length[k]) for k in np.unique(island)]
    return [
        TinyStarRecord(at_mm=[round(float(c), 2) for c in place], arm_mm=round(float(size), 2))
        for place, size in found
        if size < arm_mm
    ]


def _thickness_change(plan: Layout, rounding: Rounding) -> float:
    """Mean relative change of the thickness."""
    old = _sizes(plan, "thickness")
    return float(np.mean(np.abs(rounding.thickness(old) - old) / old))
