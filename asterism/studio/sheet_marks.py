"""What the page draws on a shown mesh: ribbons along arms and rods, and needles below the supported points."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.point_location import TriangleFinder, clipped
from asterism.pattern.layout.layout import Layout
from asterism.studio.ribbon_stations import STATIONS, ribbon_stations

NEEDLE_SPACING = 1.0  # of the needles along supported edges, over that of the stars
STATION_CANDIDATES = 8  # triangles that are tried for a station: those of a shown mesh are well shaped


class SheetMarks:
    """Ribbons and needles of a sheet on a mesh. Places on the mesh are kept until ribbons or needles change.

    Parameters
    ----------
    printed : (V, 2) mm.
    triangles : (T, 3).
    """

    def __init__(self, printed: Floats, triangles: Ints) -> None:
        self.printed, self.triangles = printed, triangles
        self._ribbons_of: Layout | None = None
        self._ribbon_points = np.empty((0, STATIONS, 2))
        self._station_triangles: Ints = np.empty(0, dtype=np.int64)
        self._needle_points = np.empty((0, 2))

    def ribbons(self, layout: Layout, positions: Floats, normals: Floats) -> tuple[Floats, Floats]:
        """(A, K, 2, 3) left and right upper edges of the ribbons, and (A, K, 3) normals."""
        if layout is not self._ribbons_of:
            self._ribbons = ribbon_stations(layout)
            self._ribbons_of = layout
        ribbons = self._ribbons
        if not np.array_equal(ribbons.points, self._ribbon_points) or not len(ribbons.points):
            points = ribbons.points.reshape(-1, 2)
            known = self._station_triangles if len(self._station_triangles) == len(points) else None
            self._stations, self._station_triangles = self._interpolation(points, known)
            self._ribbon_points = ribbons.points
        shape = *ribbons.width.shape, 3
        middle = (self._stations @ positions).reshape(shape)
        normal = _unit((self._stations @ normals).reshape(shape))
        across = _unit(np.cross(normal, np.gradient(middle, axis=1)))
        top, half = middle + ribbons.thickness[..., None] * normal, 0.5 * ribbons.width[..., None] * across
        return np.stack([top + half, top - half], axis=2), normal

    def needles(self, layout: Layout, positions: Floats) -> Floats:
        """(N, 2, 3) foot on the ground and tip in the sheet; along supported edges one in each spacing."""
        printed = [layout.pin_points]
        for edge in layout.supported_edges.tolist():
            start, end = layout.edges.start[edge], layout.edges.end[edge]
            count = max(int(np.linalg.norm(end - start) / (NEEDLE_SPACING * layout.spacing_mm)), 1)
            printed.append(start + np.arange(count)[:, None] / count * (end - start))
        points = np.concatenate(printed)
        if not len(points):
            return np.empty((0, 2, 3))
        if not np.array_equal(points, self._needle_points):
            self._needle_points, (self._in_needles, _) = points, self._interpolation(points)
        tips = self._in_needles @ positions
        feet = tips.copy()
        feet[:, 2] = min(0.0, float(tips[:, 2].min()))
        return np.stack([feet, tips], axis=1)

    def _interpolation(self, points: Floats, known: Ints | None = None) -> tuple[sp.csr_matrix, Ints]:
        """(n, V) linear interpolation from the vertices to printed points (n, 2), and their triangles (n,).

        The points are in the triangles `known` (n,), if these are given, but for a few.
        """
        if known is None:
            triangle, weights = self._finder.nearest(points, STATION_CANDIDATES)
        else:
            triangle, weights = self._finder.near_before(points, known, STATION_CANDIDATES)
        corners, ends = self.triangles[triangle], np.arange(0, 3 * len(points) + 1, 3)
        shape = len(points), len(self.printed)
        return sp.csr_matrix((clipped(weights).ravel(), corners.ravel(), ends), shape), triangle

    @cached_property
    def _finder(self) -> TriangleFinder:
        return TriangleFinder(self.printed, self.triangles)


def _unit(vectors: Floats) -> Floats:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(length == 0.0, 1.0, length))
