"""An equilibrium of the shell, with its certificate."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.newton.minimise import Minimum


@dataclass(frozen=True)
class Trial:
    """An initial guess that was followed, with the state x (N, 3) in mm where it ended and its energy in N mm."""

    name: str
    energy: float
    is_minimum: bool
    iterations: int
    x: Floats


@dataclass(kw_only=True)
class ShellEquilibrium(Minimum):
    """A state of the shell with its certificate: minimum, saddle or not converged.

    Attributes
    ----------
    strains : (T, Q, 6) at the quadrature points; `fem.search.relax.follow` continues from them.
    energies : N mm, by part: as `Shell.energies`, with the part of Gaussian curvature as `gaussian`.
    soft_modes : (k,) N/mm^3, smallest eigenvalues of the Hessian with respect to the mass matrix of unit density. A
        mode of 1 mm rms displacement has half of this times the area as its energy. An eigenvalue far below the others
        belongs to a near-zero mode, such as a rotation of the roll axis of a uniform sheet. Empty if not computed.
    guess : name of the initial guess that led here.
    trials : all initial guesses that were followed.
    load_steps : number of steps in which fields and loads were applied; 0 without load steps.

    For the others, see `Minimum`.
    """

    strains: Floats
    energies: dict[str, float]
    guess: str
    soft_modes: Floats = field(default_factory=lambda: np.empty(0))
    trials: tuple[Trial, ...] = ()
    load_steps: int = 0

    @property
    def x(self) -> Floats:
        """(N, 3) positions of the dofs, mm."""
        return self.state  # type: ignore[no-any-return]

    @property
    def absolute_energy(self) -> float:
        """N mm, sum of the absolute values of the parts: the scale of errors of the energy."""
        return sum(map(abs, self.energies.values()))
