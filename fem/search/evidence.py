"""An equilibrium of the shell, and the evidence that it is one."""

from __future__ import annotations

from dataclasses import dataclass, field

from fem.elements.tabulation import Floats


@dataclass(frozen=True)
class Trial:
    """An initial guess that was followed, with the state x (N, 3) in mm where it ended and its energy in N mm."""

    name: str
    energy: float
    is_minimum: bool
    iterations: int
    x: Floats


@dataclass(frozen=True)
class ShellEquilibrium:
    """A state of the shell with the evidence for its kind: minimum, saddle or not converged.

    Attributes
    ----------
    x : (N, 3) positions of the dofs, mm.
    strains : (T, Q, 6) at the quadrature points; `fem.search.relax.follow` continues from them.
    energies : N mm, by part: as `Shell.energies`, with the part of Gaussian curvature as `gaussian`.
    gradient_norm, tolerance : N, over the free unknowns.
    definite : the exact Hessian is positive definite (rigid motions held).
    soft_modes : (k,) N/mm^3, smallest eigenvalues of the Hessian against the printed area: the energy of a mode of one
        mm mean square is half of that times the area. Empty if they were not asked for. One far below the others
        belongs to a neutral motion, such as the axis about which an even sheet rolls.
    guess : name of the initial guess that led here.
    trials : all initial guesses that were followed.
    load_steps : number of steps in which fields and loads were applied; 0 without load steps.
    saddles_left : number of saddles on the way.
    fallbacks : number of times that energy minimisation replaced Newton's method with mixed points.
    seconds : by part.
    """

    x: Floats
    strains: Floats
    energies: dict[str, float]
    gradient_norm: float
    tolerance: float
    definite: bool
    soft_modes: Floats
    guess: str
    trials: tuple[Trial, ...] = ()
    load_steps: int = 0
    iterations: int = 0
    factorisations: int = 0
    saddles_left: int = 0
    fallbacks: int = 0
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def energy(self) -> float:
        """N mm."""
        return sum(self.energies.values())

    @property
    def absolute_energy(self) -> float:
        """N mm, sum of the absolute values of the parts: the scale of errors of the energy."""
        return sum(map(abs, self.energies.values()))

    @property
    def converged(self) -> bool:
        """The gradient is below the tolerance."""
        return self.gradient_norm <= self.tolerance

    @property
    def is_minimum(self) -> bool:
        """Converged, and the exact Hessian is positive definite."""
        return self.converged and self.definite
