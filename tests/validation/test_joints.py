"""Joints of rods against frames of beams in closed form, and rigid motions of bonded rods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
import scipy.linalg as la
import scipy.sparse.linalg as spla

from asterism.discrete.energies.rods.joint import RodJoint
from asterism.discrete.energies.rods.network import (
    fitted_frames,
    joint_inputs,
    joint_network,
    joint_params,
    rod_network,
)
from asterism.discrete.model.state import State, rotate_vectors
from asterism.discrete.model.system import System, rigid_motions
from asterism.equilibrium.arrays import Array
from tests.validation.rods import Material, crumpled, rod_energies

LENGTH_MM = 20.0
THIN = Material(width=1.2, thickness=0.3)
THICK = Material(width=1.2, thickness=0.6)

# directions of the arms in degrees, the clamped one first
JUNCTIONS = {
    "star of 3": [0, 120, 240],
    "T": [0, 180, 90],
    "cross at 90": [0, 90, 180, 270],
    "cross at 60": [0, 60, 180, 240],
    "cross at 20": [0, 20, 180, 200],
    "star of 5": [0, 72, 144, 216, 288],
    "star of 8": [0, 45, 90, 135, 180, 225, 270, 315],
    "Y of narrow arms": [180, 7.5, -7.5],
    "corner of 90": [0, 90],
    "corner of 120": [0, 120],
    "T with a thick stem": [0, 180, 90],
}


@dataclass(frozen=True)
class Frame:
    """Arms of a junction as rods: the system, its printed vertices, and the vertices of the tips that carry loads."""

    system: System
    printed: Array
    tips: Array


def materials(name: str) -> list[Material]:
    arms = [THIN] * len(JUNCTIONS[name])
    return [*arms[:-1], THICK] if name == "T with a thick stem" else arms


def frame(name: str, edges: int, held: bool = True, kappa: float = 0.0) -> Frame:
    """The junction with `edges` edges on every arm; the first one is clamped at its length, within its last edge."""
    angles = np.radians(JUNCTIONS[name])
    points, paths = [np.zeros((1, 2))], []
    for arm, angle in enumerate(angles):
        step = LENGTH_MM / (edges - 0.5 if arm == 0 else edges)
        points.append(np.outer(step * np.arange(1, edges + 1), [np.cos(angle), np.sin(angle)]))
        paths.append(np.concatenate([[0], 1 + arm * edges + np.arange(edges)]))
    printed = np.vstack(points)
    network = rod_network(tuple(paths), np.full(len(angles), -1), printed)
    joints = joint_network(tuple(paths), [[(arm, 0) for arm in range(len(angles))]])
    arms, n = materials(name), len(printed)
    w, h = (np.array([getattr(arms[r], key) for r in network.rod]) for key in ("width", "thickness"))
    params = joint_params(joints, printed, THIN.modulus, THIN.poisson, w, h, np.full(len(w), kappa))
    parts = rod_energies(network, printed, arms, kappa) | {"joint": RodJoint(*joint_inputs(joints, n, len(w)), params)}
    fixed = np.zeros(3 * n + len(w) + 3, dtype=bool)
    if held:
        fixed[[*range(3 * edges - 3, 3 * edges + 3), 3 * n + edges - 1]] = True
    system = System(parts, n, network.edges, fixed, joint_vertices=joints.vertices)
    return Frame(system, printed, np.array([path[-1] for path in paths[1:]]))


def flat(case: Frame) -> State:
    """As printed, plastic up."""
    up = np.tile([0.0, 0.0, 1.0], (len(case.system.edges), 1))
    return State(np.column_stack([case.printed, np.zeros(len(case.printed))]), up, np.eye(3)[None])


def compliance(case: Frame) -> Array:
    """(3 m, 3 m) mm/N, displacements of the m loaded tips under unit forces on them, at the print."""
    system, state = case.system, flat(case)
    stiffness = system.pattern.full(system.hessian(state, 0.0)).tocsc()
    rows = np.searchsorted(system.free, (3 * case.tips[:, None] + np.arange(3)).ravel())
    loads = np.zeros((len(system.free), len(rows)))
    loads[rows, np.arange(len(rows))] = 1.0
    return np.asarray(spla.spsolve(stiffness, loads)[rows])


def exact_compliance(name: str, edges: int) -> Array:
    """The same of Euler-Bernoulli beams, rigidly bonded at a point.

    A force F at the tip r of an arm is a force F and a moment r x F on the clamped arm's end, a cantilever's. The clamp
    of `frame` holds both ends of an edge, so that half of that edge cannot stretch.
    """
    arms, angles = materials(name), np.radians(JUNCTIONS[name])
    stretching = LENGTH_MM * (edges - 1.0) / (edges - 0.5)
    base = cantilever(arms[0], angles[0] + np.pi, stretching)  # from the clamp to the junction
    count = len(angles) - 1
    out = np.zeros((3 * count, 3 * count))
    carry = []
    for angle in angles[1:]:
        x, y = LENGTH_MM * np.cos(angle), LENGTH_MM * np.sin(angle)
        arm = np.array([[0.0, 0.0, y], [0.0, 0.0, -x], [-y, x, 0.0]])  # r x F
        carry.append(np.vstack([np.eye(3), arm]))
    for i in range(count):
        for j in range(count):
            block = carry[i].T @ base @ carry[j]
            if i == j:
                block = block + cantilever(arms[i + 1], angles[i + 1], LENGTH_MM)[:3, :3]
            out[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] = block
    return out


def cantilever(arm: Material, angle: float, stretching: float) -> Array:
    """(6, 6) displacement and rotation of a cantilever's end by the force and the moment there."""
    length, area = LENGTH_MM, arm.width * arm.thickness
    local = np.zeros((6, 6))
    local[0, 0], local[3, 3] = stretching / (arm.modulus * area), length / arm.torsion
    for across, about, stiffness, sign in ((1, 5, arm.in_plane, 1.0), (2, 4, arm.about_width, -1.0)):
        local[across, across], local[about, about] = length**3 / (3 * stiffness), length / stiffness
        local[across, about] = local[about, across] = sign * length**2 / (2 * stiffness)
    cos, sin = np.cos(angle), np.sin(angle)
    turn = np.kron(np.eye(2), [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(turn @ local @ turn.T)


def largest_error(name: str, edges: int) -> float:
    """Largest relative error of the compliance in any combination of loads."""
    ratio = la.eigh(compliance(frame(name, edges)), exact_compliance(name, edges), eigvals_only=True)
    return float(np.abs(ratio - 1.0).max())


@pytest.mark.parametrize("name", JUNCTIONS)
def test_compliance_of_junctions(name):
    """Within 1 % of the frame at 10 edges an arm, and of second order."""
    coarse, fine = largest_error(name, 10), largest_error(name, 20)
    assert coarse < 0.01
    assert fine < coarse / 3.5


@pytest.mark.parametrize("name", JUNCTIONS)
def test_print_is_at_rest(name):
    case = frame(name, 5)
    assert case.system.energy(flat(case)) < 1e-20
    assert np.abs(case.system.full_gradient(flat(case))).max() < 1e-9


@pytest.mark.parametrize("name", JUNCTIONS)
def test_rigid_motions_cost_nothing_and_forces_balance(name):
    case = frame(name, 4, held=False, kappa=0.05)
    state, system = crumpled(case.system, flat(case)), case.system
    gradient = system.gradient(state)
    motions = rigid_motions(state, system.edges, system.held, system.free)
    assert motions.shape[1] == 6
    assert np.abs(motions.T @ gradient).max() < 1e-11 * np.linalg.norm(gradient)
    rotation = rotate_vectors(np.array([[0.4, -1.1, 2.0]]), np.eye(3)[None])[0].T
    moved = state.rotated(rotation, np.array([3.0, -2.0, 5.0]))
    for part, value in system.energies(state).items():
        assert value > 0.0
        assert system.energies(moved)[part] == pytest.approx(value, rel=1e-12)


def test_frames_fitted_to_a_rigid_motion_are_its_rotation():
    case = frame("T", 4)
    paths = tuple(np.concatenate([[0], 1 + 4 * arm + np.arange(4)]) for arm in range(3))
    joints = joint_network(paths, [[(0, 0), (1, 0), (2, 0)]])
    rotation = rotate_vectors(np.array([[0.4, -1.1, 2.0]]), np.eye(3)[None])[0].T
    moved = flat(case).rotated(rotation, np.zeros(3))
    frames = fitted_frames(joints, case.system.edges, case.printed, moved.positions, moved.directors)
    np.testing.assert_allclose(frames, moved.frames, atol=1e-12)
