"""An equilibrium of the exact model, with its certificate."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial import cKDTree

from asterism.discrete.model.discrete_model import DiscreteModel, star_normals
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array, Ints
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.roll_axis import roll_axis_from_normals


@dataclass(frozen=True)
class PathStep:
    """One step of the continuation; a summary has an entry with these names for each step."""

    step: int  # 0 during the release of the fabric; later the `step` of the pins that take hold
    release: float  # released part of the stretch, 0 to 1
    moved: float  # part of their way that the pins have moved, 0 to 1
    vertices: int  # number of vertices of the mesh
    energy_n_mm: float  # energy at the end of the step
    iterations: int  # number of Newton iterations, those after kicks included
    kicks: int  # number of times that the state had become unstable and was moved along its negative mode


@dataclass(frozen=True)
class Equilibrium:
    """A state of the exact model with its certificate."""

    state: State  # positions and directors
    energies: dict[str, float]  # N mm, by part
    gradient_norm: float  # N, 2-norm of the gradient by the free dofs
    tolerance: float  # N, limit of the gradient norm
    smallest_eigenvalue: float  # N/mm, of the Hessian in (mm, rad) coordinates without rigid motions
    eigenvalue_error: float  # N/mm, norm of its residual
    bumps: Array  # (S,) mm, heights of the stars; positive to the plastic side
    iterations: int  # total number
    factorisations: int  # total number
    saddles_left: int  # number of saddles left in the final minimisation; kicks before it are in `path`
    backend: str  # name of the linear solver
    seconds: dict[str, float] = field(default_factory=dict)  # wall time by stage
    path: tuple[PathStep, ...] = ()  # the steps that led here; the last one is the final minimisation

    @property
    def energy(self) -> float:
        """N mm."""
        return sum(self.energies.values())

    @property
    def converged(self) -> bool:
        """The gradient norm is at most the tolerance."""
        return self.gradient_norm <= self.tolerance

    @property
    def is_minimum(self) -> bool:
        """The certificate: converged, and the smallest eigenvalue is positive beyond its error."""
        return self.converged and self.smallest_eigenvalue > self.eigenvalue_error

    @property
    def sides(self) -> Ints:
        """(S,) 1 for stars that bump to the plastic side, -1 for inverted stars, 0 for flat ones."""
        # stars with a lower bump are flat
        return np.where(np.abs(self.bumps) > 1e-6, np.sign(self.bumps), 0.0).astype(np.int64)

    @property
    def stars_up(self) -> int:
        """Number of stars that bump to the plastic side."""
        return int((self.sides > 0).sum())

    @property
    def instabilities_passed(self) -> int:
        """Number of unstable states left on the way, saddles of the final minimisation included."""
        return sum(step.kicks for step in self.path)

    def followed_by(self, end: Equilibrium) -> Equilibrium:
        """The equilibrium `end` of a search that went on from this one, with the effort and the path of both."""
        return replace(
            end,
            iterations=self.iterations + end.iterations,
            factorisations=self.factorisations + end.factorisations,
            seconds={key: self.seconds.get(key, 0.0) + end.seconds.get(key, 0.0) for key in self.seconds | end.seconds},
            path=(*self.path, *end.path),
        )

    @property
    def without_effort(self) -> Equilibrium:
        """This equilibrium as one that has cost nothing."""
        path = tuple(replace(step, iterations=0, kicks=0) for step in self.path)
        return replace(self, iterations=0, factorisations=0, seconds={}, path=path)


def roll_axis_deg(model: DiscreteModel, state: State) -> float | None:
    """Axis of a rolled sheet in printed coordinates, 0 to 180 deg from the x axis; None for other shapes."""
    if model.layout.has_stars:
        return roll_axis_from_normals(model.layout, star_normals(model, state))
    _, vertex = cKDTree(model.mesh.points).query(model.layout.sample_points)
    return roll_axis_from_normals(model.layout, vertex_normals(state.positions, model.mesh.triangles)[vertex])
