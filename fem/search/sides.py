"""The side of the printed plane on which the edges of a sheet are."""

from __future__ import annotations

from typing import Literal, get_args

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.shell import Shell

Side = Literal["auto", "up", "down"]

FLAT_SAG_MM = 1e-6  # mm, area integral of the curvatures, below which a sheet counts as flat


def check_side(side: str) -> None:
    """Raise ValueError if the side is none of `auto`, `up`, `down`."""
    if side not in get_args(Side):
        raise ValueError(f"side = {side!r}: must be {', '.join(get_args(Side))}")


def side_of(shell: Shell, x: Floats) -> Side:
    """Side of the edges of a state x (N, 3), from its mean curvature: `down`, `up`, or `auto` if it is flat."""
    weights, forms = shell.assembly.weights, shell.strains(x) + shell.rest
    # mm; b = n . hess x is negative if the edges are below the centre
    sag = float((weights[..., None] * forms[..., 3:5]).sum())
    return "auto" if abs(sag) < FLAT_SAG_MM else "down" if sag < 0.0 else "up"
