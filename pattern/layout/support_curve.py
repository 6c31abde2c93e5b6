"""The curve in space along which supported edges of the outline are held.

The design gives a place in space for each corner of a chain of edges. The curve is the best affine image of the printed
edges plus a shift. The shift interpolates what remains at the corners by cubic splines over the printed length, so that
places that are an affine image of the corners give exactly that image of the edges. Splines end at sharp corners.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import nearest_segment

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

# deg, corners of the outline with larger turns are sharp: the curve may have a kink there
SHARP_CORNER_DEG = 30.0


@dataclass(frozen=True, eq=False)
class SupportCurve:
    """The curve of a chain of edges.

    Attributes
    ----------
    corners : (k, 2) mm, printed corners along the chain; a closed chain ends with its first corner.
    stations : (k,) mm, printed length from the first corner.
    matrix, offset : (3, 2) and (3,) mm of the affine image.
    shifts : splines of the rest (3,) mm over the stations, one for each smooth stretch.
    ends : (s + 1,) stations at which the stretches begin, and the last end.
    """

    corners: Floats
    stations: Floats
    matrix: Floats
    offset: Floats
    shifts: tuple[CubicSpline, ...]
    ends: Floats

    @classmethod
    def through(cls, corners: Floats, places: Floats) -> SupportCurve:
        """The curve through places (k, 3) mm of corners (k, 2) mm; both end with the first row if it is closed.

        Examples
        --------
        >>> corners = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])
        >>> curve = SupportCurve.through(corners, np.column_stack([0.8 * corners, [0.0, 3.0, 0.0]]))
        >>> curve.places(np.array([[5.0, 0.0]])).round(3).tolist()
        [[4.0, 0.0, 2.25]]
        """
        from scipy.interpolate import CubicSpline  # slow to import; designs without such curves do without it

        is_closed = np.array_equal(corners[0], corners[-1])
        step = np.diff(corners, axis=0)
        stations = np.concatenate([[0.0], np.cumsum(np.linalg.norm(step, axis=1))])
        centre = corners.mean(axis=0)
        terms = np.column_stack([corners - centre, np.ones(len(corners))])
        fitted = np.linalg.lstsq(terms, places, rcond=None)[0]
        matrix = fitted[:2].T
        rest = places - terms @ fitted
        rest[np.abs(rest) < 1e-9 * (1.0 + np.abs(places).max())] = 0.0
        sharp = _sharp(step, is_closed)
        if is_closed and not sharp[0]:
            if not sharp.any():
                shifts = (CubicSpline(stations, rest, bc_type="periodic"),)
                return cls(corners, stations, matrix, fitted[2] - matrix @ centre, shifts, stations[[0, -1]])
            # the stretch that goes through the first corner is interpolated over both of its parts
            return cls._turned(corners, places, int(np.flatnonzero(sharp)[0]))
        breaks = np.unique([0, *np.flatnonzero(sharp), len(corners) - 1])
        shifts = tuple(CubicSpline(stations[a : b + 1], rest[a : b + 1]) for a, b in itertools.pairwise(breaks))
        return cls(corners, stations, matrix, fitted[2] - matrix @ centre, shifts, stations[breaks])

    @classmethod
    def _turned(cls, corners: Floats, places: Floats, first: int) -> SupportCurve:
        order = np.append((first + np.arange(len(corners) - 1)) % (len(corners) - 1), first)
        return cls.through(corners[order], places[order])

    def places(self, printed: Floats) -> Floats:
        """(n, 3) mm, places of printed points (n, 2) on the edges."""
        return np.asarray(printed @ self.matrix.T + self.offset + self._shift(self._edges(printed), printed)[:, 0])

    def shift(self, points: Floats, middles: Floats, tangents: Floats) -> Floats:
        """(n, 3, 3) mm: the shift from the affine image, and its first and second derivative along the printed edge.

        Parameters
        ----------
        points : (n, 2) mm, on the edges.
        middles : (n, 2) mm, of the mesh edges of the points: at a sharp corner they tell the stretch.
        tangents : (n, 2) unit vectors along which the derivatives are taken.
        """
        edges = self._edges(middles)
        along = self.corners[edges + 1] - self.corners[edges]
        sense = np.sign(np.einsum("ni,ni->n", along, tangents))
        return self._shift(edges, points) * np.stack([np.ones_like(sense), sense, np.ones_like(sense)], 1)[:, :, None]

    def _edges(self, points: Floats) -> Ints:
        """(n,) the nearest edge of each point."""
        if not len(points):
            return np.empty(0, dtype=np.int64)
        return np.asarray(nearest_segment(points, self.corners[:-1], self.corners[1:]))

    def _shift(self, edges: Ints, points: Floats) -> Floats:
        """(n, 3, 3) shift and its derivatives at points (n, 2), on the stretches of these edges."""
        middle = 0.5 * (self.stations[edges] + self.stations[edges + 1])
        stretch = np.searchsorted(self.ends, middle) - 1
        result = np.zeros((len(points), 3, 3))
        for number, spline in enumerate(self.shifts):
            its = np.flatnonzero(stretch == number)
            if len(its):
                station = np.clip(self._stations(points[its], number, edges[its]), *self.ends[[number, number + 1]])
                result[its] = np.stack([spline(station, order) for order in range(3)], axis=1)
        return result

    def _stations(self, points: Floats, stretch: int, edges: Ints) -> Floats:
        """(n,) mm, stations of the nearest places to points (n, 2) on a stretch; `edges` say in which turn."""
        first, last = np.searchsorted(self.stations, self.ends[[stretch, stretch + 1]])
        start, end = self.corners[first:last], self.corners[first + 1 : last + 1]
        nearest = nearest_segment(points, start, end)
        way = end[nearest] - start[nearest]
        part = np.einsum("ni,ni->n", points - start[nearest], way) / np.einsum("ni,ni->n", way, way)
        return np.asarray(self.stations[first + nearest] + np.clip(part, 0.0, 1.0) * np.linalg.norm(way, axis=1))


def _sharp(step: Floats, is_closed: bool) -> np.ndarray:
    """(k,) whether each corner between steps (k - 1, 2) is sharp; the first and last corner of a closed chain count."""
    before = np.roll(step, 1, axis=0)
    cross = before[:, 0] * step[:, 1] - before[:, 1] * step[:, 0]
    turn = np.abs(np.arctan2(cross, np.einsum("ni,ni->n", before, step)))
    sharp = turn > np.radians(SHARP_CORNER_DEG)
    if not is_closed:
        sharp[0] = False
    return np.append(sharp, is_closed and sharp[0])
