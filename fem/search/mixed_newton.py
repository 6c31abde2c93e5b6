"""Newton's method with mixed integration points (Magisano, Leonetti and Garcea 2017).

The strains `eps` at the quadrature points iterate as unknowns of their own, and with them the stress S(eps): a step d
solves

    (B' A B + S : e'') d = -B' [S + A (e(x) - eps)],    eps <- e(x) + B d,

where A and S belong to eps, B and e'' to x. Large rotations change e(x) at second order in d, but not eps. So spurious
membrane stresses of a thin sheet do not enter the steps, and few steps suffice.

After a short step with a small residual the next step uses the same matrix, so most edits need a single matrix.

The method finds stationary points; `equilibrium.newton` checks afterwards whether one is a minimum. A matrix that is
not positive definite is regularised (`fem.search.regularised`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.regularised import Regularised
from asterism.fem.shell.shell import Shell

# the next step uses the same matrix if all three limits hold
REUSE_RESIDUAL_RATIO = 0.03  # 1: residual after a step over that before it
REUSE_TOLERANCES = 3e3  # 1: residual over the tolerance
REUSE_STEP = 1e-3  # 1: step over the extent of the sheet
# 1: residual after a step over that before it, below which the exact matrix is tried first
MAX_RESIDUAL_RATIO = 0.5
# 1: largest step over the extent of the sheet; longer steps are shortened
MAX_STEP = 0.15
# 1: displacement over the extent of the sheet, after which the isostatic support is chosen again
MAX_MOVE_PER_SUPPORT = 0.05

# 1: largest difference from a known stationary point over the extent of the sheet, at which the iteration jumps to it;
# from there two or three iterations are left
KNOWN_DISTANCE = 1e-3


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
    known: Sequence[Floats] = (),
) -> Mixed:
    """Iterate to a stationary point from a state x that meets the supports.

    Parameters
    ----------
    x : (N, 3) mm.
    factor : of `shell.factor()`; at the end it holds the last matrix.
    tolerance : N, of the gradient's 2-norm.
    strains : (T, Q, 6) mixed strains at x. By default they are zero, which is better for an initial guess.
    max_iterations : largest number of iterations.
    known : (N, 3) each, stationary points. A state that comes near one of them goes on from there.
    """
    clock = Clock()
    eps = np.zeros((*shell.assembly.weights.shape, 6)) if strains is None else strains
    result = Mixed(x, eps, np.inf, False, 0, 0, 0, seconds=clock.seconds)
    extent = shell.extent
    matrix = Regularised(shell, factor, clock)
    moved, step_size = 0.0, np.inf
    for number in range(max_iterations + 1):
        near = [each for each in known if np.abs(result.x - each).max() <= KNOWN_DISTANCE * extent]
        if near:
            result.x, known = near[0], ()
        e = clock("strains", shell.strains, result.x)
        if near:
            result.strains = e
        _, stress, stiffness = clock("law", shell.density, result.strains)
        external = shell.external_gradient(result.x)
        predicted = stress + np.matmul(stiffness, (e - result.strains)[..., None])[..., 0]
        stress_of_x = predicted if shell.density.quadratic else shell.density(e)[1]
        gradient = shell.restrict(clock("forces", shell.assembly.forces, result.x, predicted) + external)
        exact = (
            gradient
            if stress_of_x is predicted
            else shell.restrict(shell.assembly.forces(result.x, stress_of_x) + external)
        )
        residual_before, result.residual = result.residual, float(np.linalg.norm(exact))
        result.history.append(result.residual)
        result.iterations = number
        result.converged = result.residual <= tolerance
        if result.converged or number == max_iterations or not np.isfinite(result.residual):
            break
        if (
            matrix.changed
            or result.residual > min(REUSE_RESIDUAL_RATIO * residual_before, REUSE_TOLERANCES * tolerance)
            or step_size > REUSE_STEP * extent
        ):
            if number == 0 or moved > MAX_MOVE_PER_SUPPORT * extent or not shell.is_rigid_invariant:
                support, moved = clock("support", shell.support, result.x), 0.0
            accepted = matrix.factorise(
                result.x, stiffness, stress, support, result.residual < MAX_RESIDUAL_RATIO * residual_before
            )
            result.factorisations, result.blended = matrix.factorisations, matrix.blended
            if not accepted:
                return result
        direction = -clock("solve", factor.solve, gradient)
        step = shell.move(np.zeros_like(result.x), direction)
        step_size = float(np.abs(step).max())
        length = MAX_STEP * extent / max(step_size, MAX_STEP * extent)
        step_size *= length
        moved += step_size
        result.strains = e + length * clock("strains", shell.assembly.strain_changes, result.x, step)
        result.x = result.x + length * step
    result.strains = e
    return result
