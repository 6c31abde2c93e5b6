"""Soft modes of a chain that floats, against the dense spectrum."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import eigh

from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.sparse_pattern import SUPPORT_STIFFNESS_FACTOR, SparsePattern
from asterism.equilibrium.newton.soft_modes import softest_modes


@pytest.mark.parametrize("count", [1, 3, 30])
def test_a_floating_chain(count: int) -> None:
    size = 30
    springs = np.linspace(1.0, 2.0, size - 1)
    stiffness = sp.diags_array(
        [-springs, np.r_[springs, 0.0] + np.r_[0.0, springs], -springs], offsets=[-1, 0, 1]
    ).tocsc()
    mass = sp.diags_array(np.linspace(0.5, 3.0, size)).tocsr()
    pattern = SparsePattern.from_lower(sp.csc_matrix(sp.tril(stiffness)))
    data = sp.csc_matrix(sp.tril(stiffness)).data.copy()
    data[pattern.diagonal[4]] += SUPPORT_STIFFNESS_FACTOR * data.max()  # the support
    factor = make_factor(pattern)
    assert factor.factorise(data)
    rigid = np.ones((size, 1)) / np.sqrt(size)
    values, vectors = softest_modes(sp.csr_matrix(mass), factor, rigid, count)
    exact = eigh(stiffness.toarray(), mass.toarray(), eigvals_only=True)[1:]
    assert len(values) == min(count, size - 1)
    assert np.allclose(values, exact[: len(values)], rtol=1e-5)
    assert np.allclose(vectors.T @ mass @ vectors, np.eye(len(values)), atol=1e-8)
    assert np.allclose(vectors.T @ stiffness @ vectors, np.diag(values), rtol=1e-5, atol=1e-5)
    assert np.abs(rigid.T @ (mass @ vectors)).max() < 1e-8


@pytest.mark.parametrize("count", [2, 9])
def test_eigenvalues_that_are_all_the_same(count: int) -> None:
    size = 7
    pattern = SparsePattern.from_lower(sp.csc_matrix(sp.identity(size)))
    factor = make_factor(pattern)
    assert factor.factorise(np.full(size, 6.0))
    mass = sp.csr_matrix(2.0 * sp.identity(size))
    values, vectors = softest_modes(mass, factor, np.empty((size, 0)), count)
    assert np.allclose(values, np.full(min(count, size), 3.0))
    assert np.allclose(vectors.T @ mass @ vectors, np.eye(len(values)), atol=1e-12)
