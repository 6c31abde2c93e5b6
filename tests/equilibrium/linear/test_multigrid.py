"""Multigrid: the solution and the verdict of a factorisation, never a proof of what is not so."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.discrete.model.contact_model import ReanalysingFactor
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release import continuation
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.release_start import ReleaseStart
from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import BackendError
from asterism.equilibrium.linear import backends, multigrid
from asterism.equilibrium.linear.backends import available, make_factor, make_solver
from asterism.equilibrium.linear.multigrid import (
    ConjugateGradients,
    MultigridFactor,
    NotPositiveDefiniteError,
    proves_definite,
    solve_by_conjugate_gradients,
)
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.equilibrium.newton import certificate
from asterism.equilibrium.newton.certificate import smallest_eigenvalue
from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from tests.discrete.models import tube
from tests.equilibrium.linear.test_factor import grid_pattern

SIDE = 30


def grid() -> tuple[SparsePattern, Floats]:
    """Laplacian of a square of quadrilaterals; constants are its kernel."""
    pattern = grid_pattern(SIDE)
    i, j = np.tril_indices(4)
    element = (4.0 * np.eye(4) - np.ones((4, 4)))[i, j]
    return pattern, pattern.assemble([np.tile(element, (SIDE * SIDE, 1))])


PATTERN, LAPLACIAN = grid()


def shifted(amount: float) -> Floats:
    data = LAPLACIAN.copy()
    data[PATTERN.diagonal] += amount
    return data


@pytest.fixture(scope="module")
def sheet() -> tuple[DiscreteModel, object]:
    """Seven stars, and their equilibrium."""
    model = tube(2.5)
    return model, solve_on_mesh(model)


def test_solves_a_laplacian_in_few_iterations():
    factor = MultigridFactor(PATTERN, make_factor, min_unknowns=0)
    data, b = shifted(1e-3), np.random.default_rng(0).standard_normal((PATTERN.size, 2))
    assert factor.factorise(data)
    np.testing.assert_allclose(factor.solve(b), np.linalg.solve(PATTERN.full(data).toarray(), b), atol=1e-7)
    assert factor.proves_definite()
    run = ConjugateGradients(factor.product, factor.precondition, b[:, 0])
    for _ in range(25):
        run.step()
    assert np.linalg.norm(run.residual) < 1e-6 * np.linalg.norm(b[:, 0])


def test_tolerance_is_kept():
    factor = MultigridFactor(PATTERN, make_factor, min_unknowns=0)
    data, b = shifted(1e-3), np.random.default_rng(0).standard_normal(PATTERN.size)
    factor.factorise(data)
    for tolerance in (1e-1, 1e-4, 1e-9):
        rest = np.linalg.norm(b - PATTERN.product(data, factor.solve(b, tolerance))) / np.linalg.norm(b)
        assert rest <= 1.01 * tolerance
    np.testing.assert_array_equal(factor.solve(np.zeros(PATTERN.size)), 0.0)


@pytest.mark.parametrize("below", [1e-9, 1e-5, 1e-2, 1.0])
def test_indefinite_matrices_are_never_proven(below):
    """The kernel moved below zero; below 1e-9 it drowns in nothing yet."""
    factor = MultigridFactor(PATTERN, make_factor, min_unknowns=0)
    assert not (factor.factorise(shifted(-below)) and factor.proves_definite())
    assert factor.factorise(shifted(below)) and factor.proves_definite()


@settings(max_examples=60)
@given(seed=st.integers(0, 2**32 - 1), rank=st.integers(1, 3), push=st.floats(-2.0, 1.0))
def test_proof_is_that_of_dense_eigenvalues(seed, rank, push):
    """A few eigenvalues moved to either side of zero, along modes that the coarse level does not know."""
    rng = np.random.default_rng(seed)
    size = 60
    pattern = SparsePattern([np.arange(size)[None]], size, np.arange(size))
    q = np.linalg.qr(rng.normal(size=(size, size)))[0]
    values = rng.uniform(0.5, 2.0, size)
    values[:rank] = push
    i, j = np.tril_indices(size)
    data = pattern.assemble([((q * values) @ q.T)[i, j][None]])
    factor = MultigridFactor(pattern, make_factor, min_unknowns=0)
    proven = factor.factorise(data) and factor.proves_definite()
    if push <= 0.0:
        assert not proven
    if push > 1e-3:
        assert proven


def test_negative_curvature_is_said():
    diagonal = np.array([3.0, 1.0, -1e-3])
    with pytest.raises(NotPositiveDefiniteError):
        solve_by_conjugate_gradients(lambda v: diagonal * v, lambda v: v.copy(), np.ones(3), 1e-12, 100)
    assert not proves_definite(lambda v: diagonal * v, lambda v: v.copy(), 3, 1.0)
    assert proves_definite(lambda v: abs(diagonal) * v, lambda v: v.copy(), 3, 1.0)


@pytest.mark.parametrize("size", [5, 10, 20])
def test_a_chain_that_floats_is_never_proven_definite(size):
    """Singular: rounding takes the drift out of the residual in the end, by steps without measure."""
    chain = 2.0 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1)
    chain[0, 0] = chain[-1, -1] = 1.0
    held = chain + np.diag(np.r_[1.0, np.zeros(size - 1)])
    for seed in range(10):
        assert not proves_definite(lambda v: chain @ v, lambda v: v.copy(), size, 1.0, seed)
        assert proves_definite(lambda v: held @ v, lambda v: v.copy(), size, 1.0, seed)


def test_a_residual_that_has_grown_a_million_times_proves_nothing():
    """A preconditioner that misses the soft direction by nine orders: what falls afterwards is mostly rounding."""
    stiff = np.array([1e8, 1.0])
    assert not proves_definite(lambda v: stiff * [1.0, 1e-9] * v, lambda v: v / stiff, 2, 1e8)
    assert proves_definite(lambda v: stiff * [1.0, 0.1] * v, lambda v: v / stiff, 2, 1e8)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1.0])
def test_bad_entries_are_refused(bad):
    factor = MultigridFactor(PATTERN, make_factor, min_unknowns=0)
    data = shifted(1.0)
    data[PATTERN.diagonal[3]] = bad
    assert not factor.factorise(data)


@pytest.mark.skipif("pardiso" not in available(), reason="only PARDISO knows its memory in advance")
def test_small_memory_takes_multigrid(monkeypatch):
    assert make_solver(PATTERN).name == "pardiso"
    monkeypatch.setattr(backends, "physical_memory_mb", lambda: 0.1)
    assert make_solver(PATTERN).name == "amg"
    assert make_solver(PATTERN, "pardiso").name == "pardiso"


def test_contact_is_refused_in_one_line():
    class Problem:
        pattern = PATTERN

    with pytest.raises(BackendError, match=r"amg.*contact"):
        ReanalysingFactor(Problem(), "amg")


@pytest.mark.slow
def test_eigenvalue_without_a_factorisation(sheet, monkeypatch):
    monkeypatch.setattr(certificate, "MAX_LANCZOS_UNKNOWNS", 0)
    model, found = sheet
    data = model.hessian(found.state, 0.0)
    factor = MultigridFactor(model.pattern, make_factor, min_unknowns=0)
    factor.set_near_nullspace(*model.near_nullspace(found.state))
    pair = smallest_eigenvalue(model.pattern, data, factor, model.rigid_modes(found.state))
    assert pair.value == pytest.approx(found.smallest_eigenvalue, rel=1e-5)
    assert pair.error < 0.1 * pair.value


@pytest.mark.slow
def test_same_minimum_as_a_factorisation(sheet, monkeypatch):
    """From where the arms start to bend to the certificate."""
    monkeypatch.setattr(certificate, "MAX_LANCZOS_UNKNOWNS", 0)
    monkeypatch.setattr(multigrid, "MIN_UNKNOWNS", 0)
    monkeypatch.setattr(MultigridFactor.__init__, "__defaults__", (0,))
    model, _ = sheet
    with monkeypatch.context() as patch:
        patch.setattr(continuation, "MAX_ITERATIONS", 6)
        start = solve_on_mesh(model, ReleaseStart(releases=(0.5, 1.0))).state
    one, other = solve_on_mesh(model, start), solve_on_mesh(model, start, backend="amg")
    assert other.is_minimum and other.backend == "amg"
    assert other.energy == pytest.approx(one.energy, rel=1e-9)
    assert other.smallest_eigenvalue == pytest.approx(one.smallest_eigenvalue, rel=1e-4)


@pytest.mark.slow
def test_whole_simulation():
    """Small sheets are factorised by this backend too, so that it can be asked for always."""
    design = gallery.load("star")
    shape, direct = exact_shape(design, "amg"), exact_shape(design)
    assert shape.summary["is_minimum"] and shape.summary["backend"] == "amg"
    assert shape.summary["energy_n_mm"] == pytest.approx(direct.summary["energy_n_mm"], rel=1e-8)
