"""Elements of every energy at random states and at strongly bent ones; no two elements share a dof."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from asterism.discrete.energies.bending.hinges import Hinges
from asterism.discrete.energies.bending.plate import Plate
from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.membrane import Membrane, SideMembrane
from asterism.discrete.energies.rods.joint import RodJoint
from asterism.discrete.energies.rods.network import JointNetwork, RodNetwork, joint_inputs, stencil_inputs
from asterism.discrete.energies.rods.rod import RodBend, RodStretch, RodTwist
from asterism.discrete.model.state import State, moved_state
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.materials import BendingStiffness, Fabric

COUNT = 40


@dataclass(frozen=True)
class Sample:
    """Elements, a state, and the rod edges whose directors are part of it."""

    elements: Elements
    state: State
    edges: Array

    def moved(self, steps: Array) -> Array:
        """Packed configuration after each element's own dofs moved by steps (E, n); complex steps pass through."""
        sizes = [self.state.positions.size, len(self.edges), 3 * len(self.state.frames)]
        full = np.zeros(sum(sizes), dtype=steps.dtype)
        full[self.elements.dofs] = steps
        move, turn, spin = np.split(full, np.cumsum(sizes)[:2])
        positions = self.state.positions + move.reshape(-1, 3)
        return moved_state(self.state, self.edges, positions, turn, spin.reshape(-1, 3)).packed


def rotation(rng: np.random.Generator) -> Array:
    """Random proper rotation matrix."""
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0.0 else -q


def strained(rng: np.random.Generator, rest: Array, bent: bool) -> State:
    """A rest shape (V, 2) strained at random; `bent`: turned by more than 90 degrees and squeezed to a third."""
    flat = np.column_stack([rest, np.zeros(len(rest))])
    if bent:
        turn = np.diag([1.0, -1.0, -1.0]) @ rotation(rng)
        positions = flat * [0.4, 0.8, 1.0] @ turn.T + 0.05 * rng.normal(size=flat.shape)
    else:
        positions = 1.2 * flat + 0.15 * rng.normal(size=flat.shape)
    return State(positions, np.zeros((0, 3)))


SHEET = Fabric(modulus_mpa=7.0)
RUBBER = Fabric(modulus_mpa=7.0, model="incompressible")
KNIT = Fabric(modulus_mpa=(11.0, 4.0), grain_deg=25.0)


def membrane(rng: np.random.Generator, bent: bool, fabric: Fabric = SHEET) -> Sample:
    """Triangles as `strained`."""
    triangles = np.arange(3 * COUNT).reshape(COUNT, 3)
    rest = np.tile([[0.0, 0.0], [1.3, 0.1], [0.3, 1.1]], (COUNT, 1)) + 0.2 * rng.normal(size=(3 * COUNT, 2))
    elements = Membrane(triangles, rest, fabric)
    return Sample(elements, strained(rng, rest, bent), np.zeros((0, 2), dtype=int))


def sides(rng: np.random.Generator, bent: bool, fabric: Fabric = SHEET) -> Sample:
    """Pairs of triangles as `strained`."""
    corners = np.array([[0.0, 0.0], [1.3, 0.1], [0.3, 1.1], [0.8, -0.9]])
    rest = np.tile(corners, (COUNT, 1)) + 0.15 * rng.normal(size=(4 * COUNT, 2))
    elements = SideMembrane(np.arange(4 * COUNT).reshape(COUNT, 4), rest, fabric)
    return Sample(elements, strained(rng, rest, bent), np.zeros((0, 2), dtype=int))


def hinges(rng: np.random.Generator, bent: bool) -> Sample:
    """Pairs of triangles; `bent`: folded by 90 to 160 degrees to either side."""
    angle = rng.choice([-1.0, 1.0], COUNT) * (rng.uniform(1.8, 2.8, COUNT) if bent else rng.uniform(0.0, 1.0, COUNT))
    zero = np.zeros(COUNT)
    right = np.column_stack([0.6 + zero, -0.9 * np.cos(angle), 0.9 * np.sin(angle)])
    points = np.stack([np.tile(p, (COUNT, 1)) for p in ([0, 0, 0], [1, 0, 0], [0.4, 0.8, 0])] + [right], axis=1)
    points = (points + 0.05 * rng.normal(size=points.shape)) @ rotation(rng).T
    elements = Hinges(np.arange(4 * COUNT).reshape(COUNT, 4), rng.uniform(0.5, 1.0, COUNT))
    return Sample(elements, State(points.reshape(-1, 3), np.zeros((0, 3))), np.zeros((0, 2), dtype=int))


def folds(rng: np.random.Generator, bent: bool) -> Sample:
    """Hinges with a fourth-order term, some of them with nothing else."""
    sample = hinges(rng, bent)
    sample.elements.params[:] = rng.uniform(0.5, 1.0, (COUNT, 2)) * rng.integers(0, 2, (COUNT, 1)) ** [1, 0]
    return sample


def plate(rng: np.random.Generator, bent: bool) -> Sample:
    """Patches of six vertices of an orthotropic plate, stretched by a third.

    `bent`: their outer triangles folded by 90 to 130 degrees.
    """
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 0.8], [1.5, 0.8], [-0.5, 0.8], [0.5, -0.8]])
    around = np.array([[0, 1, 2], [1, 3, 2], [2, 4, 0], [0, 5, 1]])
    rest = np.tile(corners, (COUNT, 1)) + 0.08 * rng.normal(size=(6 * COUNT, 2))
    patch = 6 * np.arange(COUNT)[:, None, None]
    triangles = (patch + around).transpose(1, 0, 2).reshape(-1, 3)
    elements = Plate(triangles, rest, BendingStiffness(1.0, 0.3, 0.4, 0.2))
    # only the patch of each middle triangle
    elements.inputs, elements.dofs = elements.inputs[:COUNT].copy(), elements.dofs[:COUNT].copy()
    elements.params = elements.params[:COUNT].copy()
    flat = np.column_stack([1.3 * rest, np.zeros(len(rest))]).reshape(COUNT, 6, 3)
    if bent:
        middle = flat[:, :3].mean(axis=1, keepdims=True)
        flat[:, 3:] = flat[:, 3:] - 1.1 * (flat[:, 3:] - middle)
        flat[:, 3:, 2] = rng.uniform(0.7, 1.0, (COUNT, 3)) * rng.choice([-1.0, 1.0], (COUNT, 3))
    positions = (flat.reshape(-1, 3) + 0.1 * rng.normal(size=(6 * COUNT, 3))) @ rotation(rng).T
    return Sample(elements, State(positions, np.zeros((0, 3))), np.zeros((0, 2), dtype=int))


def rod_stretch(rng: np.random.Generator, bent: bool) -> Sample:
    """Rod edges of random length; `bent` has no meaning for one edge."""
    edges = np.arange(2 * COUNT).reshape(COUNT, 2)
    dofs = (3 * edges[:, :, None] + np.arange(3)).reshape(COUNT, 6)
    params = np.column_stack([rng.uniform(1, 2, COUNT), rng.uniform(0.5, 2, COUNT)])
    state = State(rng.normal(size=(2 * COUNT, 3)), np.zeros((0, 3)))
    return Sample(RodStretch(dofs, dofs, params), state, np.zeros((0, 2), dtype=int))


def _stencils(rng: np.random.Generator, bent: bool) -> tuple[RodNetwork, State]:
    """Pairs of edges, some run backwards; `bent`: turned by 90 to 150 degrees and twisted by as much."""
    angle = rng.uniform(1.6, 2.6, COUNT) if bent else rng.uniform(0.0, 1.0, COUNT)
    twist = rng.choice([-1.0, 1.0], COUNT) * (rng.uniform(1.6, 2.6, COUNT) if bent else rng.uniform(0.0, 1.0, COUNT))
    l0, l1 = rng.uniform(0.5, 2.0, (2, COUNT))
    zero = np.zeros(COUNT)
    points = np.stack(
        [
            np.column_stack([-l0, zero, zero]),
            np.zeros((COUNT, 3)),
            np.column_stack([l1 * np.cos(angle), l1 * np.sin(angle), zero]),
        ],
        axis=1,
    )
    # directors at any angle about the first edge; the second is the first one carried along, then twisted
    first = rng.uniform(0.0, 2.0 * np.pi, COUNT)

    def director(along: Array, azimuth: Array) -> Array:
        across = np.column_stack([-np.sin(along), np.cos(along), zero])
        return np.cos(azimuth)[:, None] * across + np.sin(azimuth)[:, None] * np.array([0.0, 0.0, 1.0])

    directors = np.stack([director(zero, first), director(angle, first + twist)], axis=1)
    turned = rotation(rng)
    signs = rng.choice([-1.0, 1.0], (COUNT, 2))
    vertices = np.arange(3 * COUNT).reshape(COUNT, 3)
    forward = np.stack([vertices[:, :2], vertices[:, 1:]], axis=1)
    edges = np.where(signs[:, :, None] > 0.0, forward, forward[:, :, ::-1]).reshape(-1, 2)
    network = RodNetwork(
        edges,
        np.repeat(np.arange(COUNT), 2),
        np.full(2 * COUNT, 0.5),
        vertices,
        np.arange(2 * COUNT).reshape(COUNT, 2),
        signs,
        np.ones(COUNT),
    )
    return network, State(points.reshape(-1, 3) @ turned.T, directors.reshape(-1, 3) @ turned.T)


def rod_bend(rng: np.random.Generator, bent: bool) -> Sample:
    """Stencils with rest curvatures of their own."""
    network, state = _stencils(rng, bent)
    params = np.column_stack([rng.uniform(1, 2, (COUNT, 2)), 0.3 * rng.normal(size=(COUNT, 2)), network.signs])
    return Sample(RodBend(*stencil_inputs(network, len(state.positions)), params), state, network.edges)


def rod_twist(rng: np.random.Generator, bent: bool) -> Sample:
    """Stencils that twist, with a rest twist of their own."""
    network, state = _stencils(rng, bent)
    params = np.column_stack([rng.uniform(1, 2, COUNT), network.signs, 0.3 * np.sin(np.arange(COUNT))])
    return Sample(RodTwist(*stencil_inputs(network, len(state.positions)), params), state, network.edges)


def rod_joint(rng: np.random.Generator, bent: bool) -> Sample:
    """Half edges that leave a joint of any frame in any printed direction, some run towards it.

    `bent`: they leave it at 70 to 150 degrees from their printed direction, and twisted by as much.
    """
    network, state = _stencils(rng, bent)
    along = (state.positions[1::3] - state.positions[::3]) / np.linalg.norm(
        state.positions[1::3] - state.positions[::3], axis=1, keepdims=True
    )
    normal, sign = state.directors[::2], network.signs[:, 1]
    printed = rng.uniform(0.0, 2.0 * np.pi, COUNT)
    cos, sin = np.cos(printed)[:, None], np.sin(printed)[:, None]
    # the frame whose printed direction is that of the first edge
    across = np.cross(normal, along)
    frames = np.stack([cos * along - sin * across, sin * along + cos * across, normal], axis=1)
    positions = state.positions.reshape(COUNT, 3, 3)[:, 1:].reshape(-1, 3)
    edges = np.where(sign[:, None] > 0.0, [0, 1], [1, 0]) + 2 * np.arange(COUNT)[:, None]
    one = np.arange(COUNT)
    joints = JointNetwork(2 * one, one, one, 2 * one + 1, sign)
    params = [rng.uniform(1, 2, (COUNT, 3)), 0.3 * rng.normal(size=(COUNT, 1)), cos, sin, sign[:, None]]
    params.append(0.3 * np.sin(np.arange(COUNT))[:, None])
    moved = State(positions, state.directors[1::2], frames)
    return Sample(RodJoint(*joint_inputs(joints, 2 * COUNT, COUNT), np.hstack(params)), moved, edges)


SAMPLES: dict[str, Callable[[np.random.Generator, bool], Sample]] = {
    "membrane": membrane,
    "incompressible membrane": partial(membrane, fabric=RUBBER),
    "orthotropic membrane": partial(membrane, fabric=KNIT),
    "sides": sides,
    "incompressible sides": partial(sides, fabric=RUBBER),
    "orthotropic sides": partial(sides, fabric=KNIT),
    "hinges": hinges,
    "folds": folds,
    "plate": plate,
    "rod stretch": rod_stretch,
    "rod bend": rod_bend,
    "rod twist": rod_twist,
    "rod joint": rod_joint,
}
