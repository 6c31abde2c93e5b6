"""Newton's method with mixed integration points (Magisano, Leonetti and Garcea 2017).

The strains `eps` at the quadrature points iterate as unknowns of their own, and with them the stress S(eps): a step d
solves

    (B' A B + S : e'') d = -B' [S + A (e(x) - eps)],    eps <- e(x) + B d,

where A and S belong to eps, B and e'' to x. Large rotations change e(x) at second order in d, but not eps. So spurious
membrane stresses of a thin sheet do not enter the steps, and few steps suffice.

After a short step with a small residual the next step uses the same matrix, so most edits need a single matrix.

The method finds stationary points; `equilibrium.newton` checks afterwards whether one is a minimum.

A matrix that is not positive definite is regularised: the smallest change makes it positive definite. It is indefinite
for two reasons.

- The membrane is compressed and the sheet buckles. A share of the compressive stress is left out of the geometric
  stiffness (`fem.shell.shell`).
- A soft mode has a negative stiffness, for example in a tube that hardly prefers an axis of rolling. Without its stress
  this mode would be far too stiff, and the iteration would take hundreds of short steps. Therefore a multiple of the
  mass matrix is added (Levenberg-Marquardt; Nocedal and Wright 2006, section 3.4). About twice the negative stiffness
  reverses the step along the mode and hardly changes the others.

Both changes are as small as the factorisation allows, and they decay in the following steps. If the iteration converges
well and the matrix itself is definite, both are zero.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import stiffen
from asterism.equilibrium.newton.minimise import Minimum
from asterism.fem.shell.shell import Shell, tensile_part

# 1: largest step over the extent of the sheet; longer steps are shortened
MAX_STEP = 0.15
# blend: share of the compressive stress that is left out of the matrix
FIRST_BLEND = 0.3  # 1: after the first refused matrix
BLEND_DECAY = 0.6  # 1: from one step to the next
# shift: stiffness per area that is added for soft modes, over the bending stiffness of the longest wave of the sheet
FIRST_SHIFT = 0.1  # 1: after the first refused matrix
SHIFT_DECAY = 0.3  # 1: from one step to the next


def mixed_newton(
    shell: Shell,
    x: Floats,
    factor: Factor,
    tolerance: float,
    strains: Floats | None = None,
    max_iterations: int = 30,
    known: Sequence[Floats] = (),
) -> Minimum:
    """Iterate to a stationary point from a state x that meets the supports.

    The result is where the iteration stopped; its energy and its Hessian are not computed.

    Parameters
    ----------
    x : (N, 3) mm.
    factor : of `shell.factor()`; at the end it holds the last matrix.
    tolerance : N, of the gradient's 2-norm.
    strains : (T, Q, 6) mixed strains at x. By default they are zero, which is better for an initial guess.
    max_iterations : largest number of iterations.
    known : (N, 3) each, stationary points. A state that comes near one of them goes on from there.
    """
    eps = np.zeros((*shell.assembly.weights.shape, 6)) if strains is None else strains
    result, extent = Minimum(x, np.nan, np.inf, tolerance), shell.extent
    matrix = Regularised(shell, factor)
    moved, step_size = 0.0, np.inf
    for number in range(max_iterations + 1):
        # the iteration jumps to a known stationary point that is this near; from there two or three iterations are left
        near = [each for each in known if np.abs(result.state - each).max() <= 1e-3 * extent]
        if near:
            result.state, known = near[0], ()
        e = shell.strains(result.state)
        if near:
            eps = e
        _, stress, stiffness = shell.density(eps)
        predicted = stress + np.matmul(stiffness, (e - eps)[..., None])[..., 0]
        gradient = shell.restrict(shell.assembly.forces(result.state, predicted) + shell.load_gradient)
        exact = gradient
        if not shell.density.quadratic:
            exact = shell.restrict(shell.assembly.forces(result.state, shell.density(e)[1]) + shell.load_gradient)
        residual_before, result.gradient_norm = result.gradient_norm, float(np.linalg.norm(exact))
        result.iterations = number
        if result.converged or number == max_iterations or not np.isfinite(result.gradient_norm):
            break
        # else the next step uses the same matrix
        if (
            matrix.changed
            or result.gradient_norm > min(0.03 * residual_before, 3e3 * tolerance)
            or step_size > 1e-3 * extent
        ):
            # after this displacement the isostatic support is chosen again
            if number == 0 or moved > 0.05 * extent or not shell.is_rigid_invariant:
                support, moved = shell.support(result.state), 0.0
            # if it is true, the exact matrix is tried first
            falls = result.gradient_norm < 0.5 * residual_before
            accepted = matrix.factorise(result.state, stiffness, stress, support, falls)
            result.factorisations = matrix.factorisations
            if not accepted:
                break
        step = shell.move(np.zeros_like(result.state), -factor.solve(gradient))
        step_size = float(np.abs(step).max())
        length = MAX_STEP * extent / max(step_size, MAX_STEP * extent)
        step_size *= length
        moved += step_size
        eps = e + length * shell.assembly.strain_changes(result.state, step)
        result.state = result.state + length * step
    return result


class Regularised:
    """Factorises the matrices of one search, and keeps blend and shift from step to step."""

    def __init__(self, shell: Shell, factor: Factor) -> None:
        self._shell, self._factor = shell, factor
        size = shell.extent
        self._unit = float(shell.density.stiffness[..., 3, 3].mean()) * (np.pi / size) ** 4
        self._blend = self._shift = 0.0
        self._soft = False
        self.factorisations = 0  # number of factorisations, refused ones included

    @property
    def changed(self) -> bool:
        """Whether the last matrix differs from the exact one."""
        return self._blend > 0.0 or self._shift > 0.0

    def factorise(self, x: Floats, stiffness: Floats, stress: Floats, support: Ints, falls: bool = False) -> bool:
        """Factorise the matrix at x (N, 3); False if even the most regularised matrix is not positive definite.

        Parameters
        ----------
        stiffness, stress : (T, Q, 6, 6) and (T, Q, 6), at the mixed strains.
        support : unknowns at which rigid motions are fixed.
        falls : the residual decreased well, so the exact matrix is tried first.
        """
        before = self._blend
        self._blend = BLEND_DECAY * before if BLEND_DECAY * before > 0.05 else 0.0
        self._shift = SHIFT_DECAY * self._shift if SHIFT_DECAY * self._shift > 0.05 * self._unit else 0.0
        tries = 6 if self._soft or before > 0.0 else 0
        computed: list[tuple[float, Floats]] = []

        def tangent(blend: float) -> Floats:
            if len(computed) == 2:  # the matrix is linear in the blend, so two matrices give all others
                (blend0, matrix0), (blend1, matrix1) = computed
                return matrix0 + (blend - blend0) / (blend1 - blend0) * (matrix1 - matrix0)
            kept_stress = (1.0 - blend) * stress + blend * tensile_part(stress) if blend else stress
            computed.append((blend, self._shell.tangent(x, stiffness, kept_stress)))
            return computed[-1][1]

        if falls and self._blend and not self._shift and self._accepts(tangent(0.0), support):
            self._blend = 0.0
            return True
        data = tangent(self._blend)
        while not self._accepts(data, support):
            if self._blend == 0.0 and tries:
                self._shift = max(4.0 * self._shift, FIRST_SHIFT * self._unit)
                self._soft, tries = True, tries - 1
                continue
            if self._blend >= 1.0:
                return False
            self._shift, self._soft = 0.0, False
            self._blend = min(max(3.0 * self._blend, FIRST_BLEND), 1.0)
            data = tangent(self._blend)
        return True

    def _accepts(self, data: Floats, support: Ints) -> bool:
        held = data + self._shift * self._shell.mass_entries if self._shift else data.copy()
        stiffen(self._shell.pattern, held, support)
        self.factorisations += 1
        return bool(self._factor.factorise(held))
