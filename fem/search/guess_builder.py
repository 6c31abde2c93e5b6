"""Takes guesses into their frame, and moves them within themselves until their membrane hardly strains."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial.transform import Rotation

from equilibrium.linear.factor import Factor
from equilibrium.linear.rigid_support import stiffen
from fem.elements.tabulation import Evaluation, Floats
from fem.search.rigid_body_settling import settle_rigid_body
from fem.search.simple_shapes import Plane, SimpleShape, similar
from fem.shell.shell import Shell
from fem.supports.rigid import span_a_plane

SLIDES = 3
SLIGHT = 0.1  # of the energy: corrections that gain less are the last
LATER = 0.25  # of what a correction gains: as much as all later ones; mostly each gains a fifth of the one before
AS_PRINTED = 1e-6  # largest entry of a turn that is none


@dataclass(frozen=True)
class InitialGuess:
    """A state to start from: the shape it was made of, and its energy in N mm."""

    shape: SimpleShape
    x: Floats
    energy: float


class GuessBuilder:
    """A shell's conditions, and the plane that its guesses are bent from.

    Parameters
    ----------
    factor : is left with the flat sheet's stiffness once that was asked for.
    centre, stretch : of the plane, see `fem.search.simple_shapes.similar`.
    """

    def __init__(self, shell: Shell, factor: Factor, centre: Floats, stretch: float) -> None:
        self._shell, self._factor = shell, factor
        self._plane = similar(centre, stretch)
        self._located: dict[bytes, Evaluation] = {}
        self._bent: dict[SimpleShape, InitialGuess] = {}

    @cached_property
    def _ready(self) -> bool:
        """Whether the factor holds the flat sheet's stiffness; asked for before every use."""
        shell = self._shell
        data = shell.flat_stiffness.copy()
        stiffen(shell.pattern, data, shell.support(shell.flat))
        return self._factor.factorise(data)

    @cached_property
    def _turn(self) -> Floats | None:
        """(3, 3) how what is held lies in space, against the print; None where it does as that.

        A line of places that is not clamped says nothing of the turn about it: of all the smallest is taken.
        """
        held, reduction = self._shell.fixed_points, self._shell.reduction
        places = reduction.offset(self._shell.progress).reshape(-1, 3)[held]
        printed, places = (at - at.mean(axis=0) for at in (self._shell.flat[held], places))
        if len(reduction.normals):
            up = np.full(reduction.normals.shape, self._shell.extent) * [0.0, 0.0, 1.0]
            printed = np.concatenate([printed, up])
            places = np.concatenate([places, self._shell.extent * reduction.normals])
        elif not span_a_plane(places):
            farthest = np.linalg.norm(printed, axis=1).argmax()
            printed, places = printed[farthest], places[farthest]
            if not (printed.any() and places.any()):
                return None
        turn = Rotation.align_vectors(places, printed)[0].as_matrix()
        return None if np.abs(turn - np.eye(3)).max() < AS_PRINTED else np.asarray(turn)

    def bend(self, shape: SimpleShape) -> InitialGuess:
        """A shape as the conditions hold it."""
        if shape not in self._bent:
            x = self._held(shape.over(self._shell.space, self._plane))
            self._bent[shape] = InitialGuess(shape, x, self._shell.energy(x))
        return self._bent[shape]

    def relax_in_plane(self, start: InitialGuess, least: float = np.inf) -> InitialGuess:
        """A bent shape, its plane moved as its membrane stresses ask for, while it may still come below `least` N mm.

        The moves solve the flat sheet's linear membrane problem for the strains that the bent one has.
        """
        shell, shape = self._shell, start.shape
        moves = np.zeros_like(shell.flat)
        for _ in range(SLIDES if self._ready else 0):
            strains = shell.strains(start.x)
            strains[..., 3:] = 0.0
            stress = shell.linear_stress(strains)
            stress[..., 3:] = 0.0
            pull = shell.restrict(shell.assembly.forces(shell.flat, stress))
            moves = shell.move(moves, -self._factor.solve(pull))
            x = self._held(shape.over(shell.space, self._moved(moves)))
            trial = InitialGuess(shape, x, shell.energy(x))
            if not trial.energy < start.energy:
                break
            gained = start.energy - trial.energy
            slight = gained < SLIGHT * abs(start.energy)
            start = trial
            if slight or start.energy - LATER * gained > least:
                break
        return start

    def _moved(self, moves: Floats) -> Plane:
        """The plane after moves (N, 3) within it."""

        def plane(points: Floats) -> Floats:
            key = points.tobytes()
            if key not in self._located:
                self._located[key] = self._shell.space.locate(points)
            return self._plane(points) + self._located[key].jets(moves[:, :2])

        return plane

    def _held(self, x: Floats) -> Floats:
        """(N, 3) x moved to what holds it, bent there as the flat sheet would be, and hung where it can swing."""
        shell = self._shell
        if shell.is_free:
            return x
        held = shell.fixed_points
        if len(held):
            x = x if self._turn is None else shell.translated(x @ self._turn.T, np.zeros(3))
            places = shell.reduction.offset(shell.progress).reshape(-1, 3)
            x = shell.translated(x, places[held].mean(axis=0) - x[held].mean(axis=0))
        stepped = shell.constrain(x)
        if not self._ready:
            return settle_rigid_body(shell, stepped)
        return settle_rigid_body(shell, shell.move(stepped, -self._factor.solve(shell.flat_forces(stepped - x))))
