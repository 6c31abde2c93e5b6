"""The sheet of a motif in space: the smooth surface of the shell, with the rods drawn on it."""

from __future__ import annotations

from copy import copy
from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.edges.supported_edge import SupportedEdge
from asterism.previews.motifs.motif_sheet import MotifSheet
from asterism.previews.motifs.motif_values import MotifFieldValues
from asterism.previews.surface.places import Places
from asterism.previews.surface.shown_shape import mesh_to_show, shape_on_mesh
from asterism.previews.surface.smooth_surface import smooth_surface
from asterism.shape.shape import Shape

# largest edge of the triangles of a preview's shape, over the spacing of the lattice
MAX_SHOWN_MOTIF_EDGE = 1 / 3


class MotifLens:
    """Computes the positions of a fixed set of printed points (n, 2) mm for shells of one sheet of a motif.

    Attributes
    ----------
    sheet, points : as given.

    Raises
    ------
    ValueError
        A point is outside of the sheet.
    """

    def __init__(self, sheet: MotifSheet, points: Floats) -> None:
        self.points = np.atleast_2d(np.asarray(points, dtype=float))
        self._at = sheet.space.locate(self.points)
        self.sheet, self._rim = sheet, SupportedEdge(sheet, self.points)

    def renewed(self, sheet: MotifSheet) -> MotifLens:
        """The lens of the same points on a sheet after an edit that keeps the print; unchanged parts are shared.

        Raises
        ------
        ValueError
            The sheet has another print.
        """
        if sheet is self.sheet:
            return self
        if sheet.space is not self.sheet.space:
            raise ValueError("the sheet has another print: make a new lens")
        lens = copy(self)
        lens.sheet = sheet
        if not self.sheet.has_pins_of(sheet.layout):
            lens._rim = SupportedEdge(sheet, self.points)
        return lens

    def __call__(self, x: Floats, values: MotifFieldValues) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        smooth = smooth_surface(self._at, x)
        smooth = replace(smooth, places=smooth.places + self._rim(x))
        return Places(smooth, np.zeros_like(smooth.places))


def shown_motif_mesh(sheet: MotifSheet) -> Mesh:
    """The mesh of a preview's shape, see `mesh_to_show`."""
    return mesh_to_show(sheet, MAX_SHOWN_MOTIF_EDGE)


def motif_shape_of(sheet: MotifSheet, mesh: Mesh, places: Places) -> Shape:
    """The shape, without a summary. It has no bumps."""
    return shape_on_mesh(
        sheet, mesh, places, np.full(len(mesh.points), -1, dtype=np.int64), _fields_of_rods(sheet, mesh)
    )


def _fields_of_rods(sheet: MotifSheet, mesh: Mesh) -> dict[str, np.ndarray]:
    """Fields of the rod edges: number of the rod, and thickness and width at the middle of the edge."""
    thickness, width = [], []
    for rod, path in zip(sheet.layout.graph.rods, mesh.rods, strict=True):
        steps = np.linalg.norm(np.diff(mesh.points[path], axis=0), axis=1)
        middles = (np.cumsum(steps) - 0.5 * steps) / steps.sum()
        thickness.append(rod.at(rod.thickness, middles))
        width.append(rod.at(rod.width, middles))
    number = np.repeat(np.arange(len(mesh.rods)), [len(path) - 1 for path in mesh.rods])
    return {
        "arm": number,
        "star": np.full(len(number), -1),
        "thickness_mm": np.concatenate(thickness),
        "width_mm": np.concatenate(width),
    }
