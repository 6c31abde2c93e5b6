"""The coarse mesh: it has the sheet's area, and a point wherever the sheet is held."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.pattern.geometry.planar import distance_to_segment, polygon_area, triangle_angles, triangle_areas
from asterism.pattern.mesh.sheet_mesh import coarse_outline, sheet_mesh

HEXAGON = 67.0 * np.column_stack(
    [np.cos(np.radians(30 + 60 * np.arange(6))), np.sin(np.radians(30 + 60 * np.arange(6)))]
)
RECTANGLE = np.array([[-69.0, -89.0], [69.0, -89.0], [69.0, 89.0], [-69.0, 89.0]])
L_SHAPE = np.array([[0, 0], [120, 0], [120, 40], [40, 40], [40, 120], [0, 120.0]])


def circle(count: int, radius: float = 60.0) -> np.ndarray:
    angle = 2 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("parts", [1, 2, 4])
def test_a_hexagon_has_equilateral_triangles(parts: int) -> None:
    mesh = sheet_mesh(HEXAGON, 67.0 / parts)
    assert len(mesh.triangles) == 6 * parts**2
    assert triangle_angles(mesh.points, mesh.triangles) == pytest.approx(60.0)


@pytest.mark.parametrize("border", [HEXAGON, RECTANGLE, L_SHAPE, circle(100), circle(12)], ids=list("HRLCD"))
@pytest.mark.parametrize("edge", [14.0, 30.0])
def test_the_area_is_the_sheets(border: np.ndarray, edge: float) -> None:
    mesh = sheet_mesh(border, edge)
    areas = triangle_areas(mesh.points, mesh.triangles)
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(polygon_area(border), rel=1e-12)
    assert triangle_angles(mesh.points, mesh.triangles).min() > 15.0


def test_a_circle_of_many_sides_gets_few() -> None:
    mesh = sheet_mesh(circle(300), 20.0)
    assert len(mesh.rim) < 30
    radius = np.linalg.norm(mesh.points[mesh.rim[:, 0]], axis=1)
    # half way between the chords' sagitta inside and outside
    assert np.abs(radius - 60.0).max() < 0.06 * 20.0


def test_corners_stay_where_they_are() -> None:
    mesh = sheet_mesh(circle(8), 20.0)
    gaps = np.linalg.norm(circle(8)[:, None] - mesh.points[None], axis=2).min(axis=1)
    assert gaps.max() == 0.0


def test_held_points_are_points_of_the_mesh() -> None:
    inner, on_side, corner = [-66.0, 0.0], [10.0, -89.0], [69.0, 89.0]
    held = np.array([inner, on_side, corner, [-66.0, -86.0]])
    mesh = sheet_mesh(RECTANGLE, 25.0, held)
    assert np.linalg.norm(held[:, None] - mesh.points[None], axis=2).min(axis=1) == pytest.approx(0.0, abs=1e-12)
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(polygon_area(RECTANGLE))


def test_mesh_edges_know_their_side() -> None:
    mesh = sheet_mesh(L_SHAPE, 17.0)
    for pair, side in zip(mesh.rim, mesh.side, strict=True):
        a, b = L_SHAPE[side], L_SHAPE[(side + 1) % 6]
        assert distance_to_segment(mesh.points[pair], a, b) == pytest.approx(0.0, abs=1e-9)


def test_what_is_held_ends_at_a_point_of_the_mesh() -> None:
    border = circle(100)
    mesh = sheet_mesh(border, 20.0, held_sides=[range(10, 35)])
    held = np.isin(mesh.side, range(10, 35))
    ends = mesh.rim[held].ravel()
    once = [point for point in ends if (ends == point).sum() == 1]
    assert sorted(mesh.points[once].tolist()) == sorted(border[[10, 35]].tolist())
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(polygon_area(border))


@settings(deadline=None, max_examples=12)
@given(st.integers(0, 10**6), st.floats(8.0, 40.0))
def test_any_wavy_outline(seed: int, edge: float) -> None:
    random = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    radius = 60 + sum(random.uniform(-8, 8) * np.cos(k * angle + random.uniform(0, 6)) for k in (2, 3, 5))
    border = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    coarse, _ = coarse_outline(border, edge, np.array([0, 30]))
    assert polygon_area(coarse) == pytest.approx(polygon_area(border), rel=1e-9)
    assert {tuple(p) for p in border[[0, 30]]} <= {tuple(p) for p in coarse}
    mesh = sheet_mesh(border, edge)
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(polygon_area(border), rel=1e-9)
