"""The smallest eigenvalue against dense ones, rigid motions (deflated modes) left out."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.backends import available, make_factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.equilibrium.newton.certificate import Eigenpair, smallest_eigenvalue
from tests.equilibrium.linear.test_factor import random_matrix


def certified(pattern: SparsePattern, data: Floats, modes: Floats | None = None, backend: str = "auto") -> Eigenpair:
    factor = make_factor(pattern, backend)
    none = np.zeros((pattern.size, 0))
    pair = smallest_eigenvalue(pattern, data, factor, none if modes is None else modes)
    factor.close()
    return pair


def assert_is_smallest(pair: Eigenpair, matrix: Floats, allowed: Floats) -> None:
    """allowed: eigenvalues on the complement of the modes, ascending."""
    scale = np.abs(matrix).max()
    assert pair.value == pytest.approx(allowed[0], abs=1e-7 * scale)
    assert np.linalg.norm(pair.vector) == pytest.approx(1.0)
    # what the evidence claims is true: some eigenvalue lies within the residual
    assert np.abs(allowed - pair.value).min() <= pair.error + 1e-13 * scale


@settings(max_examples=60)
@given(
    seed=st.integers(0, 2**32 - 1),
    size=st.integers(3, 40),
    density=st.floats(0.05, 0.6),
    deflated=st.integers(1, 6),
    lowest=st.booleans(),
)
def test_deflated_modes_are_not_seen(seed, size, density, deflated, lowest):
    """Eigenvectors as modes: the lowest ones, which would win, or any others, which must not be missed."""
    rng = np.random.default_rng(seed)
    pattern, data = random_matrix(rng, size, density)
    deflated = min(deflated, size - 1)
    matrix = pattern.full(data).toarray()
    values, vectors = np.linalg.eigh(matrix)
    chosen = np.arange(deflated) if lowest else np.sort(rng.permutation(size)[:deflated])
    rest = np.setdiff1d(np.arange(size), chosen)
    turned = vectors[:, chosen] @ np.linalg.qr(rng.normal(size=(deflated, deflated)))[0]
    pair = certified(pattern, data, turned)
    assert_is_smallest(pair, matrix, values[rest])
    assert np.abs(turned.T @ pair.vector).max() < 1e-7


@pytest.mark.parametrize("smallest", [1.0, 1e-3, 1e-6, -1e-6, -1e-3, -1.0])
@pytest.mark.parametrize("backend", available())
def test_rigid_motions_of_a_chain(smallest, backend):
    """Free masses on springs, drift deflated, and one mode pushed to a value on either side of zero."""
    n = 60
    springs = np.column_stack([np.arange(n - 1), np.arange(1, n)])
    pattern = SparsePattern([springs, np.arange(n)[None]], n, np.arange(n))
    chain = pattern.assemble([np.tile([1.0, -1.0, 1.0], (n - 1, 1)), np.zeros((1, n * (n + 1) // 2))])
    values, vectors = np.linalg.eigh(pattern.full(chain).toarray())
    drift = np.full((n, 1), n**-0.5)
    v = vectors[:, 5]
    i, j = np.tril_indices(n)
    push = ((smallest - values[5]) * np.outer(v, v))[i, j]
    data = chain + pattern.assemble([np.zeros((n - 1, 3)), push[None]])
    pair = certified(pattern, data, drift, backend)
    expected = min(smallest, values[1])
    assert pair.value == pytest.approx(expected, rel=1e-6)
    assert pair.error < 1e-8
    if smallest < values[1]:
        assert abs(pair.vector @ v) == pytest.approx(1.0, abs=1e-6)
