"""A preview's form to go back to, for undo and for comparisons of designs."""

from __future__ import annotations

from dataclasses import dataclass

from fem.elements.tabulation import Floats
from fem.search.sides import Side
from pattern.design.design import Design


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A design and the equilibrium of its shell; `Preview.restore` goes back to it. It can be pickled.

    Attributes
    ----------
    design : of the sheet.
    side : to which the edges were asked to go.
    triangles : of the shell's mesh that were asked for, if any.
    x : (N, 3) mm, positions of the shell's dofs; read only.
    energy_n_mm : of the equilibrium.
    """

    design: Design
    side: Side
    triangles: int | None
    x: Floats
    energy_n_mm: float

    def __post_init__(self) -> None:
        own = self.x.copy()
        own.flags.writeable = False
        object.__setattr__(self, "x", own)
