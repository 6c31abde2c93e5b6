"""The layout of any design: of its stars, or of its drawn rods."""

from __future__ import annotations

import numpy as np
import shapely

from pattern.design.design import Design
from pattern.geometry.planar import polygon_area
from pattern.layout.build import check_mesh_size, check_pins, layout, sheet_outline
from pattern.layout.layout import Layout
from pattern.layout.pin_placement import pin_set, snapped_to_lines


def print_layout(design: Design) -> Layout:
    """The layout of a design with stars or with drawn rods. `layout` refuses drawn rods.

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
    from pattern.rods.drawn_graph import drawn_pattern  # slow to import; designs of stars do without it

    corners = None if design.border.rods is not None else sheet_outline(design)
    drawn = drawn_pattern(design.rods, design.border, design.lattice, corners)
    outline, graph = drawn.outline, drawn.graph
    scale = float(abs(polygon_area(outline)) / graph.total_length)
    vectors = design.lattice.vectors if design.rods.motif else scale * np.eye(2)
    check_mesh_size(design.mesh.edge_mm, outline)
    lines = np.array([shapely.LineString(rod.points) for rod in graph.rods])
    sets = [pin_set(pin, outline, f"pins[{k}]") for k, pin in enumerate(design.pins)]
    pins = tuple(snapped_to_lines(pin, outline, graph.nodes, lines) for pin in sets)
    check_pins(pins, outline, drawn.holes)
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
