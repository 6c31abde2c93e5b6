"""The coarse mesh of a sheet with holes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.pattern.geometry.planar import cross_2d, polygon_area, triangle_angles, triangle_areas
from asterism.pattern.mesh.sheet_mesh import sheet_mesh

RECTANGLE = np.array([[-60.0, -40.0], [60.0, -40.0], [60.0, 40.0], [-60.0, 40.0]])


def circle(count: int, radius: float, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    angle = 2 * np.pi * np.arange(count) / count
    return np.asarray(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


@settings(max_examples=20, deadline=None)
@given(st.integers(3, 40), st.floats(1.0, 25.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.booleans())
def test_holes_are_left_out_and_angles_stay_large(n: int, radius: float, x: float, y: float, turned: bool) -> None:
    hole = circle(n, radius, (x * (57.0 - radius), y * (37.0 - radius)))
    mesh = sheet_mesh(RECTANGLE, 14.0, holes=[hole[::-1] if turned else hole])
    area = 9600.0 - polygon_area(hole)
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(area)
    assert triangle_angles(mesh.points, mesh.triangles).min() > 10.0
    assert [len(mesh.rings), polygon_area(mesh.rings[0])] == [2, pytest.approx(9600.0)]
    assert polygon_area(mesh.rings[1]) == pytest.approx(area - 9600.0)


def test_the_rim_has_the_sheet_to_its_left_and_names_its_edges() -> None:
    holes = [circle(4, 10.0, (-30.0, 0.0)), circle(60, 12.0, (30.0, 5.0))]
    mesh = sheet_mesh(RECTANGLE, 14.0, holes=holes, held_sides=[range(8, 68)])
    assert set(mesh.side[mesh.side < 8].tolist()) == set(range(8))
    around = mesh.side >= 8
    distance = np.linalg.norm(mesh.points[mesh.rim[around]] - [30.0, 5.0], axis=-1)
    assert distance == pytest.approx(12.0, rel=0.06)
    # each rim edge belongs to one triangle, which has it in the same direction
    corners = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert {*map(tuple, mesh.rim.tolist())} <= {*map(tuple, corners.tolist())}
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    assert (cross_2d(b - a, c - a) > 0.0).all()


def test_points_on_the_edge_of_a_hole_are_held() -> None:
    hole = circle(60, 12.0)
    held = np.array([hole[7], 0.5 * (hole[20] + hole[21]), [-40.0, 10.0]])
    mesh = sheet_mesh(RECTANGLE, 14.0, held, holes=[hole])
    away = np.linalg.norm(mesh.points[:, None] - held, axis=2).min(axis=0)
    assert away == pytest.approx(0.0, abs=1e-9)


def test_a_narrow_bridge_has_short_edges() -> None:
    hole = np.array([[-10.0, -37.0], [10.0, -37.0], [10.0, -10.0], [-10.0, -10.0]])
    mesh = sheet_mesh(RECTANGLE, 14.0, holes=[hole])
    assert triangle_angles(mesh.points, mesh.triangles).min() > 10.0
