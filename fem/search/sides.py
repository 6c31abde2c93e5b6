"""The side of the printed plane that a sheet's edges are on."""

from __future__ import annotations

from fem.elements.tabulation import Floats
from fem.search.mean_fields import Side
from fem.shell.shell import Shell

FLAT_MM = 1e-6


def side_of(shell: Shell, x: Floats) -> Side:
    """Where the edges of a state x (N, 3) are, by its mean curvature: `down` or `up`, `auto` if it is flat."""
    weights, forms = shell.assembly.weights, shell.strains(x) + shell.rest
    # mm; b = n . hess x is negative where edges go down
    sag = float((weights[..., None] * forms[..., 3:5]).sum())
    return "auto" if abs(sag) < FLAT_MM else "down" if sag < 0.0 else "up"
