"""From a start to a certified equilibrium, on small energies whose minima and saddles are known.

The smallest eigenvalue against dense ones, rigid motions (deflated modes) left out.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.backends import available, make_factor
from asterism.equilibrium.linear.multigrid import MultigridFactor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.equilibrium.newton.certificate import Eigenpair, leave_saddle, smallest_eigenvalue
from asterism.equilibrium.newton.minimise import Minimum, find_minimum, is_definite_on_support
from tests.equilibrium.linear.test_factor import random_matrix
from tests.equilibrium.newton.test_minimise import Analytic, double_well

TOLERANCE = 1e-10


def settled(problem: Analytic, start: list[float], iterate: Callable[[Floats], Minimum]) -> Minimum:
    factor = make_factor(problem.pattern)
    found = find_minimum(problem, np.array(start), factor, TOLERANCE, iterate, max_change=0.5)
    factor.close()
    return found


def stopped_at(problem: Analytic, place: list[float]) -> Minimum:
    state = np.array(place)
    norm = float(np.linalg.norm(problem.gradient(state)))
    return Minimum(state, problem.energy(state), norm, TOLERANCE, False, 1, 1)


@pytest.mark.parametrize(("stop", "well"), [([-0.8, 0.1], -1.0), ([-3.0, 0.0], 1.0)])
def test_where_an_iteration_fails_the_lower_of_its_ends_is_followed(stop, well):
    """It began near the right well: what it reached counts if that is lower, else the beginning."""
    problem = double_well()
    found = settled(problem, [0.5, 0.5], lambda state: stopped_at(problem, stop))
    assert found.fallbacks == 1 and found.is_minimum and found.saddles_left == 0
    np.testing.assert_allclose(found.state, [well, 0.0], atol=1e-9)


def test_an_eigenvalue_of_zero_is_no_saddle_to_leave():
    """A minimum of fourth order: the Hessian proves nothing, and there is no way down to look for."""
    stiffness = np.arange(5.0)
    problem = Analytic(
        lambda x: x[0] ** 4 + 0.5 * stiffness @ x**2,
        lambda x: np.r_[4.0 * x[0] ** 3, (stiffness * x)[1:]],
        lambda x: np.diag(np.r_[12.0 * x[0] ** 2, stiffness[1:]]),
        5,
    )
    starts = []

    def stay(state: Floats) -> Minimum:
        starts.append(state)
        assert len(starts) == 1, "nothing was left"
        return stopped_at(problem, [0.0] * 5)

    found = settled(problem, [0.1] * 5, stay)
    assert found.converged and not found.definite and not found.is_minimum
    assert found.saddles_left == 0 and found.lowest is not None
    assert abs(found.lowest.value) <= found.lowest.error < 1e-8


def test_what_is_not_proven_is_no_minimum() -> None:
    """A solver that iterates accepts what it has not refuted."""

    class Lenient(MultigridFactor):
        proof = True

        def factorise(self, data: Floats) -> bool:
            return True

        def proves_definite(self) -> bool:
            return self.proof

    problem, place = double_well(), np.zeros(2)
    data = problem.hessian(place, 0.0)
    factor = Lenient(problem.pattern, make_factor)
    assert is_definite_on_support(problem, place, data, factor)
    factor.proof = False
    assert not is_definite_on_support(problem, place, data, factor)


@pytest.mark.parametrize("tilt", [0.2, -0.2])
def test_it_leads_to_the_lower_side(tilt: float) -> None:
    for way in (1.0, -1.0):
        end = leave_saddle(double_well(tilt), np.zeros(2), np.array([way, 0.0]), 2.0)
        assert end[0] * tilt > 0.0


def test_of_equal_sides_it_is_always_the_same_one() -> None:
    ends = [
        leave_saddle(double_well(tilt), np.zeros(2), np.array([way, 0.0]), 2.0)[0]
        for way in (1.0, -1.0)
        for tilt in (0.0, 1e-9, -1e-9, 1e-3, -1e-3)
    ]
    assert np.abs(ends) == pytest.approx(1.0)
    assert len({*np.sign(ends)}) == 1


def test_no_unknown_moves_further_than_allowed() -> None:
    end = leave_saddle(double_well(0.2), np.zeros(2), np.array([0.1, 0.02]), 0.25)
    assert np.abs(end).max() == pytest.approx(0.25)


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
