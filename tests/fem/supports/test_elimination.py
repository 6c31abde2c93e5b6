"""Elimination of linear equations: the map from the free unknowns to all solutions."""

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.fem.supports.elimination import Contradiction, eliminate


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.integers(1, 12), st.integers(0, 5))
def test_the_map_gives_all_solutions_and_only_these(seed: int, equations: int, repeated: int) -> None:
    """Sparse equations, some of them combinations of others, with coefficients of any size."""
    rng = np.random.default_rng(seed)
    matrix = np.where(rng.uniform(size=(equations, 20)) < 0.15, rng.normal(size=(equations, 20)), 0.0)
    matrix = np.vstack([matrix, rng.normal(size=(repeated, equations)) @ matrix])
    right = matrix @ rng.normal(size=(20, 2))
    size = 10.0 ** rng.uniform(-3, 3, (len(matrix), 1))
    found = eliminate(sp.csr_matrix(size * matrix), size * right, 1e-8)
    x = (found.map @ rng.normal(size=len(found.free)))[:, None] + found.constant
    assert np.allclose(matrix @ x, right, atol=1e-7 * max(np.abs(x).max(), 1.0))
    rank = np.linalg.matrix_rank(matrix, tol=1e-9)
    assert len(found.free) == 20 - rank
    assert np.array_equal(found.map[found.free].toarray(), np.eye(len(found.free)))


def test_blocks_without_common_unknowns_are_solved_separately() -> None:
    matrix = sp.csr_matrix(np.array([[1.0, 2.0, 0, 0, 0], [0, 0, 1.0, -1.0, 0]]))
    found = eliminate(matrix, np.array([[3.0], [4.0]]), 1e-8)
    assert len(found.free) == 3
    assert found.map.nnz == 5


@pytest.mark.parametrize(
    ("rows", "right", "row", "miss"),
    [
        ([[1.0, 0.0], [1.0, 0.0]], [0.0, 0.5], (0, 1), 0.25),
        ([[1.0, 1.0], [2.0, 2.0], [0.0, 0.0]], [1.0, 2.0, 3.0], (2,), 3.0),
    ],
)
def test_contradictions_are_named(rows, right, row: tuple[int, ...], miss: float) -> None:
    with pytest.raises(Contradiction, match="is off by") as error:
        eliminate(sp.csr_matrix(np.array(rows)), np.array(right)[:, None], 1e-8)
    assert error.value.row in row
    assert error.value.miss == pytest.approx(miss)
