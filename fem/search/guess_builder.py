"""Builds initial guesses: bends a simple shape, places it on the supports, and relaxes its membrane strains in plane.

An in-plane relaxation moves the printed plane within itself before it is bent. Its displacement solves the linear
membrane problem of the flat sheet for the membrane strains of the bent one.

A sheet that is fixed at a point or a line rotates rigidly first, until its dead loads are in equilibrium. Newton's
method moves points along straight lines, so a large rotation would stretch the sheet on its way.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import stiffen
from asterism.fem.elements.argyris import Evaluation
from asterism.fem.search.simple_shapes import Plane, SimpleShape, similar
from asterism.fem.shell.shell import Shell
from asterism.fem.supports.rigid import span_a_plane

MAX_RELAXATION_STEPS = 3  # in-plane relaxations of a guess
MIN_RELATIVE_GAIN = 0.1  # 1: gain of a step over the energy, below which it is the last step
REMAINING_GAIN = 0.25  # 1: gain of all later steps over that of a step; usually each gains a fifth of the one before
IDENTITY_TOLERANCE = 1e-6  # 1: largest difference from the identity of a rotation that counts as the identity
RANK_TOLERANCE = 1e-9  # 1: singular value over the largest, below which it is zero (points on a line, parallel loads)


@dataclass(frozen=True)
class InitialGuess:
    """A simple shape, the state x (N, 3) in mm made of it, and its energy in N mm."""

    shape: SimpleShape
    x: Floats
    energy: float


class GuessBuilder:
    """Builds initial guesses for one shell, and keeps them: every shape is bent once.

    Parameters
    ----------
    factor : of the shell; holds the stiffness of the flat sheet after the first guess that needs it.
    centre, stretch : (2,) mm and a factor: the plane that is bent, see `fem.search.simple_shapes.similar`.
    """

    def __init__(self, shell: Shell, factor: Factor, centre: Floats, stretch: float) -> None:
        self._shell, self._factor = shell, factor
        self._plane = similar(centre, stretch)
        self._located: dict[bytes, tuple[Floats, Evaluation]] = {}
        self._bent: dict[SimpleShape, InitialGuess] = {}

    @cached_property
    def _ready(self) -> bool:
        """Whether the factor holds the stiffness of the flat sheet; computed at the first use."""
        shell = self._shell
        data = shell.flat_stiffness.copy()
        stiffen(shell.pattern, data, shell.support(shell.flat))
        return self._factor.factorise(data)

    @cached_property
    def _rotation(self) -> Floats | None:
        """(3, 3) rotation from the printed to the target positions of the supports; None for the identity.

        Points on one line without a clamp leave the rotation about this line undetermined; the smallest one is used.
        """
        fixed, reduction = self._shell.fixed_points, self._shell.reduction
        places = reduction.offset(self._shell.progress).reshape(-1, 3)[fixed]
        printed, places = (at - at.mean(axis=0) for at in (self._shell.flat[fixed], places))
        if len(reduction.normals):
            up = np.full(reduction.normals.shape, self._shell.extent) * [0.0, 0.0, 1.0]
            printed = np.concatenate([printed, up])
            places = np.concatenate([places, self._shell.extent * reduction.normals])
        elif not span_a_plane(places):
            farthest = np.linalg.norm(printed, axis=1).argmax()
            printed, places = printed[farthest], places[farthest]
            if not (printed.any() and places.any()):
                return None
        rotation = Rotation.align_vectors(places, printed)[0].as_matrix()
        return None if np.abs(rotation - np.eye(3)).max() < IDENTITY_TOLERANCE else np.asarray(rotation)

    def bend(self, shape: SimpleShape) -> InitialGuess:
        """The guess of a shape on the supports."""
        if shape not in self._bent:
            x = self._on_supports(shape.over(self._shell.space, self._plane))
            self._bent[shape] = InitialGuess(shape, x, self._shell.energy(x))
        return self._bent[shape]

    def relax_in_plane(self, guess: InitialGuess, energy_limit: float = np.inf) -> InitialGuess:
        """The guess after in-plane relaxation; it stops early if the energy cannot come below `energy_limit` N mm."""
        shell, shape = self._shell, guess.shape
        moves = np.zeros_like(shell.flat)
        for _ in range(MAX_RELAXATION_STEPS if self._ready else 0):
            strains = shell.strains(guess.x)
            strains[..., 3:] = 0.0
            stress = shell.linear_stress(strains)
            stress[..., 3:] = 0.0
            forces = shell.restrict(shell.assembly.forces(shell.flat, stress))
            moves = shell.move(moves, -self._factor.solve(forces))
            x = self._on_supports(shape.over(shell.space, self._moved(moves)))
            trial = InitialGuess(shape, x, shell.energy(x))
            if not trial.energy < guess.energy:
                break
            gain = guess.energy - trial.energy
            is_last = gain < MIN_RELATIVE_GAIN * abs(guess.energy)
            guess = trial
            if is_last or guess.energy - REMAINING_GAIN * gain > energy_limit:
                break
        return guess

    def _moved(self, moves: Floats) -> Plane:
        """The plane after displacements (N, 3) mm within it."""

        def plane(points: Floats) -> Floats:
            key = points.tobytes()
            if key not in self._located:
                self._located[key] = self._plane(points), self._shell.space.locate(points)
            places, at = self._located[key]
            return places + at.jets(moves[:, :2])

        return plane

    def _on_supports(self, x: Floats) -> Floats:
        """(N, 3) the state x on the supports: moved rigidly, deformed like the flat sheet, settled under loads."""
        shell = self._shell
        if shell.is_free:
            return x
        fixed = shell.fixed_points
        if len(fixed):
            x = x if self._rotation is None else shell.translated(x @ self._rotation.T, np.zeros(3))
            places = shell.reduction.offset(shell.progress).reshape(-1, 3)
            x = shell.translated(x, places[fixed].mean(axis=0) - x[fixed].mean(axis=0))
        supported = shell.constrain(x)
        if not self._ready:
            return settle_rigid_body(shell, supported)
        return settle_rigid_body(shell, shell.move(supported, -self._factor.solve(shell.flat_forces(supported - x))))


def settle_rigid_body(shell: Shell, x: Floats) -> Floats:
    """(N, 3) the state x after the rotation that maximises the work of the dead loads; x if it cannot rotate.

    Both x and the result meet the supports.
    """
    places = x[shell.fixed_points]
    if not shell.loads.any() or not len(places) or span_a_plane(places):
        return x
    free = shell.rigid_motions(x).shape[1]
    pivot = places.mean(axis=0)
    arms = shell.translated(x, -pivot)
    _, sizes, axes = np.linalg.svd(places - pivot)
    if free == 1 and sizes[0] > RANK_TOLERANCE * shell.extent:
        rotation = _about_line(arms, shell.loads, axes[0])
    elif free == 3 and sizes[0] <= RANK_TOLERANCE * shell.extent:
        rotation = _about_point(arms, shell.loads)
    else:
        return x  # other supports fix some components
    return shell.translated(arms @ rotation.T, pivot)


def _about_line(arms: Floats, loads: Floats, axis: Floats) -> Floats:
    """(3, 3) the rotation about an axis that maximises the work of the loads on points at arms (N, 3) mm."""
    across = arms - np.outer(arms @ axis, axis)
    along, aside = float((loads * across).sum()), float((loads * np.cross(axis, across)).sum())
    return np.asarray(Rotation.from_rotvec(np.arctan2(aside, along) * axis).as_matrix())


def _about_point(arms: Floats, loads: Floats) -> Floats:
    """(3, 3) the rotation about a point that maximises the work of the loads (Kabsch 1976)."""
    u, sizes, vt = np.linalg.svd(arms.T @ loads)
    if sizes[1] <= RANK_TOLERANCE * sizes[0]:  # all loads are parallel
        return np.asarray(Rotation.align_vectors(vt[0], u[:, 0])[0].as_matrix()) if sizes[0] > 0.0 else np.eye(3)
    vt[-1] *= np.sign(np.linalg.det(u @ vt))
    return np.asarray((u @ vt).T)
