"""Searches from two starts on the same meshes: the second one ends where it reaches the state of the first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from asterism.discrete.evidence.equilibrium import Equilibrium, PathStep
from asterism.discrete.release.ladder import Ladder
from asterism.pattern.geometry.rigid_fit import rigid_fit

# 1: difference of two energies over the elastic energy, below which two states of one mesh may be one
SAME_STATE_ENERGY = 1e-8
# 1: rms distance of these states after the best rigid motion over the rms radius of the sheet
SAME_STATE_DISTANCE = 1e-4


@dataclass(frozen=True)
class MeshLevel:
    """The shape on one mesh, and its effort.

    Attributes
    ----------
    vertices, iterations, factorisations : their numbers.
    seconds : wall time by stage.
    change_percent : rms distance to the shape on the level before, in % of the diameter; None for the first level.
    """

    vertices: int
    iterations: int
    factorisations: int
    seconds: dict[str, float]
    change_percent: float | None = None


@dataclass
class SharedSearch:
    """The states that a first search has reached on the models of a sheet.

    Two searches that reach one state on a mesh would repeat each other on all finer meshes. A second search with the
    same object therefore ends there, and its result is that of the first, if the first has found a minimum.

    Attributes
    ----------
    ladder : the models.
    ends : the equilibria of the first search; empty before its end.
    levels : their efforts.
    joined_at : number of vertices of the mesh on which the second search reached a state of the first; None before.
    """

    ladder: Ladder
    ends: list[Equilibrium] = field(default_factory=list)
    levels: list[MeshLevel] = field(default_factory=list)
    joined_at: int | None = None

    def reaches(self, number: int, end: Equilibrium) -> bool:
        """Whether a second search need not go on from its end on the model of this number, counted from 0."""
        return self.ends[-1].is_minimum and is_same_state(self.ends[number], end)

    def joined(
        self, levels: Sequence[MeshLevel], path: tuple[PathStep, ...]
    ) -> tuple[Equilibrium, list[MeshLevel], tuple[PathStep, ...]]:
        """Minimum of the first search, and levels and path of the second, which has joined it.

        Parameters
        ----------
        levels, path : of the second search so far. Finer meshes cost it nothing.
        """
        self.joined_at = levels[-1].vertices
        finer = [replace(level, iterations=0, factorisations=0, seconds={}) for level in self.levels[len(levels) :]]
        end = self.ends[-1]
        steps = [replace(step, iterations=0, kicks=0) for end in self.ends[len(levels) :] for step in end.path]
        return end, [*levels, *finer], (*path, *steps)


def is_same_state(first: Equilibrium, second: Equilibrium) -> bool:
    """Whether two ends on one mesh are one state: equal energy and stars, and one shape up to a rigid motion.

    An image of a state under a symmetry of the design is another state, even if it counts as the same form.
    """
    elastic = first.energy - first.energies.get("gravity", 0.0)
    if abs(first.energy - second.energy) > SAME_STATE_ENERGY * elastic:
        return False
    one, other = first.state.positions, second.state.positions
    rotation, shift = rigid_fit(other, one)
    distance = np.linalg.norm(other @ rotation.T + shift - one)
    radius = np.linalg.norm(one - one.mean(axis=0))
    return bool(distance < SAME_STATE_DISTANCE * radius and np.array_equal(first.sides, second.sides))
