"""Boundary-first flattening: a conformal map of a disk to the plane with prescribed scale factors at its border.

Sawhney and Crane 2017, "Boundary First Flattening". The logarithm u of the scale factor (flat length over length on
the surface) fulfils the equation of Yamabe for a flat result,

    Lap u = K                                   K: Gauss curvature of the surface.

Its values at the border can be chosen. They give the flux of u through the border, and this flux changes the geodesic
curvature k of the border to `k - du/dn`. Lengths `exp(u)` and curvatures determine the flat border; a least
correction of its lengths closes it. The inner vertices follow by harmonic extension.

**Laplacian and curvatures.** With the angles alpha and beta opposite to an edge, its weight is `(cot alpha + cot
beta)/2` (Pinkall and Polthier 1993). The matrix A with `(A u)_i = sum_j w_ij (u_i - u_j)` is positive semidefinite: it
stands for minus the integral of the Laplacian over the cell of vertex i.

**The smallest ratio of scale factors.** The logarithm u is determined by its values at the border. The smallest range
`max u - min u` over all border values is a linear programme: the border values are a Fourier series over the length of
the border, and each of its terms changes u by a harmonic function.

For a surface whose Gauss curvature has one sign, constant border values are the best (Chebyshev and Grave): a
harmonic function added to u increases its range.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import linprog
from scipy.sparse.linalg import SuperLU, splu
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.fitting.disk import Disk
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.geometry.point_location import TriangleFinder, clipped
from asterism.shape.surface import directed_edges


@dataclass(frozen=True, eq=False)
class FlatDisk:
    """A conformal map of a disk to the plane."""

    disk: Disk  # the surface
    points: Floats  # (V, 2) mm, positions of the vertices in the plane
    log_scale: Floats  # (V,) u, logarithm of the flat length over the length on the surface, as the equation gives it

    @cached_property
    def flipped(self) -> int:
        """Number of triangles that the map turns over."""
        return int(np.count_nonzero(triangle_areas(self.points, self.disk.triangles) <= 0.0))

    @property
    def ratio(self) -> float:
        """Largest scale factor over the smallest one."""
        return float(np.exp(np.ptp(self.log_scale)))


class Flattener:
    """Flattens one disk for several scale factors of its border; the factorisation is kept."""

    def __init__(self, disk: Disk) -> None:
        self.disk = disk
        inner, border = disk.inner, disk.border
        self._turning = np.pi - disk.angle_sums[border]
        rows = disk.laplacian.tocsr()
        self._inner_border = rows[inner][:, border]
        self._border_rows = rows[border]
        self._factor: SuperLU | None = splu(rows[inner][:, inner].tocsc()) if len(inner) else None

    @cached_property
    def border_lengths(self) -> Floats:
        """(B,) mm, lengths of the edges of the border on the surface; edge i begins at its vertex i."""
        ring = self.disk.vertices[self.disk.border]
        return np.asarray(np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1))

    def log_scale(self, border_log_scale: Floats) -> Floats:
        """(V,) solution u of the equation of Yamabe with these values (B,) at the border."""
        return self._spread(border_log_scale, -self.disk.gauss_curvature)

    def harmonic(self, border_values: Floats) -> Floats:
        """(V,) or (V, k) harmonic functions with these values (B,) or (B, k) at the border."""
        return self._spread(border_values, np.zeros((len(self.disk.inner), *border_values.shape[1:])))

    def flatten(self, border_log_scale: Floats | None = None) -> FlatDisk:
        """The flat disk whose border has these logarithms (B,) of the scale factor; zero by default.

        The closing correction changes them slightly.
        """
        given = np.zeros(len(self.disk.border)) if border_log_scale is None else border_log_scale
        u = self.log_scale(given)
        turning = self._turning + self._border_rows @ u
        following = np.roll(given, -1)
        lengths = np.exp(0.5 * (given + following)) * self.border_lengths
        # direction of edge i: it turns at its first vertex
        direction = np.cumsum(turning) - turning[0]
        tangents = np.stack([np.cos(direction), np.sin(direction)])
        weight = 1.0 / self.border_lengths
        # least change of the lengths, relative to the edges, that closes the curve
        spread = tangents / weight
        lengths = lengths - spread.T @ np.linalg.solve(spread @ tangents.T, tangents @ lengths)
        steps = (tangents * lengths).T
        ring = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)[:-1]])
        points = self.harmonic(ring)
        return FlatDisk(self.disk, points - points[self.disk.border].mean(axis=0), u)

    def _spread(self, border_values: Floats, source: Floats) -> Floats:
        """Values at all vertices that have these ones at the border, and `A u = source` inside."""
        values = np.empty((len(self.disk.vertices), *border_values.shape[1:]))
        values[self.disk.border] = border_values
        if self._factor is not None:
            values[self.disk.inner] = self._factor.solve(np.asarray(source - self._inner_border @ border_values))
        return values


def least_ratio_border(flattener: Flattener) -> Floats:
    """(B,) logarithms of the scale factor at the border for the smallest ratio of scale factors."""
    disk = flattener.disk
    around = np.cumsum(flattener.border_lengths) - flattener.border_lengths
    angle = 2.0 * np.pi * around / flattener.border_lengths.sum()
    waves = np.arange(1, 13)
    series = np.concatenate([np.cos(angle[:, None] * waves), np.sin(angle[:, None] * waves)], axis=1)
    start = flattener.log_scale(np.zeros(len(disk.border)))
    change = flattener.harmonic(series)
    # inner vertices that the programme bounds; u is smooth, so that a selection is enough
    inner = disk.inner[:: max(len(disk.inner) // 1500, 1)]
    rows = np.concatenate([disk.border, inner])
    ones, zeros = np.ones((len(rows), 1)), np.zeros((len(rows), 1))
    # unknowns: coefficients, upper and lower bound of u
    above = np.hstack([change[rows], -ones, zeros])
    below = np.hstack([-change[rows], zeros, ones])
    cost = np.concatenate([np.zeros(series.shape[1]), [1.0, -1.0]])
    limits = np.concatenate([-start[rows], start[rows]])
    solution = linprog(cost, np.vstack([above, below]), limits, bounds=(None, None), method="highs")
    if solution.status != 0:
        return np.zeros(len(disk.border))
    return np.asarray(series @ solution.x[: series.shape[1]])


@dataclass(frozen=True, eq=False)
class TargetMap:
    """A flattened target on the print."""

    flat: FlatDisk  # the flattening
    printed: Floats  # (V, 2) mm, printed positions of the vertices of the target
    spacing_mm: float  # of the stars

    @cached_property
    def log_contraction(self) -> Floats:
        """(V,) logarithm of the contraction that each vertex needs: length on the target over length on the print."""
        disk = self.flat.disk
        a, b = directed_edges(disk.triangles).T
        on_target, on_print = (np.linalg.norm(p[b] - p[a], axis=1) for p in (disk.vertices, self.printed))
        # the size that the map really has, with its closing correction; u gives the rest, without noise of the mesh
        level = float(np.log(on_target.sum() / on_print.sum()))
        mean_u = 0.5 * (self.flat.log_scale[a] + self.flat.log_scale[b])
        middle = float(np.average(mean_u, weights=on_target))
        return np.asarray(level - (self.flat.log_scale - middle))

    @cached_property
    def _finder(self) -> TriangleFinder:
        return TriangleFinder(self.printed, self.flat.disk.triangles)

    def interpolate(self, values: Floats, points: Floats) -> Floats:
        """(n, ...) values (V, ...) of the vertices at printed points (n, 2); outside, of the nearest triangle."""
        triangle, weights = self._finder.nearest(points)
        corners = values[self.flat.disk.triangles[triangle]]
        return np.asarray(np.einsum("nk,nk...->n...", clipped(weights), corners))

    def places(self, points: Floats) -> Floats:
        """(n, 3) mm, where the target has the printed points (n, 2)."""
        return self.interpolate(self.flat.disk.vertices, points)

    def principal_curvatures(self, points: Floats) -> Floats:
        """(n, 2) 1/mm at printed points (n, 2), the larger first, positive where the plastic side is convex.

        They are those of the quadric `x(X)` that fits the target around each point best, so that noise and features
        smaller than a cell do not count.
        """
        # of the spacing: distance of the points through which the quadric goes
        step = 0.2 * self.spacing_mm
        low, high = self.printed.min(axis=0), self.printed.max(axis=0)
        grid = np.stack(np.meshgrid(*(np.arange(a, b + step, step) for a, b in zip(low, high, strict=True))), axis=-1)
        samples = grid.reshape(-1, 2)
        triangle, weights = self._finder.nearest(samples)
        on_target = weights.min(axis=1) > -1e-9
        samples = samples[on_target]
        places = np.einsum(
            "nk,nkc->nc", weights[on_target], self.flat.disk.vertices[self.flat.disk.triangles[triangle[on_target]]]
        )
        tree = cKDTree(samples)
        result = np.zeros((len(points), 2))
        # of the spacing: curvatures are those of a quadric through the target within this distance on the print
        for row, near in enumerate(tree.query_ball_point(points, 0.9 * self.spacing_mm)):
            # twice the coefficients of a quadric; places with fewer points around have no curvature
            if len(near) >= 12:
                result[row] = _quadric_curvatures(samples[near] - points[row], places[near])
        return result


def _quadric_curvatures(shift: Floats, places: Floats) -> Floats:
    """(2,) principal curvatures at the origin of the quadric through places (n, 3) at shifts (n, 2)."""
    x, y = shift.T
    terms = np.column_stack([np.ones_like(x), x, y, 0.5 * x**2, 0.5 * y**2, x * y])
    _, along_x, along_y, xx, yy, xy = np.linalg.lstsq(terms, places, rcond=None)[0]
    normal = np.cross(along_x, along_y)
    length = np.linalg.norm(normal)
    if not length > 0.0:
        return np.zeros(2)
    first = np.array([[along_x @ along_x, along_x @ along_y], [along_x @ along_y, along_y @ along_y]])
    second = -np.array([[xx, xy], [xy, yy]]) @ normal / length
    return np.asarray(np.sort(np.linalg.eigvals(np.linalg.solve(first, second)).real)[::-1])
