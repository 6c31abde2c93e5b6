"""Distances in the plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pattern.planar import distance_along

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
