"""The plan of the law of one design: unit cells around the sizes of its stars, or of the rods of its motif."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.point_group import aligned_lines
from asterism.homogenize.law.material import MIN_CELL_EDGE_MM
from asterism.homogenize.law.plan import (
    SAME_SIZE_MM,
    LawPlan,
    Size,
    Sizes,
    without_law,
)
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rods import Rods
from asterism.pattern.design.rounding import rounded
from asterism.pattern.design.sizing.profiles import Profile
from asterism.pattern.design.stars import ROD_SIZE_KEYS, STAR_SIZES, StarSize
from asterism.pattern.layout.build import layout as layout_of
from asterism.pattern.layout.layout import Layout

# Mesh edges between adjacent stars. On graded meshes natural curvatures of plates are then within 1 % of their limit
# for tight stars, and within 5 % for slack ones, which hardly curl. On even meshes those of four arms fall by a tenth
# from 17 edges to 24, and those of slack turned stars of three arms by two fifths.
EDGES_PER_SPACING = 17
# of the spacing, longest step between adjacent lengths
LENGTH_STEP = 1 / 12
# of the nodes of all sizes of a motif together
MAX_CELLS = 2000


def plan_for_design(
    design: Design, layout: Layout | None = None, known: LawPlan | None = None, edge_mm: float | None = None
) -> LawPlan:
    """The cells for the stars or the motif of a design, see `plan_for_sizes`.

    Parameters
    ----------
    layout : of the design; computed if it is needed.
    known, edge_mm : as of `plan_for_sizes`.

    >>> motif = [{"line_mm": [(0, 0), (10, 0)]}, {"line_mm": [(0, 0), (0, 10)]}]
    >>> thickness = {"profile": "radial", "from": 0.4, "to": 0.5, "over_mm": 30}
    >>> grid = Design.from_dict({
    ...     "rods": {"motif": motif, "thickness_mm": thickness}, "lattice": {"kind": "square", "spacing_mm": 10.0},
    ...     "border": {"rectangle_mm": (60, 60)},
    ... })
    >>> for size in plan_for_design(grid).sizes:
    ...     print(size.key, size.lines, size.nodes)
    thickness_mm (0, 1) (0.4, 0.4472, 0.5)
    width_mm (0, 1) (1.2,)
    """
    return plan_for_sizes(design, sizes_on(design, layout or layout_of(design)), known, edge_mm)


def sizes_on(design: Design, layout: Layout) -> Floats:
    """(S, A) sizes that occur on the sheet of a design, see `LawPlan.sizes_on`."""
    return LawPlan(design, _groups(design), (), 0.0).sizes_on(design, layout)


def plan_for_sizes(
    design: Design, sizes: Floats, known: LawPlan | None = None, edge_mm: float | None = None
) -> LawPlan:
    """The plan of cells whose sizes enclose those of a design.

    For a motif, each group of lines with one sizing field is an axis of the law. Lines whose size is a number of their
    own keep it. Raises `DesignError` if the design has no star, there is no law of it, or too many sizes vary.

    Parameters
    ----------
    sizes : (S, A) that occur on the sheet, see `sizes_on`.
    known : of the law before an edit: its nodes stay, if it has the same pattern and mesh.
    edge_mm : of the cells' mesh, for experiments; by default the spacing of stars over `EDGES_PER_SPACING`, or the
        usual edge of a motif. Meshes of stars are graded where the fabric bends as a plate and the arms lie on lattice
        lines.
    """
    if (refused := without_law(design)) is not None:
        raise refused
    if len(sizes) == 0:
        raise DesignError("stars", "must be at least one: bare fabric needs no law")
    if not np.isfinite(sizes).all():
        raise DesignError("stars", "must have sizes that are finite numbers")
    spacing, rods = design.lattice.spacing_mm, design.rods
    usual = max(round(spacing / EDGES_PER_SPACING, 4), MIN_CELL_EDGE_MM) if rods is None else design.usual_edge_mm
    edge = edge_mm or usual
    if edge < MIN_CELL_EDGE_MM:
        raise DesignError("mesh.edge_mm", f"must be at least {MIN_CELL_EDGE_MM:g} for the cells of a law", edge)
    groups = _groups(design)
    before: tuple[Size, ...] = groups
    if (
        known
        and known.edge_mm == edge
        and [(s.key, s.lines) for s in known.sizes] == [(s.key, s.lines) for s in groups]
    ):
        before = known.sizes
    chosen = tuple(
        replace(size, nodes=_nodes(size.axis, column, spacing, size.nodes, rods is not None))
        for size, column in zip(before, sizes.T, strict=True)
    )
    varies = sum(size.varies for size in chosen)
    if rods is not None and (count := math.prod(len(size.nodes) for size in chosen)) > MAX_CELLS:
        raise DesignError("rods.motif", f"has {varies} sizes that vary, and its law {count} cells; {MAX_CELLS} at most")
    sx, sy = design.fabric.stretch_xy
    held_out = 4 if rods is not None and varies else 0  # random cells that test the law of a motif
    return LawPlan(_cell(design, chosen), chosen, (sx if math.isclose(sx, sy) else (sx, sy),), edge, held_out)


def _groups(design: Design) -> tuple[Size, ...]:
    """The sizes of the law, without nodes: of stars, or those that all lines share, and profiles of single lines."""
    rods = design.rods
    if rods is None:
        return tuple(Size(size.key, ()) for size in STAR_SIZES)
    groups: list[Size] = []
    for key in ROD_SIZE_KEYS:
        sources = [rods.size_of(line, key) for line in rods.motif]
        left = [n for n, line in enumerate(rods.motif) if isinstance(sources[n], Profile) or getattr(line, key) is None]
        while left:
            alike = tuple(n for n in left if sources[n] == sources[left[0]])
            groups.append(Size(key, (), alike))
            left = [n for n in left if n not in alike]
    return tuple(groups)


def _cell(design: Design, sizes: tuple[Size, ...]) -> Design:
    """A design with equal stars, or with the motif alone, each of whose lines has numbers as its own sizes."""
    data, side = design.to_dict(), 3.0 * design.lattice.spacing_mm
    pattern: dict[str, Any]
    if design.rods is None:
        graded = not design.fabric.bending_follows_mesh and aligned_lines(design.lattice) is not None
        pattern = {"stars": {size.key: size.nodes[0] for size in sizes}, "mesh": {"graded": graded}}
    else:
        rest = {key: data["rods"][key] for key in ("curve_mm", "join_mm")}
        pattern = {"rods": {"motif": _lines(design.rods, data["rods"]["motif"], sizes), **rest}}
    return Design.from_dict(
        {
            "name": design.name,
            "fabric": data["fabric"],
            "plastic": data["plastic"],
            "lattice": {key: value for key, value in data["lattice"].items() if key != "origin_mm"},
            "border": {"rectangle_mm": [side, side]},
            **pattern,
        }
    )


def _lines(rods: Rods, lines: list[dict[str, Any]], sizes: tuple[Size, ...]) -> list[dict[str, Any]]:
    """The lines with numbers as their sizes, the first of them above the fabric."""
    for line, drawn in zip(lines, rods.motif, strict=True):
        line["side"] = None if rods.face(drawn) == rods.face(rods.motif[0]) else "below"
        for key in ROD_SIZE_KEYS:
            field = rods.size_of(drawn, key)
            if not isinstance(field, Profile):
                line[key] = float(rounded(rods.rounding, key, np.array([field]))[0])
    for size in sizes:
        for number in size.lines or ():
            lines[number][size.key] = size.nodes[0]
    return lines


def _nodes(axis: StarSize, sizes: Floats, spacing: float, known: Sizes, of_rods: bool) -> Sizes:
    """Increasing nodes of an axis that enclose sizes (S,), and those of the law before an edit.

    A law before an edit goes on in whole steps, so that a slider meets new cells rarely.
    """
    ratio = axis.rod_ratio if of_rods else axis.node_ratio
    least, most = axis.limits_at(spacing)
    low, high = _ends(np.clip(sizes, least, most))
    nodes = sorted(known) or [low, high]
    while nodes[-1] < high - SAME_SIZE_MM:
        nodes.append(min(round(_step(ratio, nodes[-1], spacing, 1), 4), most))
    while nodes[0] > low + SAME_SIZE_MM:
        nodes.insert(0, max(round(_step(ratio, nodes[0], spacing, -1), 4), least))
    between = [node for ends in pairwise(nodes) for node in _steps(ratio, *ends, spacing)]
    return tuple(sorted({*nodes, *between}))


def _step(ratio: float | None, node: float, spacing: float, sense: int) -> float:
    """The node one step further in a sense, 1 or -1."""
    return node + sense * LENGTH_STEP * spacing if ratio is None else node * ratio**sense


def _steps(ratio: float | None, low: float, high: float, spacing: float) -> list[float]:
    """Nodes between two, in even steps of the axis that are short enough."""
    if ratio is None:
        count = math.ceil((high - low) / (LENGTH_STEP * spacing) - 1e-4)  # nodes are rounded
        return [round(low + (high - low) * n / count, 4) for n in range(1, count)]
    return geometric_nodes(np.array([low, high]), ratio)[1:-1]


def geometric_nodes(sizes: Floats, max_ratio: float) -> list[float]:
    """From the smallest to the largest of sizes (S,) in equal ratios, each at most `max_ratio`.

    >>> geometric_nodes(np.array([0.3, 0.45, 0.38]), 1.3)
    [0.3, 0.3674, 0.45]
    """
    low, high = _ends(sizes)
    steps = math.ceil(math.log(high / low) / math.log(max_ratio) - 1e-9) or 1
    return sorted({low, *(round(low * (high / low) ** (n / steps), 4) for n in range(1, steps)), high})


def _ends(sizes: Floats) -> tuple[float, float]:
    """Smallest and largest size, rounded outwards to 0.001 mm; one size gives two equal ends without rounding noise."""
    low, high = (float(end) for end in (sizes.min(), sizes.max()))
    if high - low < 1e-9 * high:
        return round(high, 9), round(high, 9)
    return math.floor(low * 1e3 + 1e-6) / 1e3, math.ceil(high * 1e3 - 1e-6) / 1e3
