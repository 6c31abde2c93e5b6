"""Needles and marks along the edges of holes."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.draw.render import pin_marks
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.print.needles import needles
from asterism.shape.shape import Shape

LINES = [{"line_mm": [(-19, y), (19, y)]} for y in (-16, 16)]
HOLES = [{"circle_mm": {"centre": [-9, 0], "radius": 6}}, {"polygon_mm": [[5, -5], [15, -5], [15, 5], [5, 5]]}]


def test_needles_and_marks_go_around_holes() -> None:
    border = {"rectangle_mm": (40.0, 40.0), "holes": HOLES}
    pins = [{"holes": [0, 1], "scale": 0.9, "offset_mm": [0.0, 0.0, 5.0]}]
    plan = layout(Design.from_dict({"rods": {"draw": LINES}, "border": border, "pins": pins}))
    placed = needles(plan, 5.0)
    printed = np.array([needle.printed for needle in placed])
    on_circle = np.abs(np.linalg.norm(printed - [-9.0, 0.0], axis=1) - 6.0) < 0.05
    assert on_circle.sum() == 8  # 37.7 mm around, at most 5 mm apart
    square = printed[~on_circle]
    assert len(square) == 8 and np.abs(square - [10.0, 0.0]).max(axis=1) == pytest.approx(5.0)
    assert [needle.place[2] for needle in placed if needle.place is not None] == [5.0] * 16
    mesh = mesh_layout(plan, 3.0)
    places = np.column_stack([mesh.points, np.zeros(len(mesh.points))])
    none = np.full(len(mesh.points), -1)
    shape = Shape(
        mesh.points, places, mesh.triangles, none, mesh.rods, np.empty(0, dtype=np.int64), held=True, plan=plan
    )
    points, _, triangles = pin_marks(shape)
    assert len(triangles) > 100
    far = np.minimum(
        np.abs(np.linalg.norm(points[:, :2] - [-9.0, 0.0], axis=1) - 6.0),
        np.abs(np.abs(points[:, :2] - [10.0, 0.0]).max(axis=1) - 5.0),
    )
    assert far.max() < 1.5
