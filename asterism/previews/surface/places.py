"""Positions of printed points in space, and what computes them: one lens for each kind of pattern."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol

from asterism.equilibrium.arrays import Floats
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.surface.smooth_surface import SmoothSurface


@dataclass(frozen=True)
class Places:
    """Positions of n printed points in space.

    Attributes
    ----------
    surface : the smooth surface of the shell.
    bumps : (n, 3) mm, vectors from there to the sheet with its bumps; zero for the sheet of a motif.
    """

    surface: SmoothSurface
    bumps: Floats

    @property
    def smooth(self) -> Floats:
        """(n, 3) mm, positions on the smooth surface."""
        return self.surface.places

    @property
    def bumpy(self) -> Floats:
        """(n, 3) mm, positions with bumps."""
        return self.smooth + self.bumps


class SheetLens(Protocol):
    """Computes the positions of a fixed set of printed points for shells of one sheet."""

    points: Floats

    @property
    def sheet(self) -> Any:
        """The sheet of the points."""

    def renewed(self, sheet: Any) -> SheetLens:
        """The lens of the same points on a sheet after an edit that keeps the print."""

    def __call__(self, x: Floats, values: Any) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""


@dataclass(frozen=True)
class ShownSheet:
    """The triangles of a preview's shape, and the lens that computes the positions of their vertices."""

    mesh: Mesh
    lens: SheetLens

    def renewed(self, old: Any, sheet: Any) -> ShownSheet | None:
        """The same triangles for a sheet with another pattern; None if that moves its rods or asks for another mesh.

        Parameters
        ----------
        old, sheet : the sheet of these triangles, and another one of the same print.
        """
        if not (old.has_rods_of(sheet.layout) and old.design.mesh == sheet.design.mesh):
            return None
        return replace(self, lens=self.lens.renewed(sheet))
