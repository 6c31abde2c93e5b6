"""Regularisation of the Newton matrix: the smallest change that makes it positive definite.

The matrix is indefinite for two reasons.

- The membrane is compressed and the sheet buckles. A share of the compressive stress is left out of the geometric
  stiffness (`fem.shell.tension`).
- A soft mode has a negative stiffness, for example in a tube that hardly prefers an axis of rolling. Without its stress
  this mode would be far too stiff, and the iteration would take hundreds of short steps. Therefore a multiple of the
  mass matrix is added (Levenberg-Marquardt; Nocedal and Wright 2006, section 3.4). About twice the negative stiffness
  reverses the step along the mode and hardly changes the others.

Both changes are as small as the factorisation allows, and they decay in the following steps. If the iteration converges
well and the matrix itself is definite, both are zero.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.rigid_support import stiffen
from asterism.fem.shell.shell import Shell
from asterism.fem.shell.tension import tensile_part

# blend: share of the compressive stress that is left out of the matrix
FIRST_BLEND = 0.3  # 1: after the first refused matrix
BLEND_GROWTH = 3.0  # 1: from one refused matrix to the next
BLEND_DECAY = 0.6  # 1: from one step to the next
MIN_BLEND = 0.05  # 1: below it the blend is set to zero
# shift: stiffness per area that is added for soft modes, over the bending stiffness of the longest wave of the sheet
FIRST_SHIFT = 0.1  # 1: after the first refused matrix
REFUSED_SHIFT_GROWTH = 4.0  # 1: from one refused matrix to the next
SHIFT_DECAY = 0.3  # 1: from one step to the next
MIN_SHIFT = 0.05  # 1: below it the shift is set to zero
MAX_SHIFTS = 6  # shifts that are tried in one step


class Regularised:
    """Factorises the matrices of one search, and keeps blend and shift from step to step.

    Attributes
    ----------
    factorisations : number of factorisations, refused ones included.
    blended : number of accepted matrices without part of the compressive stress.
    """

    def __init__(self, shell: Shell, factor: Factor, clock: Clock) -> None:
        self._shell, self._factor, self._clock = shell, factor, clock
        size = shell.extent
        self._unit = float(shell.density.stiffness[..., 3, 3].mean()) * (np.pi / size) ** 4
        self._blend = self._shift = 0.0
        self._soft = False
        self.factorisations = self.blended = 0

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
        self._blend = BLEND_DECAY * before if BLEND_DECAY * before > MIN_BLEND else 0.0
        self._shift = SHIFT_DECAY * self._shift if SHIFT_DECAY * self._shift > MIN_SHIFT * self._unit else 0.0
        tries = MAX_SHIFTS if self._soft or before > 0.0 else 0
        computed: list[tuple[float, Floats]] = []

        def tangent(blend: float) -> Floats:
            if len(computed) == 2:  # the matrix is linear in the blend, so two matrices give all others
                (blend0, matrix0), (blend1, matrix1) = computed
                return matrix0 + (blend - blend0) / (blend1 - blend0) * (matrix1 - matrix0)
            kept_stress = (1.0 - blend) * stress + blend * tensile_part(stress) if blend else stress
            computed.append((blend, self._clock("tangent", self._shell.tangent, x, stiffness, kept_stress)))
            return computed[-1][1]

        if falls and self._blend and not self._shift and self._accepts(tangent(0.0), support):
            self._blend = 0.0
            return True
        data = tangent(self._blend)
        while not self._accepts(data, support):
            if self._blend == 0.0 and tries:
                self._shift = max(REFUSED_SHIFT_GROWTH * self._shift, FIRST_SHIFT * self._unit)
                self._soft, tries = True, tries - 1
                continue
            if self._blend >= 1.0:
                return False
            self._shift, self._soft = 0.0, False
            self._blend = min(max(BLEND_GROWTH * self._blend, FIRST_BLEND), 1.0)
            data = tangent(self._blend)
        self.blended += self._blend > 0.0
        return True

    def _accepts(self, data: Floats, support: Ints) -> bool:
        held = data + self._shift * self._shell.mass_entries if self._shift else data.copy()
        stiffen(self._shell.pattern, held, support)
        self.factorisations += 1
        return bool(self._clock("factorisation", self._factor.factorise, held))
