"""V21: an independent C++ implementation of the same energies.

Energy, gradient and Hessian agree at random states: membrane and hinges as they are, rods once its conventions are
ours (`reference.rods`). The equilibria agree to 1e-8 of the diameter with those conventions. With the model as it is
they differ by a tenth of a percent in shape and a third of a percent in energy: that is all due to the stretch of
the rods (counted three to six times over, by the stencils) and to their twist.
"""

from __future__ import annotations

import json

import numpy as np
import pytest

from asterism.discrete.energies.elements import Elements
from asterism.discrete.model.state import State
from asterism.discrete.model.system import System
from asterism.discrete.release.continuation import force_scale, solve_on_mesh
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.newton.minimise import minimise
from asterism.pattern.design.materials import rest_curvature
from tests.validation import reference

DERIVATIVES = pytest.mark.parametrize("name", ["derivatives_A", "derivatives_B"])
EQUILIBRIA = pytest.mark.parametrize("name", ["star1", "stars7", "stars7_thin", "stars37"])


def assembled(parts: dict[str, Elements], edges: Array, state: State) -> tuple[float, Array, Array]:
    """Energy, gradient and dense Hessian over all dofs."""
    n = 3 * len(state.positions) + len(edges)
    system = System(parts, len(state.positions), edges, np.zeros(n, dtype=bool))
    low = system.pattern.lower(system.hessian(state, 0.0)).toarray()
    return system.energy(state), system.full_gradient(state), low + np.tril(low, -1).T


def assert_close(found: tuple[float, Array, Array], data: dict[str, Array], part: str, tolerance: float) -> None:
    energy, gradient, hessian = found
    assert energy == pytest.approx(float(data[f"E_{part}"]), rel=tolerance)
    expected = data[f"g_{part}"]
    assert np.abs(gradient - expected).max() < tolerance * np.abs(expected).max()
    upper = np.triu(data[f"H_{part}"])
    expected = upper + np.triu(upper, 1).T
    assert np.abs(hessian - expected).max() < tolerance * np.abs(expected).max()


@DERIVATIVES
@pytest.mark.parametrize("part", ["membrane", "hinge"])
def test_fabric(name, part):
    data = reference.load(name)
    n = len(data["vertices_flat"])
    directors = np.zeros((len(data["X"]) - 3 * n, 3))
    edges = reference.random_state(data).network.edges
    state = State(data["X"][: 3 * n].reshape(-1, 3), directors)
    assert_close(assembled({part: reference.fabric(data)[part]}, edges, state), data, part, 1e-10)


@DERIVATIVES
def test_hinge_coefficients(name):
    data = reference.load(name)
    elements = reference.fabric(data)["hinge"]
    n = len(data["vertices_flat"])

    def keys(edges: Array) -> Array:
        return edges[:, :2].min(axis=1).astype(np.int64) * n + edges[:, :2].max(axis=1)

    ours, theirs = keys(elements.inputs[:, [0, 3]] // 3), keys(data["hinges"])
    np.testing.assert_array_equal(np.sort(ours), np.sort(theirs))
    expected = data["hinge_coeff"][np.argsort(theirs)]
    np.testing.assert_allclose(elements.params[np.argsort(ours), 0], expected, rtol=1e-12)


@DERIVATIVES
def test_rods(name):
    """B has permuted vertices, a rod run backwards, and rods of different cross-sections."""
    data = reference.load(name)
    at = reference.random_state(data)
    points, width, thickness = (
        data["vertices_flat"][:, :2],
        data["rod_w"][at.network.rod],
        data["rod_h"][at.network.rod],
    )
    parts = reference.rods(at.network, points, float(data["E1"]), width, thickness, -data["restK"][:, 0])
    energy, gradient, hessian = assembled(parts, at.network.edges, at.state)
    sign = np.concatenate([np.ones(3 * len(points)), at.sign])
    assert_close((energy, sign * gradient, sign[:, None] * hessian * sign), data, "rod", 1e-8)


@DERIVATIVES
def test_rest_curvatures(name):
    """Integrated over a stencil, they are ours with the opposite sign; in the plane the angle of the layout."""
    data = reference.load(name)
    at = reference.random_state(data)
    points = data["vertices_flat"][:, :2]
    rods = reference.rods(at.network, points, 1.0, *np.ones((2, len(at.network.edges))), np.zeros(len(data["restK"])))
    np.testing.assert_allclose(rods["rod_bending"].params[:, 3], -data["restK"][:, 1], atol=1e-12)
    length = np.linalg.norm(np.diff(points[at.network.edges], axis=1)[:, 0], axis=1)[at.network.stencil_edges]
    arm = at.network.weight == 1.0
    kappa = data["kappa_arm"][at.network.rod][at.network.stencil_edges].mean(axis=1)
    np.testing.assert_allclose(data["restK"][arm, 0], -0.5 * (kappa * length.sum(axis=1))[arm], rtol=1e-9)


def distance(one: Array, other: Array) -> float:
    """rms distance after rigid alignment (Kabsch), over the diameter."""
    a, b = one - one.mean(axis=0), other - other.mean(axis=0)
    u, _, v = np.linalg.svd(a.T @ b)
    turn = u @ np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ v))]) @ v
    diameter = np.linalg.norm(np.ptp(b, axis=0))
    return float(np.sqrt(((a @ turn - b) ** 2).sum(axis=1).mean()) / diameter)


@EQUILIBRIA
def test_equilibrium(name):
    """From its own positions the model goes to a minimum close by; every star is up.

    Measured: 0.02, 0.04, 0.09, 0.06 %.
    """
    data = reference.load(name)
    model = reference.model(data)
    np.testing.assert_allclose(
        rest_curvature(data["rod_h"], model.design.fabric, model.design.plastic), data["rod_kappa"], rtol=1e-6
    )
    found = solve_on_mesh(model, reference.final_state(model, data))
    assert found.is_minimum
    assert found.stars_up == len(data["star_pos"])
    assert distance(found.state.positions, data["final_positions"]) < 2e-3
    # softer stretch: lower, by a third of a percent
    ratio = found.energy / float(data["E_total"])
    assert 0.995 < ratio < 1.0


@EQUILIBRIA
def test_equilibrium_with_the_references_rods(name):
    """Nothing is left of the difference once stretch and twist of the rods are the reference's."""
    data = reference.load(name)
    model = reference.model(data)
    modulus = float(json.loads(str(data["params"]))["E1"])
    parts = {part: model.parts[part] for part in ("membrane", "hinges")}
    parts |= reference.equilibrium_rods(model, data, modulus)
    system = System(parts, model.n_vertices, model.edges, model.held)
    factor = make_factor(system.pattern)
    found = minimise(system, reference.final_state(model, data), factor, 1e-8 * force_scale(model))
    factor.close()
    assert found.converged and found.definite
    assert distance(found.state.positions, data["final_positions"]) < 1e-7
    assert found.energy == pytest.approx(float(data["E_total"]), rel=1e-10)
    energies = system.energies(found.state)
    rod = sum(energies[part] for part in ("rod_bending", "rod_twist", "rod_stretch"))
    for value, part in [(energies["membrane"], "membrane"), (energies["hinges"], "hinge"), (rod, "rod")]:
        assert value == pytest.approx(float(data[f"E_{part}"]), rel=1e-6)
    assert energies["rod_stretch"] == pytest.approx(float(data["E_rod_stretch"]), rel=1e-6)


@pytest.mark.parametrize("name", ["star1", "stars7", "stars7_thin"])
def test_equilibrium_from_the_print(name):
    """The project's own start finds the same minimum."""
    data = reference.load(name)
    found = solve_on_mesh(reference.model(data))
    assert found.is_minimum
    assert distance(found.state.positions, data["final_positions"]) < 2e-3


def test_37_stars_from_the_print():
    """The same shape rolled about one of the three equivalent axes: compared star by star, turned with the lattice."""
    data = reference.load("stars37")
    model = reference.model(data)
    found = solve_on_mesh(model)
    assert found.is_minimum and found.stars_up == 37
    assert found.energy == pytest.approx(float(data["E_total"]), rel=5e-3)
    centre = model.mesh.star_vertices
    printed, ours, theirs = model.mesh.points[centre], found.state.positions[centre], data["final_positions"][centre]
    apart = []
    for turn in np.radians([0.0, 120.0, 240.0]):
        image = printed @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
        other = np.linalg.norm(image[:, None] - printed, axis=2).argmin(axis=1)
        apart.append(distance(ours, theirs[other]))
    assert min(apart) < 1e-2
