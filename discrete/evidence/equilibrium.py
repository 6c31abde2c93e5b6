"""An equilibrium, and the evidence that it is one."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from discrete.energies.elements import Array
from discrete.evidence.effort import PathStep
from discrete.model.state import State
from pattern.geometry.arrays import Ints

MIN_SIDE_BUMP_MM = 1e-6  # a bump that is lower is on neither side


@dataclass(frozen=True)
class Equilibrium:
    """A state of the exact model with the evidence for what it is.

    Attributes
    ----------
    state : positions and directors.
    energies : N mm, by part.
    gradient_norm : 2-norm over the free dofs, N.
    tolerance : that `converged` compares it with.
    smallest_eigenvalue : of the Hessian in (mm, rad) coordinates without its rigid motions, N/mm; `eigenvalue_error`
        is the norm of its residual.
    bumps : (S,) mm, positive for stars that bump to the plastic side.
    path : the steps that led here; the last one is the tight minimisation.
    saddles_left : after it; kicks before are in `path`.
    seconds : wall time by stage.
    """

    state: State
    energies: dict[str, float]
    gradient_norm: float
    tolerance: float
    smallest_eigenvalue: float
    eigenvalue_error: float
    bumps: Array
    iterations: int
    factorisations: int
    saddles_left: int
    backend: str
    seconds: dict[str, float] = field(default_factory=dict)
    path: tuple[PathStep, ...] = ()

    @property
    def energy(self) -> float:
        """N mm."""
        return sum(self.energies.values())

    @property
    def converged(self) -> bool:
        """The gradient is below the tolerance."""
        return self.gradient_norm <= self.tolerance

    @property
    def is_minimum(self) -> bool:
        """Converged, and every eigenvalue is positive beyond the error of the smallest."""
        return self.converged and self.smallest_eigenvalue > self.eigenvalue_error

    @property
    def sides(self) -> Ints:
        """(S,) 1 for stars that bump to the plastic side, -1 for the other one, 0 for flat ones."""
        return np.where(np.abs(self.bumps) > MIN_SIDE_BUMP_MM, np.sign(self.bumps), 0.0).astype(np.int64)

    @property
    def stars_up(self) -> int:
        """Stars that bump to the plastic side."""
        return int((self.sides > 0).sum())

    @property
    def instabilities_passed(self) -> int:
        """Times that the path lost its stability and was followed down to the side, saddles at its end included."""
        return sum(step.kicks for step in self.path)
