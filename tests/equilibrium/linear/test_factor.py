"""Every installed factorisation reuses its pattern, solves, and never takes an indefinite matrix for a definite one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import BackendError
from asterism.equilibrium.linear.backends import BACKENDS, Backend, available, make_factor
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.pardiso import PardisoFactor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.previews.solve import WatchedFactor

SIDE = 12


def grid_pattern(side: int) -> SparsePattern:
    """Quadrilaterals of a square grid, one dof a node."""
    n = side + 1
    corner = (np.arange(side)[:, None] * n + np.arange(side)).ravel()
    return SparsePattern([np.column_stack([corner, corner + 1, corner + n, corner + n + 1])], n * n, np.arange(n * n))


PATTERN = grid_pattern(SIDE)


def laplacian(seed: int = 0) -> Floats:
    """Entries of a positive semidefinite matrix with the constants in its kernel."""
    rng = np.random.default_rng(seed)
    i, j = np.tril_indices(4)
    vectors = rng.normal(size=(SIDE * SIDE, 4, 4))
    vectors -= vectors.mean(axis=1, keepdims=True)
    elements = np.einsum("eik,ejk->eij", vectors, vectors)
    return PATTERN.assemble([elements[:, i, j]])


def random_matrix(rng: np.random.Generator, size: int, density: float) -> tuple[SparsePattern, Floats]:
    pairs = np.argwhere(np.tril(rng.random((size, size)) < density, -1))
    pattern = SparsePattern([pairs.reshape(-1, 2)], size, np.arange(size))
    return pattern, rng.normal(size=pattern.nnz)


def dense(data: Floats) -> Floats:
    return np.asarray(PATTERN.full(data).toarray())


def shifted(data: Floats, shift: float) -> Floats:
    out = data.copy()
    out[PATTERN.diagonal] += shift
    return out


@pytest.fixture(params=available())
def factor(request: pytest.FixtureRequest) -> Iterator[Factor]:
    made = make_factor(PATTERN, request.param)
    yield made
    made.close()


@pytest.mark.parametrize("name", [name for name in available() if name != "amg"])
def test_memory_is_given_back_once(name: str) -> None:
    made = make_factor(PATTERN, name)
    assert made.factorise(shifted(laplacian(), 1.0))
    made.close()
    made.close()


@pytest.mark.skipif("pardiso" not in available(), reason="PARDISO is not installed")
def test_what_nobody_closes_gives_its_memory_back() -> None:
    made = PardisoFactor(PATTERN)
    release = made._release
    assert release.alive
    del made
    assert not release.alive


def test_unknown_backend_is_named_with_what_there_is():
    with pytest.raises(ValueError, match=r"'umfpack'.*superlu"):
        make_factor(PATTERN, "umfpack")


def test_solves_again_and_again_with_one_pattern(factor):
    rng = np.random.default_rng(1)
    for seed in range(5):
        data = shifted(laplacian(seed), 10.0**-seed)
        assert factor.factorise(data)
        for b in (rng.normal(size=PATTERN.size), rng.normal(size=(PATTERN.size, 3))):
            x = factor.solve(b)
            assert x.shape == b.shape
            expected = np.linalg.solve(dense(data), b)
            np.testing.assert_allclose(x, expected, atol=1e-10 * np.abs(expected).max())


def test_inputs_are_left_alone(factor):
    data, b = shifted(laplacian(), 1.0), np.ones(PATTERN.size)
    before = data.copy(), b.copy()
    factor.factorise(data)
    x = factor.solve(b)
    np.testing.assert_array_equal(data, before[0])
    np.testing.assert_array_equal(b, before[1])
    # and a solution is not overwritten by the next one
    kept = x.copy()
    factor.solve(2.0 * b)
    np.testing.assert_array_equal(x, kept)


def test_two_factors_at_once(factor):
    """Each keeps its own matrix."""
    other = make_factor(PATTERN, factor.name)
    b = np.ones(PATTERN.size)
    assert factor.factorise(shifted(laplacian(0), 1.0))
    assert other.factorise(shifted(laplacian(1), 2.0))
    np.testing.assert_allclose(dense(shifted(laplacian(0), 1.0)) @ factor.solve(b), b, atol=1e-11)
    np.testing.assert_allclose(dense(shifted(laplacian(1), 2.0)) @ other.solve(b), b, atol=1e-11)
    other.close()
    np.testing.assert_allclose(dense(shifted(laplacian(0), 1.0)) @ factor.solve(b), b, atol=1e-11)


@pytest.mark.parametrize("relative", [1e-2, 1e-6, 1e-9, 1e-12])
def test_one_eigenvalue_just_below_zero(factor, relative):
    """The matrix is moved along its own kernel: the sign of one eigenvalue decides, however small it is."""
    data = laplacian()
    scale = np.abs(data).max()
    kernel = np.linalg.eigvalsh(dense(data))[0]
    assert abs(kernel) < 1e-13 * scale
    assert factor.factorise(shifted(data, relative * scale))
    assert not factor.factorise(shifted(data, -relative * scale))
    # and it recovers
    assert factor.factorise(shifted(data, scale))
    x = factor.solve(np.ones(PATTERN.size))
    np.testing.assert_allclose(x, 1.0 / scale, rtol=1e-10)


def test_indefinite_with_a_positive_diagonal(factor):
    """An LDL^T without pivoting passes through these quietly."""
    data = np.ones(PATTERN.nnz)
    data[PATTERN.diagonal] = 1.0 + 1e-3
    assert np.linalg.eigvalsh(dense(data))[0] < 0.0
    assert not factor.factorise(data)


@pytest.mark.parametrize("entries", [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0, 0.0, 1.0, 0.0]])
@pytest.mark.parametrize("name", available())
def test_pivots_that_are_exactly_zero(name, entries):
    """An LU that exchanges rows there ends with positive pivots: two masses that only pull at each other, and three."""
    size = 2 if len(entries) == 3 else 3
    pattern = SparsePattern([np.arange(size)[None]], size, np.arange(size))
    made = make_factor(pattern, name)
    assert not made.factorise(pattern.assemble([np.array([entries])]))
    made.close()


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_not_finite(factor, bad):
    data = shifted(laplacian(), 1.0)
    for place in (0, PATTERN.nnz // 2, PATTERN.nnz - 1):
        broken = data.copy()
        broken[place] = bad
        assert not factor.factorise(broken)
    assert factor.factorise(data)
    assert np.isfinite(factor.solve(np.ones(PATTERN.size))).all()


@pytest.mark.slow
@settings(max_examples=100)
@given(seed=st.integers(0, 2**32 - 1), size=st.integers(1, 30), density=st.floats(0.0, 0.5), shift=st.floats(-2.0, 6.0))
def test_verdict_is_that_of_dense_eigenvalues(seed, size, density, shift):
    """Random symmetric matrices of any pattern: also diagonal, of size one, or in parts that are not connected."""
    rng = np.random.default_rng(seed)
    pattern, data = random_matrix(rng, size, density)
    data[pattern.diagonal] += shift
    full = pattern.full(data).toarray()
    smallest = np.linalg.eigvalsh(full)[0]
    if abs(smallest) < 1e-9:
        return
    for name in available():
        factor = make_factor(pattern, name)
        assert factor.factorise(data) == (smallest > 0.0), name
        if smallest > 0.0:
            b = rng.normal(size=size)
            np.testing.assert_allclose(full @ factor.solve(b), b, atol=1e-9 * np.linalg.cond(full))
        factor.close()


def test_pattern_drops_held_dofs_and_sums_elements():
    """Two springs in a row, the middle free, one end held: against a matrix assembled by hand."""
    springs = np.array([[2, 0], [0, 3]])
    free = np.array([0, 3])
    pattern = SparsePattern([springs, np.array([[3]])], 4, free)
    stiff = np.array([[5.0, -5.0, 5.0], [7.0, -7.0, 7.0]])
    data = pattern.assemble([stiff, np.array([[11.0]])])
    np.testing.assert_array_equal(pattern.lower(data).toarray(), [[12.0, 0.0], [-7.0, 18.0]])
    np.testing.assert_array_equal(data[pattern.diagonal], [12.0, 18.0])
    x = np.array([[1.0, 2.0], [3.0, -1.0]])
    full = sp.csr_matrix([[12.0, -7.0], [-7.0, 18.0]])
    np.testing.assert_allclose(pattern.product(data, x), full @ x)
    np.testing.assert_allclose(pattern.product(data, x[:, 0]), full @ x[:, 0])


def test_a_package_without_its_shared_library_is_not_available(monkeypatch: pytest.MonkeyPatch) -> None:
    def make(pattern: SparsePattern) -> Factor:
        raise ImportError("mkl_rt not found")

    monkeypatch.setitem(BACKENDS, "pardiso", Backend("pardiso", "numpy", make))
    with pytest.raises(BackendError, match="backend: 'pardiso' is not available: mkl_rt not found"):
        make_factor(PATTERN, "pardiso")
    assert make_factor(PATTERN).name != "pardiso"


def test_watch_is_called_and_may_raise() -> None:
    pattern = SparsePattern([np.array([[0, 1], [1, 2]])], 3, np.arange(3))
    data = pattern.assemble([np.array([[2.0, -1.0, 2.0], [2.0, -1.0, 2.0]])])
    calls: list[int] = []
    factor = make_factor(pattern, "superlu")
    watched = WatchedFactor(factor, lambda: calls.append(len(calls)))
    assert watched.name == factor.name and watched.factorise(data)
    b = np.arange(3.0)
    assert np.array_equal(watched.solve(b), factor.solve(b)) and len(calls) == 2

    def stop() -> None:
        raise KeyboardInterrupt

    watched.watch = stop
    with pytest.raises(KeyboardInterrupt):
        watched.factorise(data)
    watched.close()
