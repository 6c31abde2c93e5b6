"""Steps that rotate elements: their definition, and rounding small enough for tiny triangles."""

from __future__ import annotations

from contextlib import closing

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.model.system import System
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.equilibrium.newton.minimise import minimise
from asterism.pattern import gallery
from tests.discrete.models import tube

FINE = 17.3205 / 36  # mm; graded: 0.2 mm along the arms at their tips


@pytest.fixture(scope="module")
def plate() -> DiscreteModel:
    """One star on a mesh with tiny edges, with the plate."""
    fabric = gallery.load("tube").to_dict()["fabric"] | {"bending": "consistent"}
    return tube(FINE, 0, mesh={"edge_mm": FINE, "graded": True}, fabric=fabric)


@pytest.fixture(scope="module")
def relaxed(plate: DiscreteModel) -> State:
    return solve_on_mesh(plate).state


def direction(model: DiscreteModel, size: float, seed: int = 0) -> np.ndarray:
    """(free,) displacements that are smooth over the sheet, plus noise."""
    rng = np.random.default_rng(seed)
    x = model.mesh.points / np.abs(model.mesh.points).max()
    move = np.einsum("vk,kc->vc", np.column_stack([x, x**2, x[:, :1] * x[:, 1:]]), rng.normal(size=(5, 3)))
    full = np.concatenate([(move + 0.01 * rng.normal(size=move.shape)).ravel(), rng.normal(size=len(model.edges))])
    return size * full[model.free]


def test_a_rigid_rotation_is_followed_exactly() -> None:
    model = tube(rings=0)
    state = solve_on_mesh(model).state
    spin = np.array([0.3, -0.5, 0.4])
    centre = state.positions.mean(axis=0)
    t = np.diff(state.positions[model.edges], axis=1)[:, 0]
    twist = t @ spin / np.linalg.norm(t, axis=1)
    move = np.cross(spin, state.positions - centre)
    path, longest = model.path(state, np.concatenate([move.ravel(), twist])[model.free])
    assert longest > 1.0
    angle, axis = np.linalg.norm(spin), spin / np.linalg.norm(spin)
    k = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k
    np.testing.assert_allclose(path(1.0).positions, centre + (state.positions - centre) @ turn.T, atol=1e-9)
    assert model.energy(path(1.0)) == pytest.approx(model.energy(state), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("pins", [[{"where": "border", "scale": 0.8}], [{"corners": [1], "slide": "z"}]])
def test_the_slope_of_a_step_is_its_direction(pins: list[dict]) -> None:
    model = tube(rings=0, pins=pins)
    state = solve_on_mesh(model).state
    d = direction(model, 1.0)
    path, _ = model.path(state, d)
    slope = (path(1e-4).positions - path(-1e-4).positions) / 2e-4
    np.testing.assert_allclose(slope, model.motions(d)[0], atol=1e-6)
    held = model.constraints.held
    np.testing.assert_array_equal(path(0.3).positions[held], state.positions[held])


@pytest.mark.slow
def test_a_small_step_has_the_rounding_of_its_coordinates(plate: DiscreteModel, relaxed: State) -> None:
    """It differs from a straight step at second order, 1e-18 mm here; a larger difference is rounding."""
    assert np.linalg.norm(np.diff(plate.mesh.points[plate.edges], axis=1), axis=2).min() < 0.2
    d = direction(plate, 1e-9)
    turned, straight = (way.path(plate, relaxed, d)[0](1.0) for way in (DiscreteModel, System))
    apart = np.abs(turned.positions - straight.positions).max()
    assert apart <= 2.0 * np.spacing(np.abs(relaxed.positions).max())


@pytest.mark.slow
def test_newton_reaches_the_rounding_error_of_the_coordinates(plate: DiscreteModel, relaxed: State) -> None:
    """The final gradient is at most the change of the gradient by the last digit of the coordinates."""
    last = np.spacing(np.abs(relaxed.positions))
    sign = np.random.default_rng(0).choice([-1.0, 1.0], size=last.shape)
    moved = State(relaxed.positions + sign * last, relaxed.directors)
    floor = np.linalg.norm(plate.gradient(moved) - plate.gradient(relaxed))
    with closing(plate.factor()) as factor:
        found = minimise(plate, relaxed, factor, 0.0, max_iterations=8)
    assert min(step.gradient_norm for step in found.history) < floor
