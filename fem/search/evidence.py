"""An equilibrium of the shell, with its certificate."""

from __future__ import annotations

from dataclasses import dataclass, field

from asterism.equilibrium.arrays import Floats


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
    """A state of the shell with its certificate: minimum, saddle or not converged.

    Attributes
    ----------
    x : (N, 3) positions of the dofs, mm.
    strains : (T, Q, 6) at the quadrature points; `fem.search.relax.follow` continues from them.
    energies : N mm, by part: as `Shell.energies`, with the part of Gaussian curvature as `gaussian`.
    gradient_norm, tolerance : N, 2-norm of the gradient by the free unknowns, and its limit.
    definite : the exact Hessian, with rigid motions fixed, is positive definite.
    soft_modes : (k,) N/mm^3, smallest eigenvalues of the Hessian with respect to the mass matrix of unit density. A
        mode of 1 mm rms displacement has half of this times the area as its energy. An eigenvalue far below the others
        belongs to a near-zero mode, such as a rotation of the roll axis of a uniform sheet. Empty if not computed.
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
        """Total energy in N mm."""
        return sum(self.energies.values())

    @property
    def absolute_energy(self) -> float:
        """N mm, sum of the absolute values of the parts: the scale of errors of the energy."""
        return sum(map(abs, self.energies.values()))

    @property
    def converged(self) -> bool:
        """The gradient norm is at most the tolerance."""
        return self.gradient_norm <= self.tolerance

    @property
    def is_minimum(self) -> bool:
        """The certificate: converged, and the exact Hessian is positive definite."""
        return self.converged and self.definite
