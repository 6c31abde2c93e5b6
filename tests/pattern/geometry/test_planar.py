"""Distances in the plane, points found in triangles, and points laid on other points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from asterism.pattern.geometry.planar import distance_along, mean_circumcentres, triangle_gradients
from asterism.pattern.geometry.point_location import TriangleFinder, clipped
from asterism.pattern.geometry.rigid_fit import rigid_fit

BOX = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]])


@given(x=st.floats(0.1, 3.9), y=st.floats(0.1, 2.9), angle=st.floats(0.0, 6.28))
def test_a_ray_ends_on_the_outline(x: float, y: float, angle: float) -> None:
    along = np.array([np.cos(angle), np.sin(angle)])
    far = distance_along(np.array([[x, y]]), along, BOX)[0]
    end = np.array([x, y]) + far * along
    assert np.abs(np.concatenate([end, end - [4.0, 3.0]])).min() == pytest.approx(0.0, abs=1e-9)
    assert (end > -1e-9).all() and (end < np.array([4.0, 3.0]) + 1e-9).all()


def test_it_is_the_nearest_crossing_and_infinite_without_one() -> None:
    notch = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 1.0], [0.0, 3.0]])
    points = np.array([[0.5, 2.0], [0.5, 0.5], [5.0, 1.0]])
    assert distance_along(points, np.array([1.0, 0.0]), notch) == pytest.approx([0.5, 3.5, np.inf])


def test_gradients_are_those_of_barycentric_coordinates() -> None:
    points, triangles = np.array([[1.0, 2.0], [5.0, 3.0], [2.0, 7.0]]), np.array([[0, 1, 2]])
    (gradient,) = triangle_gradients(points, triangles)
    assert gradient @ (points[1:] - points[0]).T == pytest.approx(np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]))


def test_circumcentres_count_by_the_area_of_their_triangles() -> None:
    """Of right triangles they are in the middle of the longest side."""
    points = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [-6.0, 0.0]])
    found = mean_circumcentres(points, np.array([[0, 1, 2], [0, 2, 3]]))
    assert found[0] == pytest.approx((2.0 * np.array([1.0, 1.0]) + 6.0 * np.array([-3.0, 1.0])) / 8.0)
    assert found[[1, 3]] == pytest.approx(np.array([[1.0, 1.0], [-3.0, 1.0]]))


PRINTED = np.random.default_rng(1).uniform(-10.0, 10.0, (300, 2))
TRIANGLES = Delaunay(PRINTED).simplices.astype(np.int64)


@pytest.mark.parametrize("step", [0.0, 0.01, 0.5, 3.0])
def test_points_found_from_where_they_were_are_those_found_anew(step: float) -> None:
    rng, finder = np.random.default_rng(2), TriangleFinder(PRINTED, TRIANGLES)
    points = rng.uniform(-6.0, 6.0, (500, 2))
    known, _ = finder.nearest(points)
    moved = points + rng.uniform(-step, step, points.shape)
    for (triangle, weights), (right, right_weights) in [(finder.near_before(moved, known), finder.nearest(moved))]:
        inside = right_weights.min(axis=1) > 1e-9
        assert inside.mean() > 0.9 and np.array_equal(triangle[inside], right[inside])
        places, others = (
            np.einsum("nk,nkc->nc", clipped(each), PRINTED[TRIANGLES[which]])
            for which, each in ((triangle, weights), (right, right_weights))
        )
        assert np.abs(places - others).max() < 1e-12


def test_rigid_fit() -> None:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(9, 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    rotation, shift = rigid_fit(points, points @ turn.T + [1.0, 2.0, 3.0])
    np.testing.assert_allclose(rotation, turn, atol=1e-12)
    np.testing.assert_allclose(shift, [1.0, 2.0, 3.0], atol=1e-12)


def test_weights_count_points_as_often_as_they_say() -> None:
    rng = np.random.default_rng(3)
    points, targets, times = rng.normal(size=(12, 3)), rng.normal(size=(12, 3)), rng.integers(1, 5, 12)
    weighted = rigid_fit(points, targets, times.astype(float))
    for found, several in zip(weighted, rigid_fit(points.repeat(times, 0), targets.repeat(times, 0)), strict=True):
        np.testing.assert_allclose(found, several, atol=1e-12)
