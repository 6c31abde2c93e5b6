"""Newton on small problems whose minima are known.

From a start to a certified equilibrium, on small energies whose minima and saddles are known. The smallest eigenvalue
against dense ones, rigid motions (deflated modes) left out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.linear.backends import available, make_factor
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.multigrid import MultigridFactor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.equilibrium.newton.certificate import Eigenpair, leave_saddle, smallest_eigenvalue
from asterism.equilibrium.newton.minimise import (
    MAX_FORCING_TERM,
    Iteration,
    Minimum,
    find_minimum,
    is_definite_on_support,
    minimise,
)
from tests.equilibrium.linear.test_factor import random_matrix


@dataclass
class Analytic:
    """An energy over R^n with its derivatives written out; all steps are straight, and no motion is rigid."""

    value: Callable[[Floats], float]
    slope: Callable[[Floats], Floats]
    bow: Callable[[Floats], Floats]
    size: int
    longest: float = np.inf
    held: tuple[int, ...] = ()
    visited: list[Floats] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.pattern = SparsePattern([np.arange(self.size)[None]], self.size, np.arange(self.size))

    def energy(self, state: Floats) -> float:
        self.visited.append(state)
        with np.errstate(all="ignore"):
            return float(self.value(state))

    def gradient(self, state: Floats) -> Floats:
        return np.asarray(self.slope(state), dtype=float)

    def hessian(self, state: Floats, blend: float) -> Floats:
        h = np.asarray(self.bow(state), dtype=float)
        values, vectors = np.linalg.eigh(h)
        convex = (vectors * np.maximum(values, 0.0)) @ vectors.T
        i, j = np.tril_indices(self.size)
        return self.pattern.assemble([((1.0 - blend) * h + blend * convex)[i, j][None]])

    def support(self, state: Floats) -> Ints:
        return np.array(self.held, dtype=np.int64)

    def rigid_modes(self, state: Floats) -> Floats:
        return np.zeros((self.size, 0))

    def path(self, state: Floats, direction: Floats) -> tuple[Callable[[float], Floats], float]:
        return (lambda a: state + a * direction), self.longest


class Patient:
    """A factorisation that fails the test where Newton would try matrices for ever."""

    def __init__(self, factor: Factor) -> None:
        self.name, self.solve, self._factor = factor.name, factor.solve, factor
        self.verdicts: list[bool] = []

    def factorise(self, data: Floats) -> bool:
        assert len(self.verdicts) < 2000, "no end in sight"
        self.verdicts.append(self._factor.factorise(data))
        return self.verdicts[-1]

    def close(self) -> None:
        self._factor.close()


def run(problem: Analytic, start: list[float] | Floats, tolerance: float = 1e-10, **options: object) -> Minimum:
    factor = Patient(make_factor(problem.pattern))
    found = minimise(problem, np.asarray(start, dtype=float), factor, tolerance, **options)  # type: ignore[arg-type]
    factor.close()
    return found


def assert_downhill(found: Minimum) -> None:
    energies = np.array([entry.energy for entry in found.history])
    assert (np.diff(energies) <= 1e-10 * np.abs(energies[:-1])).all()


def rosenbrock() -> Analytic:
    return Analytic(
        lambda x: 100.0 * (x[1] - x[0] ** 2) ** 2 + (1.0 - x[0]) ** 2,
        lambda x: [-400.0 * x[0] * (x[1] - x[0] ** 2) - 2.0 * (1.0 - x[0]), 200.0 * (x[1] - x[0] ** 2)],
        lambda x: [[1200.0 * x[0] ** 2 - 400.0 * x[1] + 2.0, -400.0 * x[0]], [-400.0 * x[0], 200.0]],
        2,
    )


def double_well(tilt: float = 0.0) -> Analytic:
    """Minima at about (+-1, 0) of energy -1, a saddle between them; a positive tilt lowers the right one."""
    return Analytic(
        lambda x: x[0] ** 4 - 2.0 * x[0] ** 2 - tilt * x[0] ** 3 + x[1] ** 2,
        lambda x: [4.0 * x[0] ** 3 - 4.0 * x[0] - 3.0 * tilt * x[0] ** 2, 2.0 * x[1]],
        lambda x: [[12.0 * x[0] ** 2 - 4.0 - 6.0 * tilt * x[0], 0.0], [0.0, 2.0]],
        2,
    )


def test_quadratic_takes_one_step():
    h = np.array([[4.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 2.0]])
    b = np.array([1.0, -2.0, 3.0])
    problem = Analytic(lambda x: 0.5 * x @ h @ x - b @ x, lambda x: h @ x - b, lambda x: h, 3)
    found = run(problem, [5.0, -7.0, 2.0], tolerance=1e-6)
    assert found.converged and found.definite and found.iterations == 1
    np.testing.assert_allclose(found.state, np.linalg.solve(h, b), atol=1e-7)


@pytest.mark.parametrize("start", [[-1.2, 1.0], [0.0, 0.0], [3.0, -5.0], [-1.0, 4.0], [0.0, 2.0]])
def test_rosenbrock(start):
    found = run(rosenbrock(), start, shift=0.0)
    assert found.converged and found.definite
    np.testing.assert_allclose(found.state, [1.0, 1.0], atol=1e-9)
    assert_downhill(found)
    assert found.iterations < 40


def test_quadratic_convergence_at_the_end():
    """The regularisation is off near a minimum: each gradient is of the order of the square of the last."""
    found = run(rosenbrock(), [-1.2, 1.0], shift=0.0)
    norms = [entry.gradient_norm for entry in found.history]
    assert found.history[-1].blend == 0.0
    assert norms[-1] < 1e-4 * norms[-2] and norms[-2] < 0.1 * norms[-3]


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("away", [1e-6, 1e-2, 0.5])
def test_double_well_from_near_its_saddle(side, away):
    """Negative curvature at the start: down to the well on that side."""
    found = run(double_well(), [side * away, 1.0])
    assert found.converged and found.definite
    assert found.energy == pytest.approx(-1.0)
    assert abs(found.state[0]) == pytest.approx(1.0)
    if away > 1e-3:
        assert np.sign(found.state[0]) == side
    assert_downhill(found)


@pytest.mark.parametrize("start", [[0.0, 0.0], [0.0, 1.0]])
def test_double_well_from_its_saddle_is_not_called_a_minimum(start):
    """No force leads away from the ridge: Newton ends on the saddle and says that the Hessian there is indefinite."""
    found = run(double_well(), start)
    assert found.converged
    assert not found.definite
    np.testing.assert_allclose(found.state, 0.0, atol=1e-9)


def test_barrier_is_not_crossed():
    """x - ln x: full steps from far away land where there is no energy."""
    problem = Analytic(lambda x: (x - np.log(x)).sum(), lambda x: 1.0 - 1.0 / x, lambda x: np.diag(1.0 / x**2), 2)
    found = run(problem, [1e-3, 30.0])
    assert found.converged
    np.testing.assert_allclose(found.state, 1.0, atol=1e-9)
    assert min(x.min() for x in problem.visited) < 0.0, "the line search was put to the test"
    assert all(np.isfinite(entry.energy) for entry in found.history)


def test_steps_are_no_longer_than_the_path_allows():
    problem = double_well()
    problem.longest = 0.1
    found = run(problem, [0.9, 5.0])
    assert found.converged
    assert max(entry.step for entry in found.history) <= 0.1
    assert found.iterations > 100


def test_stops_when_told():
    seen: list[Iteration] = []
    found = run(rosenbrock(), [-1.2, 1.0], max_iterations=4, report=seen.append)
    assert not found.converged
    assert found.iterations == 4
    assert [entry.number for entry in seen] == [0, 1, 2, 3, 4]
    assert seen == found.history
    assert found.factorisations >= 5


def test_stops_at_a_gradient_that_is_not_a_number():
    problem = Analytic(lambda x: 0.0, lambda x: [np.nan], lambda x: [[1.0]], 1)
    found = run(problem, [1.0])
    assert not found.converged and found.iterations == 0


@pytest.mark.parametrize("held", [(), (0,)])
def test_drift_that_costs_nothing(held):
    """A spring between two free masses: any shift of both is a minimum, with a support or without."""

    def stretch(x: Floats) -> float:
        return x[1] - x[0] - 2.0

    problem = Analytic(
        lambda x: 0.5 * stretch(x) ** 2 + 0.25 * stretch(x) ** 4,
        lambda x: (stretch(x) + stretch(x) ** 3) * np.array([-1.0, 1.0]),
        lambda x: (1.0 + 3.0 * stretch(x) ** 2) * np.array([[1.0, -1.0], [-1.0, 1.0]]),
        2,
        held=held,
    )
    found = run(problem, [3.0, 9.0])
    assert found.converged and found.definite
    assert found.state[1] - found.state[0] == pytest.approx(2.0)
    assert found.iterations < 12


@pytest.mark.parametrize(
    ("scale", "rest", "start", "tolerance"),
    [
        (1.0, -1e8 - 3.0, [1e-3, -2e-3, 0.7], 1e-12),  # a large energy
        (100.0, -300.0, [1.0, -2.0, 0.7], 1e-9),  # zero, of terms that cancel, whose rounding stays
        (100.0, -300.0, [1e-8, -2e-8, 3e-8], 1e-9),
    ],
)
def test_noise_of_the_energy_does_not_stop_the_last_steps(scale, rest, start, tolerance):
    """Near the minimum all digits of a step's gain are lost; the gradient still decides."""
    problem = Analytic(
        lambda x: rest + scale * np.cosh(x).sum(),
        lambda x: scale * np.sinh(x),
        lambda x: scale * np.diag(np.cosh(x)),
        3,
    )
    found = run(problem, start, tolerance=tolerance)
    assert found.converged and found.iterations < 12


def test_gradients_that_are_only_noise_end_it():
    """Energy and gradient are as low as rounding lets them: going on would change nothing, and it has not converged."""
    problem = Analytic(
        lambda x: 1586.0 + 0.5 * (x @ x), lambda x: x + 2e-7 * np.sin(1e12 * x + 1.0), lambda x: np.eye(3), 3
    )
    found = run(problem, [1.0, -2.0, 0.7], tolerance=1e-9)
    assert found.stagnated and not found.converged and found.iterations < 60
    assert np.abs(found.state).max() < 1e-6
    assert not run(problem, [1.0, -2.0, 0.7], tolerance=1e-5).stagnated


class Sloppy(MultigridFactor):
    """An iterative solver that is never more exact than it is asked to be."""

    def __init__(self, pattern: SparsePattern) -> None:
        super().__init__(pattern, make_factor)
        self.asked: list[float] = []

    def solve(self, b: Floats, tolerance: float = 0.0) -> Floats:
        self.asked.append(tolerance)
        rest = np.where(np.arange(len(b)) % 2, -1.0, 1.0) / np.sqrt(len(b))
        return super().solve(b + tolerance * np.linalg.norm(b) * rest)


def test_an_iterative_solver_is_asked_for_no_more_than_quadratic_convergence_takes():
    """Little far away, and near the minimum so much that each gradient is of the order of the square of the last."""
    problem = Analytic(
        lambda x: (np.cosh(x) + x**3 / 6.0).sum(),
        lambda x: np.sinh(x) + x**2 / 2.0,
        lambda x: np.diag(np.cosh(x) + x),
        3,
    )
    factor = Sloppy(problem.pattern)
    found = minimise(problem, np.array([0.5, 1.0, 2.0]), factor, 1e-9, shift=0.0)
    assert found.converged and found.iterations < 9
    norms = np.array([entry.gradient_norm for entry in found.history])
    close = norms[:-1] < 0.1
    assert close.sum() >= 2 and (norms[1:] < 5.0 * norms[:-1] ** 2)[close].all()
    assert factor.asked[0] == MAX_FORCING_TERM and min(factor.asked) < 1e-3
    assert (np.array(factor.asked[1:]) >= 0.1 * (norms[1:-1] / norms[:-2]) ** 2).all()


def test_a_convex_model_that_is_not_quite_convex_is_stiffened_until_it_serves():
    """Rounding of large entries leaves it negative by more than what is added first."""

    class Rounded(Analytic):
        def hessian(self, state: Floats, blend: float) -> Floats:
            data = super().hessian(state, blend)
            data[self.pattern.diagonal] -= 0.05 * blend
            return data

    problem = Rounded(lambda x: np.sin(x).sum(), lambda x: np.cos(x), lambda x: np.diag(-np.sin(x)), 2)
    found = run(problem, [0.5 * np.pi + 0.1, 0.5 * np.pi - 0.2])
    assert found.converged and found.definite
    assert found.energy == pytest.approx(-2.0)
    assert max(entry.blend for entry in found.history) > 1.0


def test_the_iteration_ends_after_a_step_of_small_decrease() -> None:
    def bowl(decrease: float) -> Minimum:
        energy = Analytic(
            lambda x: (x**4).sum() + x @ x, lambda x: 4 * x**3 + 2 * x, lambda x: np.diag(12 * x**2 + 2), 2
        )
        factor = make_factor(energy.pattern, "superlu")
        return minimise(energy, np.array([1.0, -0.5]), factor, 1e-12, small_decrease=decrease, check_definite=False)

    accurate, early = bowl(0.0), bowl(1e-4)
    assert accurate.converged and not accurate.settled
    assert early.settled and not early.converged and early.iterations < accurate.iterations
    # the step itself is taken, and the decrease after it is about the square
    assert early.energy - accurate.energy < 1e-6


def test_a_step_without_the_exact_hessian_does_not_end_the_iteration() -> None:
    """Off a maximum of the energy, the first steps are regularised, and lower the energy by little."""
    energy = Analytic(lambda x: (x**4).sum() - x @ x, lambda x: 4 * x**3 - 2 * x, lambda x: np.diag(12 * x**2 - 2), 1)
    factor = make_factor(energy.pattern, "superlu")
    result = minimise(energy, np.array([1e-3]), factor, 1e-12, small_decrease=1e-3, check_definite=False)
    assert abs(result.state[0]) == pytest.approx(0.5**0.5, rel=1e-2)


def test_the_iteration_ends_beside_a_saddle_that_steps_leave_slowly() -> None:
    """Along y the energy falls by a hundredth as steeply as it rises along x, from a ridge to wells beside it."""
    energy = Analytic(
        lambda x: 50.0 * x[0] ** 2 - 0.5 * x[1] ** 2 + 0.25 * x[1] ** 4,
        lambda x: np.array([100.0 * x[0], -x[1] + x[1] ** 3]),
        lambda x: np.diag([100.0, -1.0 + 3.0 * x[1] ** 2]),
        2,
    )
    ended = run(energy, [1.0, 1e-6], saddle_decrease=1e-5)
    assert ended.near_saddle and not ended.definite and abs(ended.state[1]) < 0.1
    # a small decrease alone is no saddle, and neither is a ridge down which the steps are long
    assert not run(energy, [1e-6, 1.0], saddle_decrease=1e-5).near_saddle
    beyond = run(energy, [1.0, 0.1], saddle_decrease=1e-5)
    assert not beyond.near_saddle and beyond.is_minimum and beyond.state[1] == pytest.approx(1.0)


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
