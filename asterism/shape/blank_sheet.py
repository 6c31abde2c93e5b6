"""The sheet of a design without a single star: flat fabric, released."""

from __future__ import annotations

import numpy as np

from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import sheet_outline
from asterism.pattern.mesh.sheet_mesh import sheet_mesh
from asterism.shape.shape import Shape


def blank_sheet(design: Design) -> Shape:
    """The flat fabric of a design, released and free of its pins; its stars do not count.

    The shape has no summary. The edges of its triangles have about the spacing of the stars.

    Raises
    ------
    DesignError
        The outline is not one of a sheet.

    Examples
    --------
    >>> design = Design.from_dict({"stars": {"length_mm": 0}, "border": {"rectangle_mm": [54, 27]}})
    >>> np.ptp(blank_sheet(design).positions, axis=0).round(1).tolist()
    [40.0, 20.0, 0.0]
    """
    corners = sheet_outline(design)
    shortest = float(np.sqrt(polygon_area(corners) / 20_000))
    edge = max(design.lattice.spacing_mm, shortest)
    mesh = sheet_mesh(corners, edge, np.empty((0, 2)), [])
    count = len(mesh.points)
    flat = np.column_stack([mesh.points / design.fabric.stretch_xy, np.zeros(count)])
    star = np.full(count, -1, dtype=np.int64)
    return Shape(mesh.points, flat, mesh.triangles, star, rods=(), star_vertices=np.empty(0, dtype=np.int64))
