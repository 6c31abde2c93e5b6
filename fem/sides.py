"""The side of the printed plane that a sheet's edges are on."""

from __future__ import annotations

from fem.seeds import Side
from fem.shell import Shell
from fem.tabulation import Floats

FLAT_MM = 1e-6


def side_of(shell: Shell, x: Floats) -> Side:
    """Where the edges of a state x (N, 3) are: `down` or `up`, `auto` if it is flat.

    Where heights are held it is the other side of that to which the sheet goes from there, in the mean; else that to
    which it is curved, in the mean.
    """
    if shell.holds_heights:
        rise = float((shell.places(x)[:, 2] - shell.level[2]).mean())
    else:
        weights, forms = shell.assembly.weights, shell.strains(x) + shell.rest
        size = float(weights.sum()) ** 0.5
        bent = float((weights[..., None] * forms[..., 3:5]).sum() / weights.sum())
        rise = -bent * size**2  # b = n . hess x is negative where edges go down
    return "auto" if abs(rise) < FLAT_MM else "down" if rise > 0.0 else "up"
