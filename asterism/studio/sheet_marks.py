"""What the page draws of a sheet: its mesh, ribbons along arms and rods, and needles below the supported points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import is_in_sorted
from asterism.pattern.geometry.point_location import TriangleFinder, clipped
from asterism.pattern.layout.layout import Layout
from asterism.studio.messages import ShownMesh

STATIONS = 5  # along each ribbon
# length of a ribbon along a drawn rod, so that curves look smooth; longer where there would be too many ribbons
RIBBON_MM = 5.0
# thickness of the fabric as the page draws it below the sheet's places: plastic below hangs at its lower face
FABRIC_MM = 0.8
NO_SITE = 2**32 - 1  # in place of the row of a star, for ribbons of drawn rods
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
        """(A, K, 3, 3) left and right outer edges of the ribbons and their middle on the fabric, (A, K, 3) normals."""
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
        normal = ribbons.side[:, None, None] * _unit((self._stations @ normals).reshape(shape))
        middle += (ribbons.side < 0)[:, None, None] * FABRIC_MM * normal
        across = _unit(np.cross(normal, np.gradient(middle, axis=1)))
        top, half = middle + ribbons.thickness[..., None] * normal, 0.5 * ribbons.width[..., None] * across
        return np.stack([top + half, top - half, middle], axis=2), normal

    def needles(self, layout: Layout, positions: Floats) -> Floats:
        """(N, 2, 3) needles: foot on the ground and tip in the sheet, along supported edges one in each spacing.

        A tube holds edges shorter than the spacing, such as the pieces of a curve: after the needles come both ends of
        each.
        """
        start, end = (ends[layout.supported_edges] for ends in (layout.edges.start, layout.edges.end))
        counts = (np.linalg.norm(end - start, axis=1) / layout.spacing_mm).astype(int)
        printed = [layout.pin_points]
        for a, b, count in zip(start, end, counts.tolist(), strict=True):
            printed.append(a + np.arange(count)[:, None] / max(count, 1) * (b - a))
        count, is_piece = sum(map(len, printed)), counts == 0
        points = np.concatenate([*printed, start[is_piece], end[is_piece]])
        if not len(points):
            return np.empty((0, 2, 3))
        if not np.array_equal(points, self._needle_points):
            self._needle_points, (self._in_needles, _) = points, self._interpolation(points)
        tips = self._in_needles @ positions
        feet = tips[:count].copy()
        feet[:, 2] = min(0.0, float(tips[:, 2].min()))
        pieces = tips[count:].reshape(2, -1, 3).swapaxes(0, 1)
        return np.concatenate([np.stack([feet, tips[:count]], axis=1), pieces])

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


@dataclass(frozen=True)
class RibbonStations:
    """Stations along all ribbons, in printed coordinates.

    Attributes
    ----------
    points : (A, K, 2) mm, of the middle lines.
    width, thickness : (A, K) mm.
    site : (A,) row of the star's site in the plan; `NO_SITE` for drawn rods.
    side : (A,) 1 above the fabric, -1 below.
    """

    points: Floats
    width: Floats
    thickness: Floats
    site: Ints
    side: Ints


def ribbon_stations(layout: Layout) -> RibbonStations:
    """The stations of a layout: arms from the centre to the tip, then drawn rods in pieces of about `RIBBON_MM`.

    Examples
    --------
    >>> from asterism.pattern.design.design import Design
    >>> from asterism.pattern.layout.build import layout
    >>> lines = [{"line_mm": [(-5, 0), (5, 0)]}]
    >>> sheet = layout(Design.from_dict({"rods": {"draw": lines}, "border": {"rectangle_mm": (12, 8)}}))
    >>> stations = ribbon_stations(sheet)
    >>> stations.points[:, [0, -1], 0].tolist()
    [[-5.0, 0.0], [0.0, 5.0]]
    """
    share = np.linspace(0.0, 1.0, STATIONS)
    start = layout.centres[layout.arm_star][:, None]
    points = [start + share[:, None] * (layout.arm_tip[:, None] - start)]
    width, thickness = ([_between(ends, share)] for ends in (layout.arm_width, layout.arm_thickness))
    longest = max(RIBBON_MM, sum(rod.length for rod in layout.drawn_rods) / 6000)
    for rod in layout.drawn_rods:
        count = int(np.ceil(rod.length / longest))
        part = ((np.arange(count)[:, None] + share) / count).ravel()
        points.append(rod.at(rod.points, part).reshape(count, STATIONS, 2))
        width.append(rod.at(rod.width, part).reshape(count, STATIONS))
        thickness.append(rod.at(rod.thickness, part).reshape(count, STATIONS))
    site = np.full(sum(len(part) for part in points), NO_SITE)
    site[: len(layout.arm_star)] = layout.star_number[layout.arm_star]
    side = np.repeat(layout.rod_side, [1] * len(layout.arm_star) + [len(part) for part in points[1:]])
    return RibbonStations(np.concatenate(points), np.concatenate(width), np.concatenate(thickness), site, side)


def _between(ends: Floats, share: Floats) -> Floats:
    """(A, K) values between those at both ends (A, 2)."""
    return np.asarray(ends[:, :1] + share * (ends[:, 1:] - ends[:, :1]))


def mesh_message(number: int, printed: Floats, triangles: Ints, arm_site: Ints) -> ShownMesh:
    """The message with a mesh: points (V, 2) mm, triangles (T, 3), and the row of the site of each ribbon (A,)."""
    return ShownMesh(
        mesh=number,
        printed=printed.astype(np.float32),
        triangles=triangles.astype(np.uint32),
        outline=outline_of(triangles).astype(np.uint32),
        arm_site=arm_site.astype(np.uint32),
    )


def outline_of(triangles: Ints) -> Ints:
    """(E, 2) edges around a sheet of triangles (T, 3) and its holes; the sheet is to their left.

    Examples
    --------
    >>> sorted(outline_of(np.array([[0, 1, 2], [0, 2, 3]])).tolist())
    [[0, 1], [1, 2], [2, 3], [3, 0]]
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)
    size = int(edges.max()) + 1
    there: Ints = edges[:, 0] * size + edges[:, 1]
    back: Ints = edges[:, 1] * size + edges[:, 0]
    return np.asarray(edges[~is_in_sorted(there, np.sort(back))])
