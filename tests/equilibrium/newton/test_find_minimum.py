"""From a start to a certified equilibrium, on small energies whose minima and saddles are known."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.newton.certificate import leave_saddle
from asterism.equilibrium.newton.minimise import Minimum, find_minimum, is_definite_on_support
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

    class Lenient:
        name = "lenient"

        def __init__(self, proof: bool) -> None:
            self._proof = proof

        def factorise(self, data: Floats) -> bool:
            return True

        def proves_definite(self) -> bool:
            return self._proof

        def solve(self, b: Floats, tolerance: float = 0.0) -> Floats:
            return b

        product = precondition = solve

        def set_near_nullspace(self, nodes: object, modes: object) -> None: ...

        def close(self) -> None: ...

    problem, place = double_well(), np.zeros(2)
    data = problem.hessian(place, 0.0)
    assert is_definite_on_support(problem, place, data, Lenient(True))
    assert not is_definite_on_support(problem, place, data, Lenient(False))


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
