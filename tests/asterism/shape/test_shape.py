"""A shape maps printed points into space and knows its own size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from asterism.pattern.geometry.normals import vertex_normals
from asterism.shape.shape import Shape
from tests.asterism import sheets


def moved(shape: Shape, rotation: Rotation) -> Shape:
    return replace(shape, positions=rotation.apply(shape.positions) + np.array([3.0, -50.0, 7.0]))


@given(st.tuples(st.floats(-50, 50), st.floats(-40, 40)))
def test_an_affine_map_is_reproduced_everywhere(point: tuple[float, float]) -> None:
    a, b = np.array([[0.7, 0.1, 0.3], [-0.2, 0.8, 0.5]]), np.array([1.0, 2.0, 3.0])
    shape = AFFINE_SHEET
    assert np.allclose(shape.at(np.array([point])), np.array([point]) @ a + b, atol=1e-12)


def affine(points: np.ndarray) -> np.ndarray:
    return points @ np.array([[0.7, 0.1, 0.3], [-0.2, 0.8, 0.5]]) + [1.0, 2.0, 3.0]


AFFINE_SHEET = sheets.sheet(affine, edge=5.0)


def test_points_in_long_triangles_are_found() -> None:
    """Many small triangles are closer by their centroids than the long one that holds the point."""
    line = np.column_stack([np.linspace(0, 1, 40), np.zeros(40)])
    printed = np.concatenate([line, [[0.5, 100.0], [0.5, -0.01]]])
    fans = [[i, i + 1, 40] for i in range(39)] + [[i + 1, i, 41] for i in range(39)]
    shape = Shape(
        printed=printed,
        positions=sheets.flat(printed),
        triangles=np.array(fans),
        star=np.full(len(printed), -1),
        rods=(),
        star_vertices=np.empty(0, dtype=int),
    )
    points = np.array([[0.5, 99.0], [0.1, 1.0], [0.9, 0.5], [0.5, -0.005]])
    assert np.allclose(shape.at(points)[:, :2], points, atol=1e-12)


@pytest.mark.parametrize("point", [(50.1, 0.0), (0.0, -40.001), (1e9, 0.0), (np.nan, 0.0), (0.0, np.inf)])
def test_points_off_the_sheet_are_refused(point: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"off the sheet|not a number"):
        AFFINE_SHEET.at(np.array([(0.0, 0.0), point]))


@pytest.mark.parametrize("points", [[], [[0.0, 0.0, 0.0]], 3.0])
def test_what_are_no_points_is_refused(points: object) -> None:
    with pytest.raises(ValueError, match="must be pairs of mm"):
        AFFINE_SHEET.at(points)  # type: ignore[arg-type]


def test_points_on_the_border_survive_rounding() -> None:
    edge = np.column_stack([np.full(100, 50.0 * (1 + 1e-15)), np.linspace(-40, 40, 100)])
    assert np.isfinite(AFFINE_SHEET.at(edge)).all()


def test_extent_does_not_depend_on_the_pose() -> None:
    shape = sheets.sheet(sheets.flat)
    assert shape.extent_mm == pytest.approx((100, 80, 0), abs=1e-9)
    assert moved(shape, Rotation.from_rotvec([1.0, 2.0, -0.5])).extent_mm == pytest.approx((100, 80, 0), abs=1e-9)


def test_the_box_of_a_held_sheet_has_its_height() -> None:
    leaning = moved(sheets.sheet(sheets.flat, edge=5.0), Rotation.from_euler("x", 30, degrees=True))
    held = replace(leaning, held=True)
    assert held.extent_mm == pytest.approx((100, 80 * np.sqrt(0.75), 40))
    assert held.extent_mm[2] == held.height_mm


@pytest.mark.parametrize("place", [sheets.dome, sheets.tube, sheets.saddle])
def test_aligned_brings_every_pose_to_the_same_one(place) -> None:  # type: ignore[no-untyped-def]
    shape = sheets.sheet(place)
    expected = shape.aligned()
    for seed in range(5):
        again = moved(shape, Rotation.random(rng=np.random.default_rng(seed))).aligned()
        assert np.allclose(again.positions, expected.positions, atol=1e-6)
    distance = np.linalg.norm(expected.positions[::7] - expected.positions[0], axis=1)
    assert np.allclose(distance, np.linalg.norm(shape.positions[::7] - shape.positions[0], axis=1))


def test_aligned_shows_the_plastic_side_and_turns_vectors() -> None:
    upside_down = moved(sheets.sheet(sheets.dome), Rotation.from_euler("x", 180, degrees=True))
    shape = upside_down.aligned()
    centre = np.linalg.norm(shape.printed, axis=1).argmin()
    assert shape.positions[centre, 2] == pytest.approx(shape.positions[:, 2].max(), abs=0.1)
    vectors = {"normal": vertex_normals(upside_down.positions, shape.triangles)}
    turned = replace(upside_down, point_fields=vectors).aligned()
    assert np.allclose(turned.point_fields["normal"], vertex_normals(turned.positions, turned.triangles))
