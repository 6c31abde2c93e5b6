"""The matrix of a Newton step, changed by as little as makes it positive definite.

Two things make it indefinite. Where the membrane is pushed, the sheet buckles: a part of what pushes is left out of the
stress S (`fem.shell.tension`). Where nothing is left out any more and the matrix is refused again, a soft motion has a
negative stiffness, such as that of a tube that hardly prefers an axis. Leaving out stress would make that motion far
too stiff: hundreds of short steps. So the mass times a small stiffness per area is added instead. With about twice the
negative one this turns the step along the soft motion round, and hardly changes all others.

Both are as little as the factorisation accepts, and less and less in the steps that follow; none where the iteration
does well and the matrix itself is accepted.
"""

from __future__ import annotations

import numpy as np

from equilibrium.clock import Clock
from equilibrium.linear.factor import Factor
from equilibrium.linear.rigid_support import stiffen
from fem.elements.tabulation import Floats, Ints
from fem.shell.shell import Shell
from fem.shell.tension import tensile_part

# parts of the pushing stress: the first one left out, how many times more the next ones are, what stays left out for
# the next step, and the part that is too small to be left out
FIRST, MORE, STAYS, LEAST = 0.3, 3.0, 0.6, 0.05
# the same of the stiffness per area that is added for soft motions, over that of the sheet's longest wave; and how
# often more of it is tried
SOFT_FIRST, SOFT_MORE, SOFT_STAYS, SOFT_LEAST, SOFT_TRIES = 0.1, 4.0, 0.3, 0.05, 6


class Regularised:
    """Factorises the matrices of one iteration.

    Attributes
    ----------
    factorisations : tried, the refused ones among them.
    blended : matrices that left stress out.
    changed : the last matrix is not that of the state itself.
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
        """The last matrix is not that of the state itself."""
        return self._blend > 0.0 or self._shift > 0.0

    def factorise(self, x: Floats, stiffness: Floats, stress: Floats, support: Ints, falls: bool = False) -> bool:
        """The matrix at x (N, 3), its rigid motions held at unknowns `support`; False if nothing helps.

        `stiffness` (T, Q, 6, 6) and `stress` (T, Q, 6) of the strains that go with x. `falls`: the last step did well.
        """
        before = self._blend
        self._blend = STAYS * before if STAYS * before > LEAST else 0.0
        self._shift = SOFT_STAYS * self._shift if SOFT_STAYS * self._shift > SOFT_LEAST * self._unit else 0.0
        tries = SOFT_TRIES if self._soft or before > 0.0 else 0
        known: list[tuple[float, Floats]] = []

        def tangent(blend: float) -> Floats:
            if len(known) == 2:  # it is linear in the stress, so two tell all others
                (first, one), (second, two) = known
                return one + (blend - first) / (second - first) * (two - one)
            kept = (1.0 - blend) * stress + blend * tensile_part(stress) if blend else stress
            known.append((blend, self._clock("tangent", self._shell.tangent, x, stiffness, kept)))
            return known[-1][1]

        if falls and self._blend and not self._shift and self._accepts(tangent(0.0), support):
            self._blend = 0.0
            return True
        data = tangent(self._blend)
        while not self._accepts(data, support):
            if self._blend == 0.0 and tries:
                self._shift = max(SOFT_MORE * self._shift, SOFT_FIRST * self._unit)
                self._soft, tries = True, tries - 1
                continue
            if self._blend >= 1.0:
                return False
            self._shift, self._soft = 0.0, False
            self._blend = min(max(MORE * self._blend, FIRST), 1.0)
            data = tangent(self._blend)
        self.blended += self._blend > 0.0
        return True

    def _accepts(self, data: Floats, support: Ints) -> bool:
        held = data + self._shift * self._shell.mass_entries if self._shift else data.copy()
        stiffen(self._shell.pattern, held, support)
        self.factorisations += 1
        return bool(self._clock("factorisation", self._factor.factorise, held))
