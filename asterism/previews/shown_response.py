"""The linear response of an edit as the result that a preview shows.

A picture needs positions only. Energies and gradient take a third of the time of a response, and are computed when a
summary asks for them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.linear_response import Response
from asterism.fem.search.relax import energies_by_part
from asterism.fem.shell.shell import Shell


@dataclass(frozen=True, eq=False)
class ShownResponse:
    """A linear response, with the evidence that it is no equilibrium.

    Attributes
    ----------
    shell : after the edit.
    resting : the equilibrium before the edit.
    response : the response to the edit.
    x : (N, 3) mm, positions of the dofs, on the ground.
    """

    shell: Shell
    resting: ShellEquilibrium
    response: Response
    x: Floats

    @cached_property
    def evidence(self) -> ShellEquilibrium:
        """Energies and gradient at the response. It is a minimum only if the edit changes nothing."""
        shell, resting, x = self.shell, self.resting, self.response.x
        gradient = float(np.linalg.norm(shell.gradient(x)))
        return replace(
            resting,
            x=self.x,
            strains=self.response.strains,
            energies=energies_by_part(shell, x),
            gradient_norm=gradient,
            definite=resting.definite and gradient <= resting.tolerance,
            soft_modes=np.empty(0),
            trials=(),
        )
