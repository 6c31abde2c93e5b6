"""Every free point is the weighted mean of its neighbours, in many small pieces and in one large one."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.mesh.aligned.lattice_grid import MAX_DENSE_POINTS, means_of_neighbours


def square(side: int) -> np.ndarray:
    """Edges of a square grid of points."""
    number = np.arange(side * side).reshape(side, side)
    pairs = (number[:-1], number[1:]), (number[:, :-1], number[:, 1:])
    return np.concatenate([np.column_stack([a.ravel(), b.ravel()]) for a, b in pairs])


@pytest.mark.parametrize("every", [3, 100])
def test_free_points_are_means(every: int) -> None:
    side, rng = 20, np.random.default_rng(1)
    edges = square(side)
    stiff, values = rng.uniform(0.5, 2.0, len(edges)), rng.standard_normal((side * side, 2))
    i, j = np.indices((side, side)).reshape(2, -1)
    known = (i % every == 0) | (j % every == 0) | (i == side - 1) | (j == side - 1)
    assert (np.sum(~known) > MAX_DENSE_POINTS) == (
        every > side
    ) or every == 3  # one piece beyond what is solved densely
    found = means_of_neighbours(edges, stiff, known, values)
    assert np.array_equal(found[known], values[known])
    weight, total = np.zeros(side * side), np.zeros((side * side, 2))
    for a, b in (edges.T, edges.T[::-1]):
        np.add.at(weight, a, stiff)
        np.add.at(total, a, stiff[:, None] * found[b])
    assert np.allclose(found[~known], (total / weight[:, None])[~known], atol=1e-8)


def test_what_touches_nothing_known_stays() -> None:
    edges = np.array([[0, 1], [2, 3]])
    found = means_of_neighbours(edges, np.ones(2), np.array([True, False, False, False]), np.full((4, 2), 7.0))
    assert np.allclose(found, [[7.0, 7.0], [7.0, 7.0], [0.0, 0.0], [0.0, 0.0]])
