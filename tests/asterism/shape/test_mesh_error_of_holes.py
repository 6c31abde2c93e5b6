"""Meshes with curved holes have different chords: their shapes are compared all the same."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.shape.mesh_error import mesh_error
from asterism.shape.shape import Shape


def test_shapes_with_a_wavy_hole_are_compared() -> None:
    a = np.linspace(0.0, 2.0 * np.pi, 30, endpoint=False)
    r = 8.0 * (1.0 + 0.25 * np.cos(3.0 * a))
    hole = {"spline_mm": np.column_stack([r * np.cos(a), r * np.sin(a)]).tolist()}
    border = {"rectangle_mm": (40.0, 40.0), "holes": [hole]}
    lines = [{"line_mm": [(-19, y), (19, y)]} for y in (-15, 15)]
    plan = print_layout(Design.from_dict({"rods": {"draw": lines}, "border": border}))
    meshes = [mesh_layout(plan, edge) for edge in (3.0, 2.0, 1.0)]
    places = [np.column_stack([mesh.points, 0.01 * mesh.points[:, 0] ** 2]) for mesh in meshes]
    none = np.full(len(meshes[-1].points), -1)
    fine = Shape(
        meshes[-1].points, places[-1], meshes[-1].triangles, none, meshes[-1].rods, np.empty(0, dtype=np.int64)
    )
    coarser = [(mesh.points, where) for mesh, where in zip(meshes[:-1], places[:-1], strict=True)]
    with pytest.raises(ValueError, match="off the sheet"):
        fine.at(meshes[0].points)
    assert 0.0 < mesh_error(fine, coarser, True, layout=plan).change < 0.5
