"""Continuation to an equilibrium: unstable states on the path, and pins that take hold after the release.

Steps that rotate elements: their definition, and rounding small enough for tiny triangles. The certificate agrees with
a dense eigenvalue solver: a state with a negative eigenvalue is not a minimum.
"""

from __future__ import annotations

from contextlib import closing

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.model.system import System
from asterism.discrete.release import continuation
from asterism.discrete.release.continuation import force_scale, model_with_pins_until, solve_on_mesh
from asterism.discrete.release.release_start import ReleaseStart
from asterism.equilibrium.newton.minimise import minimise
from asterism.pattern import gallery
from asterism.pattern.design.errors import DesignError, MeshError
from tests.discrete.models import model_of, tube


@pytest.mark.slow
def test_pins_after_release_reach_their_targets() -> None:
    later = tube(pins=[{"where": "border", "scale": 0.8, "step": 1}])
    found = solve_on_mesh(later)
    held = later.constraints.held
    assert found.is_minimum
    np.testing.assert_allclose(found.state.positions[held], later.constraints.target[held], atol=1e-12)
    assert [step.step for step in found.path] == [0] * 10 + [1] * 6
    assert [round(step.moved, 6) for step in found.path[-6:]] == [0.2, 0.4, 0.6, 0.8, 1.0, 1.0]
    assert later.release == 1.0 and later.energy(found.state) == pytest.approx(found.energy)
    # the free released sheet has less energy than the pinned one
    assert found.path[9].energy_n_mm == pytest.approx(solve_on_mesh(tube()).energy, rel=1e-3)
    assert found.path[9].energy_n_mm < found.energy


@pytest.mark.parametrize(
    ("pins", "waves"),
    [
        pytest.param({"corners": [0, 3], "scale": 0.8}, False, marks=pytest.mark.slow),
        # the released border is longer than the pinned one, so pins catch its waves in a higher minimum
        ({"where": "border", "scale": 0.74}, True),
    ],
)
def test_pins_before_and_after_the_release_lead_to_the_same_shape_but_for_waves(pins: dict, waves: bool) -> None:
    at_once, later = solve_on_mesh(tube(pins=[pins])), solve_on_mesh(tube(pins=[pins | {"step": 1}]))
    assert at_once.is_minimum and later.is_minimum
    if waves:
        assert later.energy > at_once.energy + 1.0
    else:
        assert later.energy == pytest.approx(at_once.energy, rel=1e-8)


@pytest.mark.slow
def test_a_second_run_gives_the_same_and_the_model_is_unchanged() -> None:
    m = tube(pins=[{"corners": [0, 3], "step": 2}, {"corners": [1], "slide": "z"}])
    printed = m.constraints.printed.copy()
    first, second = solve_on_mesh(m), solve_on_mesh(m)
    np.testing.assert_array_equal(m.constraints.printed, printed)
    np.testing.assert_allclose(first.state.positions, second.state.positions, atol=1e-8)
    assert [s.step for s in first.path].count(2) == 6


def test_pins_take_hold_step_by_step() -> None:
    m = tube(pins=[{"corners": [0, 3], "scale": 0.8}, {"corners": [1], "step": 3}, {"corners": [5], "step": 1}])
    assert m.layout.pin_steps == (0, 1, 3)
    assert [model_with_pins_until(m, k).held.sum() for k in (0, 1, 3)] == [6, 9, 12]
    free = tube()
    assert model_with_pins_until(free, 0) is free


def test_a_free_sheet_moves_to_its_pins_with_the_plastic_up() -> None:
    """Two pins leave the rotation about their line undetermined; the printed positions decide it."""
    m = tube(pins=[{"corners": [0, 3], "scale": 0.75, "step": 1}])
    found = solve_on_mesh(m)
    assert found.is_minimum
    assert found.state.directors.mean(axis=0)[2] > 0.3


def test_an_unstable_state_is_left_along_its_negative_mode() -> None:
    """Without rest curvature and noise a print stays flat until it is unstable: kicks are on the path only."""
    plastic = gallery.load("tube").to_dict()["plastic"] | {"rest_curvature": "none"}
    m = tube(rings=0, plastic=plastic)
    found = solve_on_mesh(m, ReleaseStart(bumps=False, noise_mm=0.0))
    assert found.is_minimum
    assert found.instabilities_passed >= 1 and found.saddles_left == 0
    first = next(step for step in found.path if step.kicks)
    assert 0.0 < first.release < 1.0
    assert np.ptp(found.state.positions[:, 2]) > 1.0
    again = solve_on_mesh(m, ReleaseStart(bumps=False, noise_mm=0.0))
    np.testing.assert_allclose(again.state.positions, found.state.positions, atol=1e-6)


def test_invalid_starts_are_refused() -> None:
    with pytest.raises(ValueError, match="must be of 1 stars, not 2"):
        solve_on_mesh(tube(rings=0), ReleaseStart(branch=(1, -1)))
    for keys, said in (
        ({"bend": "rol"}, "must be one of none, roll, dome, saddle"),
        ({"bend": "roll"}, "a bend needs one above 0"),
        ({"branch": (2,)}, "1 up, -1 down or 0 free"),
        ({"releases": (0.3,)}, "the last must be 1"),
        ({"releases": (float("nan"), 1.0)}, "grow from 0"),
        ({"releases": (0.8, 0.3, 1.0)}, "grow"),
    ):
        with pytest.raises(ValueError, match=said):
            ReleaseStart(**keys)  # type: ignore[arg-type]


def test_an_interrupted_release_leaves_the_model_released() -> None:
    m = tube(rings=0)
    state, energy = m.flat_state(), m.energy(m.flat_state())

    def stop(stage: str, iteration: object) -> None:
        assert m.release < 1.0
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve_on_mesh(m, report=stop)
    assert m.release == 1.0 and m.energy(state) == energy


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
    turned = Rotation.from_rotvec(spin).apply(state.positions - centre)
    np.testing.assert_allclose(path(1.0).positions, centre + turned, atol=1e-9)
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


PINS: list[list[dict]] = [
    [],
    [{"where": "border", "scale": 0.8}],
    [{"corners": [0, 2, 4], "scale": 0.9}],
    [{"corners": [0, 3], "slide": "z"}],
    [{"corners": [1]}],
]


def dense(m: DiscreteModel, state: State) -> np.ndarray:
    """Eigenvalues of the whole Hessian, with the rigid motions shifted above all others."""
    full = m.pattern.full(m.hessian(state, 0.0)).toarray()
    modes = m.rigid_modes(state)
    keep = np.eye(len(full)) - modes @ modes.T
    return np.linalg.eigvalsh(keep @ full @ keep + 1e3 * np.abs(full).max() * modes @ modes.T)


@pytest.mark.slow
@settings(max_examples=12, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(
    rings=st.integers(0, 1),
    length=st.floats(4.0, 10.0),
    thickness=st.floats(0.15, 0.8),
    stretch=st.floats(1.05, 1.6),
    arms=st.sampled_from([3, 4, 6]),
    curl=st.sampled_from(["paper", "timoshenko", "none"]),
    pins=st.sampled_from(PINS),
    bend=st.sampled_from(["none", "roll", "dome", "saddle"]),
    bumps=st.booleans(),
    releases=st.sampled_from([(1.0,), (0.3, 1.0)]),
    iterations=st.sampled_from([5, 20, 300]),
)
def test_random_designs(rings, length, thickness, stretch, arms, curl, pins, bend, bumps, releases, iterations):
    design = {
        "fabric": {"stretch": stretch},
        "plastic": {"rest_curvature": curl},
        "lattice": {"arms": arms},
        "stars": {"length_mm": length, "thickness_mm": thickness},
        "border": {"rings": rings},
        "pins": pins,
        "mesh": {"edge_mm": 6.0},
    }
    try:
        m = model_of(design)
    except (DesignError, MeshError):
        return
    start = ReleaseStart(bumps=bumps, bend=bend, axis_deg=35.0, sag_mm=8.0, releases=releases)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(continuation, "MAX_ITERATIONS", iterations)
        found = solve_on_mesh(m, start)
    values = dense(m, found.state)
    # at other than stationary states rigid motions are not null vectors, and the computed value is an upper bound
    assert found.smallest_eigenvalue >= values[0] - 1e-7 * force_scale(m)
    if found.converged:
        assert found.smallest_eigenvalue == pytest.approx(values[0], rel=1e-4, abs=1e-7 * force_scale(m))
    if found.is_minimum:
        assert np.linalg.norm(m.gradient(found.state)) <= found.tolerance
        assert values[0] > 0.0
