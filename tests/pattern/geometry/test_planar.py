"""Distances in the plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asterism.pattern.geometry.planar import distance_along, distance_to_segment, mean_circumcentres, triangle_gradients

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


def test_segments_end() -> None:
    points = np.array([[-3.0, 4.0], [1.0, 2.0], [5.0, 4.0]])
    assert distance_to_segment(points, np.zeros(2), np.array([2.0, 0.0])) == pytest.approx([5.0, 2.0, 5.0])


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
