"""The bounded step against an independent solver."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from asterism.fitting.bounded_step import bounded_step


# an unknown reaches its upper bound but for rounding, and must leave it later
@example(388, 10)
@given(st.integers(0, 10_000), st.integers(1, 12))
@settings(max_examples=60, deadline=None)
def test_it_is_the_bounded_least_squares_solution(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    matrix, right = rng.normal(size=(count + 6, count)), rng.normal(size=count + 6)
    low, high = -rng.uniform(0.0, 0.6, count), rng.uniform(0.0, 0.6, count)
    step = bounded_step(matrix.T @ matrix, -matrix.T @ right, low, high)
    reference = lsq_linear(matrix, right, (low - 1e-12, high + 1e-12), method="bvls", tol=1e-14)
    assert (step >= low).all() and (step <= high).all()
    cost = 0.5 * float(((matrix @ step - right) ** 2).sum())
    assert cost == pytest.approx(reference.cost, rel=1e-6, abs=1e-9)


def test_bounds_that_are_equal_keep_their_unknown() -> None:
    step = bounded_step(np.eye(3), np.array([-1.0, -1.0, 1.0]), np.array([0.0, -2, -2]), np.array([0.0, 2, 2]))
    assert step.tolist() == [0.0, 1.0, -1.0]
