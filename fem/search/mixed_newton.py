"""Newton's method with mixed integration points (Magisano, Leonetti and Garcea 2017).

The strains `eps` at the quadrature points iterate as unknowns of their own, and with them the stress S(eps): a step d
solves

    (B' A B + S : e'') d = -B' [S + A (e(x) - eps)],    eps <- e(x) + B d,

where A and S belong to eps, B and e'' to x. Large rotations enter e(x) at second order in d but not eps, so the steps
of a thin sheet are not spoilt by membrane stresses that are not there, and a handful suffices.

After a short step with a small residual the next step uses the same matrix: most edits need only one matrix.

The method finds stationary points; `equilibrium.newton` checks afterwards whether one is a minimum. A matrix that is
not positive definite is regularised (`fem.search.regularised`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from equilibrium.clock import Clock
from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.search.regularised import Regularised
from fem.shell.shell import Shell

# The next step uses the same matrix if all three limits hold.
REUSE_RESIDUAL_RATIO = 0.03  # of the residual after a step to that before it
REUSE_TOLERANCES = 3e3  # of the residual to the tolerance
REUSE_STEP = 1e-3  # of the step to the extent of the sheet
MAX_RESIDUAL_RATIO = 0.5  # of the residuals: after a better step the unmodified matrix is tried first
MAX_STEP = 0.15  # part of the extent of the sheet: longer steps are shortened
MAX_MOVE_PER_SUPPORT = 0.05  # part of the extent: after longer moves the isostatic support is chosen again


@dataclass
class Mixed:
    """Where the iteration stopped.

    Attributes
    ----------
    x : (N, 3).
    strains : (T, Q, 6) the mixed strains; at the end those of x, unless every regularised matrix was refused.
    residual : 2-norm over the free unknowns of the gradient at x, N.
    converged : the residual is at most the tolerance.
    blended : number of matrices without part of the compressive stress.
    history : residuals of all iterations.
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
        """x, under the name of `equilibrium.newton.find_minimum.IterationResult`."""
        return self.x


def mixed_newton(
    shell: Shell,
    x: Floats,
    factor: Factor,
    tolerance: float,
    strains: Floats | None = None,
    max_iterations: int = 30,
) -> Mixed:
    """A stationary point near x (N, 3), a state that meets the supports.

    `strains` (T, Q, 6) are the mixed strains at x. By default they are zero, which is better if x is a guess.
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
        if (
            matrix.changed
            or found.residual > min(REUSE_RESIDUAL_RATIO * before, REUSE_TOLERANCES * tolerance)
            or reach > REUSE_STEP * size
        ):
            if number == 0 or moved > MAX_MOVE_PER_SUPPORT * size or not shell.is_rigid_invariant:
                support, moved = clock("support", shell.support, found.x), 0.0
            accepted = matrix.factorise(
                found.x, stiffness, stress, support, found.residual < MAX_RESIDUAL_RATIO * before
            )
            found.factorisations, found.blended = matrix.factorisations, matrix.blended
            if not accepted:
                return found
        direction = -clock("solve", factor.solve, gradient)
        step = shell.move(np.zeros_like(found.x), direction)
        reach = float(np.abs(step).max())
        length = MAX_STEP * size / max(reach, MAX_STEP * size)
        reach *= length
        moved += reach
        found.strains = e + length * clock("strains", shell.assembly.strain_changes, found.x, step)
        found.x = found.x + length * step
    found.strains = e
    return found
