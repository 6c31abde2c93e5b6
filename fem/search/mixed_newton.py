"""Newton's method with mixed integration points (Magisano, Leonetti and Garcea 2017).

The strains `eps` at the quadrature points iterate as unknowns of their own, and with them the stress S(eps): a step d
solves

    (B' A B + S : e'') d = -B' [S + A (e(x) - eps)],    eps <- e(x) + B d,

where A and S belong to eps, B and e'' to x. Large rotations enter e(x) at second order in d but not eps, so the steps
of a thin sheet are not spoilt by membrane stresses that are not there, and a handful suffices.

A step that is short and leaves little of the residual is followed by one with the same matrix: most edits need but one.

The method finds stationary points; whether one is a minimum is asked afterwards. Where the matrix is not positive
definite it is changed by as little as makes it so (`fem.search.regularised`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from equilibrium.clock import Clock
from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.search.regularised import Regularised
from fem.shell.shell import Shell

# a step that leaves less of the residual, and so many tolerances at most, and is shorter than this part of the size, is
# followed by one with its factor
AGAIN, NEARLY, NEAR = 0.03, 3e3, 1e-3
FALLS = 0.5  # part of the residual: a step that leaves less may need no stress to be left out of the next matrix
FAR = 0.15  # of the sheet's size: a step beyond it is shortened
TURNED = 0.05  # of the sheet's size: after such moves other unknowns may have to stop the rigid motions


@dataclass
class Mixed:
    """Where the iteration stopped.

    Attributes
    ----------
    x : (N, 3).
    strains : (T, Q, 6) those that iterate; at the end the sheet's own, unless a matrix was refused.
    residual : 2-norm over the free unknowns of the gradient at x, N.
    converged : it is below the tolerance.
    blended : matrices that left pushing stress out.
    history : the residuals.
    """

    x: Floats
    strains: Floats
    residual: float
    converged: bool
    iterations: int
    factorisations: int
    blended: int
    history: list[float] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def state(self) -> Floats:
        """x, by the name that `equilibrium.newton.find_minimum` knows."""
        return self.x


def mixed_newton(
    shell: Shell,
    x: Floats,
    factor: Factor,
    tolerance: float,
    strains: Floats | None = None,
    max_iterations: int = 30,
) -> Mixed:
    """A stationary point near x (N, 3), which meets the conditions.

    `strains` (T, Q, 6) that go with x; by default none, which is the better start where x is a guess.
    """
    clock = Clock()
    eps = np.zeros((*shell.assembly.weights.shape, 6)) if strains is None else strains
    found = Mixed(x, eps, np.inf, False, 0, 0, 0, seconds=clock.seconds)
    size = shell.extent
    matrix = Regularised(shell, factor, clock)
    moved, reach = 0.0, np.inf
    for number in range(max_iterations + 1):
        e = clock("strains", shell.strains, found.x)
        _, stress, stiffness = clock("law", shell.density, found.strains)
        outer = shell.external_gradient(found.x)
        ahead = stress + np.matmul(stiffness, (e - found.strains)[..., None])[..., 0]
        own = ahead if shell.density.quadratic else shell.density(e)[1]
        gradient = shell.restrict(clock("forces", shell.assembly.forces, found.x, ahead) + outer)
        exact = gradient if own is ahead else shell.restrict(shell.assembly.forces(found.x, own) + outer)
        before, found.residual = found.residual, float(np.linalg.norm(exact))
        found.history.append(found.residual)
        found.iterations = number
        found.converged = found.residual <= tolerance
        if found.converged or number == max_iterations or not np.isfinite(found.residual):
            break
        if matrix.changed or found.residual > min(AGAIN * before, NEARLY * tolerance) or reach > NEAR * size:
            if number == 0 or moved > TURNED * size or not shell.is_rigid_invariant:
                support, moved = clock("support", shell.support, found.x), 0.0
            accepted = matrix.factorise(found.x, stiffness, stress, support, found.residual < FALLS * before)
            found.factorisations, found.blended = matrix.factorisations, matrix.blended
            if not accepted:
                return found
        direction = -clock("solve", factor.solve, gradient)
        step = shell.move(np.zeros_like(found.x), direction)
        reach = float(np.abs(step).max())
        length = FAR * size / max(reach, FAR * size)
        reach *= length
        moved += reach
        found.strains = e + length * clock("strains", shell.assembly.strain_changes, found.x, step)
        found.x = found.x + length * step
    found.strains = e
    return found
