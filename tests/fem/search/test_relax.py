"""The search finds certified minima; saddles and states that are not converged get no certificate.

Edits: the linear response, then the equilibrium from the state before.
"""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.linalg import eigh

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import SUPPORT_STIFFNESS_FACTOR, SparsePattern
from asterism.equilibrium.newton.minimise import find_minimum
from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.deformation import affine
from asterism.fem.search import relax as search
from asterism.fem.search.linear_response import linear_response
from asterism.fem.search.mixed_newton import MAX_STEP, mixed_newton
from asterism.fem.search.relax import ShellEquilibrium, follow, follow_load_steps, is_collapsing, relax, softest_modes
from asterism.fem.search.simple_shapes import SimpleShape
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields, of_stretch
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.conditions import EdgeSupport, PointSupport
from tests.distances import rms_distance
from tests.fem.hexagons import FIELDS, RADIUS, density, hexagon, radius
from tests.fem.loads import point_load
from tests.fem.meshes import facets_where, rectangle


def height(shell: Shell, x: np.ndarray) -> float:
    """mm between the lowest and the highest vertex, in the principal axes of the sheet."""
    places = shell.space.locate(shell.space.mesh.p.T).value @ x
    return float(np.linalg.svd(places - places.mean(axis=0))[1][2])


@pytest.mark.slow
@pytest.mark.parametrize("name", FIELDS)
def test_the_search_finds_minima_from_fields_alone(name: str) -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS[name])
    found = relax(shell)
    assert found.is_minimum
    assert found.fallbacks == found.load_steps == 0
    assert found.iterations <= 12
    assert found.gradient_norm <= found.tolerance
    assert (found.soft_modes > 0.0).all() and (np.diff(found.soft_modes) >= 0.0).all()
    # the whole spectrum of the dense Hessian: six rigid motions near zero, all others positive
    full = shell.pattern.full(shell.hessian(found.x)).toarray()
    values = np.linalg.eigvalsh(full)
    assert (np.abs(values[:6]) < 1e-7 * values[-1]).all() and values[6] > 1e-12 * values[-1]
    modes = shell.rigid_modes(found.x)
    assert modes.shape[1] == 6
    assert np.abs(full @ modes).max() < 1e-9 * values[-1]


def test_soft_modes_do_not_depend_on_the_mesh_or_the_place() -> None:
    coarse, fine = (relax(Shell(Argyris(hexagon(n)), FIELDS["dome"])).soft_modes for n in (1, 2))
    assert np.allclose(coarse, fine, rtol=2e-3)
    shift, dome = np.array([1e3, -2e3]), FIELDS["dome"]
    there = Fields(dome.density, lambda p: dome.metric(p - shift), lambda p: dome.curvature(p - shift))
    moved = Shell(Argyris(hexagon(1).translated(tuple(shift))), there)
    assert np.allclose(relax(moved).soft_modes, coarse, rtol=1e-4)


def test_a_straight_compressed_strip_is_a_saddle_and_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compressed between clamps: the straight state is stationary but unstable."""
    mesh = rectangle(8, 2, 10.0, 2.0)
    clamps = [
        EdgeSupport(facets_where(mesh, lambda x, y, at=at: np.abs(x - at) < 1e-9), clamped=True) for at in (0.0, 10.0)
    ]
    plate = density().stiffness * np.repeat([[1.0], [1e-3]], 3, axis=0).reshape(6, 1)
    shell = Shell(Argyris(mesh), of_stretch(type(density())(plate), 1.0004), clamps)
    factor = shell.factor()
    flat = mixed_newton(shell, shell.flat, factor, 1e-11 * shell.force_scale)
    assert flat.converged and height(shell, flat.state) < 1e-9
    with monkeypatch.context() as patch:
        patch.setattr("asterism.equilibrium.newton.minimise.MAX_SADDLES", 0)
        left_alone = find_minimum(
            shell, flat.state, factor, 1e-11 * shell.force_scale, lambda x: mixed_newton(shell, x, factor, 1.0), 0.1
        )
    assert left_alone.converged and not left_alone.definite and not left_alone.is_minimum
    assert left_alone.lowest is not None and left_alone.lowest.value < 0.0
    found = follow(shell, flat.state, factor)
    assert found.is_minimum and found.saddles_left >= 1
    assert height(shell, found.x) > 0.05
    assert found.energy < left_alone.energy


def test_a_guess_that_falls_below_a_minimum_is_continued(monkeypatch: pytest.MonkeyPatch) -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS["dome"])
    guesses = [SimpleShape("cap", -2e-3), SimpleShape("flat")]  # the cap is on the wrong side, and stays there
    lowest = relax(shell).energy
    monkeypatch.setattr(search, "CLOSE_GUESS", 10.0)
    for enough in (search.MAX_FURTHER_ITERATIONS, 3):
        monkeypatch.setattr(search, "MAX_FURTHER_ITERATIONS", enough)
        found = relax(shell, shapes=guesses)
        assert found.is_minimum and found.guess == "flat"
        assert found.energy == pytest.approx(lowest)
        assert found.trials[0].is_minimum and found.trials[0].energy > 2.0 * lowest
    assert [trial.is_minimum for trial in found.trials] == [True, False, True]
    # a guess above the minimum is not continued
    monkeypatch.setattr(search, "MAX_FURTHER_ITERATIONS", 0)
    assert [trial.is_minimum for trial in relax(shell, shapes=guesses).trials] == [True, False]


def test_load_steps_reach_the_same_bowl() -> None:
    shell = Shell(Argyris(hexagon(1)), FIELDS["bowl"])
    stepped, iterations = follow_load_steps(shell, shell.factor(), 4)
    assert stepped is not None and stepped.is_minimum and shell.progress == 1.0
    assert iterations >= stepped.iterations + 3  # each step before the last takes one at least
    assert stepped.energy == pytest.approx(relax(shell).energy, rel=1e-9)
    # and end with their budget
    stepped, iterations = follow_load_steps(shell, shell.factor(), 4, max_iterations=1)
    assert stepped is None and 1 < iterations < 30


@pytest.mark.parametrize("side, sign", [("up", 1.0), ("down", -1.0)])
def test_the_side_can_be_chosen(side, sign) -> None:  # type: ignore[no-untyped-def]
    """A sheet without rest curvature forms a dome to either side with the same energy."""
    fields = of_stretch(density(), lambda p: 0.85 - 0.1 * (np.linalg.norm(p, axis=-1) / RADIUS) ** 2)
    shell = Shell(Argyris(hexagon(1)), fields)
    found = relax(shell, side=side)
    edge = np.array([[0.0, 0.0], *(0.99 * shell.space.mesh.p.T[[1, 3, 5]])])
    z = (shell.space.locate(edge).value @ found.x)[:, 2]
    assert found.is_minimum and sign * (z[1:].mean() - z[0]) > 5.0
    assert found.energy == pytest.approx(relax(shell, shapes=[SimpleShape("cap", 0.004)]).energy, rel=1e-8)


def test_impossible_arguments_are_refused() -> None:
    shell = Shell(Argyris(hexagon(0)), FIELDS["rolled"])
    with pytest.raises(ValueError, match=r"shapes = \[\]: at least one"):
        relax(shell, shapes=[])
    with pytest.raises(ValueError, match="max_guesses = 0"):
        relax(shell, max_guesses=0)
    with pytest.raises(ValueError, match="side = 'sideways': must be auto, up, down"):
        relax(shell, side="sideways")  # type: ignore[arg-type]
    for loads in (np.ones((3, 3)), np.full(shell.flat.shape, np.nan)):
        with pytest.raises(ValueError, match=r"loads must be finite, shape \(\d+, 3\)"):
            Shell(Argyris(hexagon(0)), FIELDS["rolled"], loads=loads)


@pytest.mark.slow
@pytest.mark.parametrize(("gaussian", "tried"), [(0.0, [4, 16]), (-73.0, [])])  # five times the limit of definiteness
def test_a_sheet_that_collapses_is_not_followed_in_load_steps(
    gaussian: float, tried: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(search, "MAX_ITERATIONS", 3)
    monkeypatch.setattr(search, "MAX_DESCENT_ITERATIONS", 30)
    steps: list[int] = []

    def counted(shell: Shell, factor: Factor, count: int, most: int) -> tuple[ShellEquilibrium | None, int]:
        steps.append(count)
        return follow_load_steps(shell, factor, count, most)

    monkeypatch.setattr(search, "follow_load_steps", counted)
    shell = Shell(Argyris(hexagon(1)), Fields(density(), curvature=(0.004, 0.004, 0.0), gaussian=gaussian))
    found = relax(shell)
    assert steps == tried and is_collapsing(shell, found) == (not tried) == (not found.is_minimum)


def test_a_search_that_comes_near_a_known_minimum_ends_at_it() -> None:
    mesh = hexagon(1)
    shell = Shell(Argyris(mesh), FIELDS["dome"], [EdgeSupport(mesh.boundary_facets(), affine(0.8 * np.eye(3)[:, :2]))])
    factor = shell.factor()
    minimum = relax(shell, factor, soft_modes=0).x
    start = shell.constrain(minimum + 0.2 * minimum[:, 2:] * [0.0, 0.0, 1.0])
    alone, again = (follow(shell, start, factor, known=known) for known in ([], [minimum]))
    assert alone.is_minimum and again.is_minimum
    assert alone.x == pytest.approx(minimum, abs=1e-6)
    assert np.array_equal(again.x, minimum) and again.iterations < alone.iterations


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


def dome(amount: float) -> Fields:
    """Fields of a bowl that deepens with the amount."""
    return of_stretch(density(100.0), lambda p: 0.85 - (0.1 + amount) * radius(p) ** 2, 0.004 + 0.1 * amount)


def distance(shell: Shell, x: Floats, y: Floats) -> float:
    """Rms distance in mm at the vertices after a rigid fit."""
    at = shell.space.locate(shell.space.mesh.p.T).value
    return rms_distance(at @ x, at @ y)


def test_the_response_is_the_derivative() -> None:
    """The error of the linear response is of second order in the edit; a free sheet's has no rigid motion."""
    shell = Shell(Argyris(hexagon(1)), dome(0.0))
    factor = shell.factor()
    start = relax(shell, factor)
    errors, moves = [], []
    for amount in (0.01, 0.005):
        follow(shell, start.x, factor)  # the factor belongs to the start again
        edited = shell.with_fields(dome(amount))
        guess = linear_response(edited, start.x, factor)
        moved = edited.restrict(guess.x - start.x)
        assert np.linalg.norm(edited.rigid_modes(start.x).T @ moved) < 1e-9 * np.linalg.norm(moved)
        found = follow(edited, guess.x, factor, strains=guess.strains)
        assert found.is_minimum and found.factorisations <= 3  # that of the certificate among them
        errors.append(distance(shell, guess.x, found.x))
        moves.append(distance(shell, start.x, found.x))
    assert moves[0] > 0.5
    assert errors[0] < 0.05 * moves[0]
    assert 3.3 < errors[0] / errors[1] < 4.7


def test_with_fields_shares_the_pattern_and_leaves_the_first_shell_unchanged() -> None:
    """It equals a newly built shell bit for bit, also its loads and its cached properties."""
    loads = point_load(Argyris(hexagon(1)), np.zeros(2), np.array([0.0, 0.0, 1e-3]))
    shell = Shell(Argyris(hexagon(1)), dome(0.0))
    x = shell.flat + 0.1 * np.random.default_rng(0).normal(size=shell.flat.shape)
    before, stiffness, forces = shell.energies(x), shell.flat_stiffness.copy(), shell.flat_forces(x)
    edited, fresh = shell.with_fields(dome(0.01), loads), Shell(shell.space, dome(0.01), loads=loads)
    assert edited.pattern is shell.pattern
    assert edited.energies(x) == fresh.energies(x) != before
    for array in ("gradient", "hessian", "flat_forces"):
        assert np.array_equal(getattr(edited, array)(x), getattr(fresh, array)(x))
    assert np.array_equal(edited.flat_stiffness, fresh.flat_stiffness)
    assert shell.energies(x) == before and np.array_equal(shell.flat_stiffness, stiffness)
    stiffer = shell.with_fields(of_stretch(Density(2.0 * density().stiffness), 0.8))
    assert np.allclose(stiffer.flat_forces(x), 2.0 * forces) and np.array_equal(shell.flat_forces(x), forces)
    assert not shell.loads.any()
    with pytest.raises(ValueError, match="loads"):
        shell.with_fields(dome(0.0), loads[:-1])


def test_loads_and_large_edits() -> None:
    """A load moves its point as its equilibrium does; the response to a very large load is limited to a Newton step."""
    mesh = hexagon(1)
    corners = np.arange(1, 7)
    held = [PointSupport(corners, np.column_stack([0.8 * mesh.p.T[corners], np.zeros(6)]))]
    shell = Shell(Argyris(mesh), dome(0.0), held)
    factor = shell.factor()
    start = relax(shell, factor)
    load = point_load(shell.space, np.zeros(2), np.array([0.0, 0.0, 1.0]))
    small, large = (
        linear_response(Shell(shell.space, dome(0.0), held, force * load), start.x, factor).x - start.x
        for force in (1e-6, 1e9)
    )
    loaded = follow(Shell(shell.space, dome(0.0), held, 1e-6 * load), start.x, shell.factor())
    assert float((load * small).sum()) == pytest.approx(float((load * (loaded.x - start.x)).sum()), rel=1e-2)
    assert np.abs(large).max() == pytest.approx(MAX_STEP * shell.extent)
    assert large / np.abs(large).max() == pytest.approx(small / np.abs(small).max(), abs=1e-3)
