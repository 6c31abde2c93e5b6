"""Distances in the plane."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.geometry.planar import mean_circumcentres, triangle_gradients


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
