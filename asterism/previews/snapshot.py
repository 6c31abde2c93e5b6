"""Snapshots of a preview, for undo and for comparisons of designs."""

from __future__ import annotations

from dataclasses import dataclass

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.mean_fields import Side
from asterism.pattern.design.design import Design


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A design and the equilibrium of its shell, for `Preview.restore`. It can be pickled.

    Attributes
    ----------
    design : the design.
    side : requested side of the edges.
    triangles : requested number of triangles; None for the default.
    x : (N, 3) degrees of freedom of the shell; read-only.
    energy_n_mm : energy of the equilibrium.
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
