"""All that a preview has computed, as one frozen value.

A change of the design makes a new state from the old one (`asterism.previews.solve`), and the session then replaces
the old by the new one as a whole. So an edit that fails or is interrupted leaves the old state. States share what did
not change: mesh, smoothed cells, supports, and the factor.

The linear response of an edit gives a picture its positions. Its energies and its gradient would take a third of the
time of a response, and are computed when a summary asks for them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.linear_response import Response
from asterism.fem.search.mean_fields import Side
from asterism.fem.search.relax import energies_by_part
from asterism.fem.shell.shell import Shell
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.previews.print_sheet import PrintSheet


@dataclass(frozen=True, eq=False)
class PreviewState:
    """A design, its shell, and the shell's state, for any pattern.

    Attributes
    ----------
    sheet : the print with its law, its mesh and its model.
    side : to which the edges were asked to go.
    shell : with the supports of all steps.
    resting : the last equilibrium, from which edits go on.
    factor : a solver for the shell's Hessians. Its content changes while an equilibrium is sought.
    watch : called at least once in each Newton iteration; an error that it raises ends the search.
    is_factor_resting : whether the factor holds the Hessian at `resting`.
    response : after the first stage of an edit, the linear response, which is shown in place of `resting`.
    """

    sheet: PrintSheet
    side: Side
    shell: Shell
    resting: ShellEquilibrium
    factor: Factor
    watch: Callable[[], None]
    is_factor_resting: bool = True
    response: Response | None = None

    @cached_property
    def x(self) -> Floats:
        """(N, 3) mm, positions of the shell's dofs as shown."""
        return self.resting.x if self.response is None else self.shell.shifted_to_ground(self.response.x)

    @cached_property
    def equilibrium(self) -> ShellEquilibrium:
        """What is shown, with its certificate; a linear response is a minimum only if the edit changes nothing."""
        shell, resting, response = self.shell, self.resting, self.response
        if response is None:
            return resting
        gradient = float(np.linalg.norm(shell.gradient(response.x)))
        definite = resting.definite and gradient <= resting.tolerance
        return replace(
            resting,
            state=self.x,
            strains=response.strains,
            energy=shell.energy(response.x),
            energies=energies_by_part(shell, response.x),
            gradient_norm=gradient,
            definite=definite,
            soft_modes=resting.soft_modes if definite else np.empty(0),
            trials=(),
        )

    @property
    def design(self) -> Design:
        """The design that is previewed."""
        return self.sheet.design

    @property
    def layout(self) -> Layout:
        """Its layout."""
        return self.sheet.layout

    @property
    def is_supported(self) -> bool:
        """Whether supports act along the print; a sheet that slides on all of its supports counts as free."""
        return self.layout.is_supported_in_plane
