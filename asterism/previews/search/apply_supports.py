"""Later supports: the supported points of a sheet move to their places in equal steps."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.relax import follow
from asterism.fem.shell.shell import Shell
from asterism.pattern.geometry.rigid_fit import rigid_fit

# number of steps in which supported degrees of freedom move to their places
SUPPORT_STEPS = 6
# name of the start of the resulting equilibrium
SUPPORT_START = "pins take hold"


def apply_supports(shell: Shell, factor: Factor, x: Floats, was_free: bool) -> ShellEquilibrium:
    """The equilibrium with the shell's supports, from a state x (N, 3) mm that does not meet all of them.

    A sheet that was free is first laid where its supported points come closest to their places.
    """
    target = shell.reduction.target
    if was_free:
        x = _laid_on_supports(shell, x, target.reshape(-1, 3))
    start = x.ravel() - shell.reduction.map @ shell.reduction.project(x)
    for step in range(1, SUPPORT_STEPS + 1):
        share = step / SUPPORT_STEPS
        moved = shell.with_target((1.0 - share) * start + share * target)
        equilibrium = follow(moved, moved.constrain(x), factor, SUPPORT_START)
        x = equilibrium.x
    return equilibrium


def _laid_on_supports(shell: Shell, x: Floats, places: Floats) -> Floats:
    """(N, 3) x after the rigid motion that brings supported points closest to their places (N, 3)."""
    held = shell.fixed_points
    rotation, shift = rigid_fit(x[held], places[held])
    return np.asarray(shell.translated(x @ rotation.T, shift))
