"""The layout of any design: of its stars, of its drawn rods, or of both."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.border import Hole
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import check_mesh_size, check_pins, layout, sheet_outline
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.pin_placement import pin_set, snapped_to_lines
from asterism.pattern.layout.supports import PinSet
from asterism.pattern.rods.graph import RodGraph

if TYPE_CHECKING:
    from asterism.pattern.rods.drawn_graph import DrawnPattern


def print_layout(design: Design) -> Layout:
    """The layout of a design with stars, with drawn rods, or with both. `layout` refuses drawn rods.

    Raises
    ------
    DesignError
        The sheet cannot be printed. The message names the field, its value and the allowed range.
    TypeError
        `design` is not a `Design`.

    Examples
    --------
    >>> lines = [{"line_mm": [(-30, y), (30, y)]} for y in (-10, 0, 10)]
    >>> design = Design.from_dict({"rods": {"draw": lines}, "border": {"rectangle_mm": (62, 30)}})
    >>> sheet = print_layout(design)
    >>> len(sheet.graph.rods), len(sheet.centres), round(sheet.spacing_mm, 2)
    (3, 0, 10.33)
    """
    if not isinstance(design, Design) or design.rods is None:
        return layout(design)
    from asterism.pattern.rods.drawn_graph import drawn_pattern  # slow to import; designs of stars do without it

    corners = None if design.border.rods is not None else sheet_outline(design)
    drawn = drawn_pattern(design.rods, design.border, design.lattice, corners)
    outline, graph = drawn.outline, drawn.graph
    if design.stars is not None:
        return _with_stars(design, drawn)
    scale = float(abs(polygon_area(outline)) / graph.total_length)
    vectors = design.lattice.vectors if design.rods.motif else scale * np.eye(2)
    check_mesh_size(design.usual_edge_mm, outline)
    pins = _pins(design, outline, graph, drawn.holes)
    no_arms = np.empty((0, 2))
    return Layout(
        outline=outline,
        centres=no_arms,
        arm_star=np.empty(0, dtype=np.int64),
        arm_tip=no_arms,
        arm_thickness=no_arms,
        arm_width=no_arms,
        neighbours=np.empty((0, 2), dtype=np.int64),
        pins=pins,
        lattice_vectors=vectors,
        lattice_origin=np.asarray(design.lattice.origin_mm, dtype=float),
        drawn=graph,
        rim=drawn.rim,
        holes=drawn.holes,
        hole_rims=drawn.hole_rims,
    )


def _pins(design: Design, outline: Floats, graph: RodGraph, holes: tuple[Floats, ...]) -> tuple[PinSet, ...]:
    """The pins of a design with drawn rods, moved onto rods beside them."""
    lines = np.array([shapely.LineString(rod.points) for rod in graph.rods])
    sets = [pin_set(pin, outline, f"pins[{k}]", holes) for k, pin in enumerate(design.pins)]
    pins = tuple(snapped_to_lines(pin, outline, graph.nodes, lines) for pin in sets)
    check_pins(pins, outline, holes)
    return pins


def _with_stars(design: Design, drawn: DrawnPattern) -> Layout:
    """The layout of stars beside drawn rods. They do not touch each other."""
    changes: dict[str, object] = {"holes": tuple(Hole(polygon_mm=ring.tolist()) for ring in drawn.holes), "rods": None}
    if design.border.rings is None:
        corners = tuple((float(x), float(y)) for x, y in drawn.outline)
        changes |= {"rectangle_mm": None, "polygon_mm": corners}
    border = design.border.model_copy(update=changes)
    alone = layout(design.model_copy(update={"rods": None, "border": border, "pins": ()}))
    arms = alone.graph
    _check_beside(arms, drawn.graph)
    count = len(arms.nodes)
    moved = tuple(replace(rod, start=rod.start + count, end=rod.end + count) for rod in drawn.graph.rods)
    graph = RodGraph(np.concatenate([arms.nodes, drawn.graph.nodes]), (*arms.rods, *moved), arms.paired)
    first = len(arms.rods)
    return replace(
        alone,
        outline=drawn.outline,
        pins=_pins(design, drawn.outline, graph, drawn.holes),
        drawn=graph,
        rim=tuple(rod + first for rod in drawn.rim),
        holes=drawn.holes,
        hole_rims=tuple(tuple(rod + first for rod in rim) for rim in drawn.hole_rims),
    )


def _check_beside(stars: RodGraph, drawn: RodGraph) -> None:
    """Refuse arms of stars nearer to drawn rods than half the sum of their widths.

    Raises
    ------
    DesignError
        The message names the star, the rod and the place.
    """
    arms = np.array([shapely.LineString(rod.points) for rod in stars.rods])
    lines = np.array([shapely.LineString(rod.points) for rod in drawn.rods])
    widest = max(float(rod.width.max()) for rod in (*stars.rods, *drawn.rods))
    near_arm, near_line = shapely.STRtree(lines).query(arms, predicate="dwithin", distance=widest)
    for i, j in zip(near_arm, near_line, strict=True):
        arm, rod = stars.rods[i], drawn.rods[j]
        gap = float(shapely.distance(arms[i], lines[j]))
        if gap < 0.5 * (arm.width.max() + rod.width.max()):
            place = shapely.get_coordinates(shapely.shortest_line(arms[i], lines[j])).mean(axis=0)
            at, centre = (f"[{x:.2f}, {y:.2f}]" for x, y in (place, arm.points[0]))
            what = "crosses" if gap == 0.0 else f"is {gap:.2f} mm from"
            problem = f"an arm of the star at {centre} {what} {rod.name} at {at}: shorten it, remove the star, or move"
            raise DesignError("stars", f"{problem} the line", stars=[arm.group], place_mm=place)
