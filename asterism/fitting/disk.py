"""Triangulated surfaces: a disk, which is one piece with one border and two sides, and triangles over heights."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.equilibrium.errors import Error, one_line
from asterism.pattern.geometry.normals import triangle_normals
from asterism.pattern.geometry.planar import clusters
from asterism.shape.surface import angle_sums, border_edges, directed_edges, laplacian


class TargetError(Error, ValueError):
    """A surface cannot be a target; the message is one line that begins with the name of the target."""

    def __init__(self, target: str | Path, problem: str) -> None:
        super().__init__(one_line(f"{target}: {problem}"))


def place_text(place: Floats, decimals: int = 1) -> str:
    """A place (3,) in mm, for messages."""
    return "(" + ", ".join(f"{coordinate:.{decimals}f}" for coordinate in place) + ") mm"


@dataclass(frozen=True, eq=False)
class Disk:
    """A triangulated surface that is one disk, with equally oriented triangles; made by `disk_of`."""

    vertices: Floats  # (V, 3) mm
    triangles: Ints  # (T, 3), counterclockwise seen from the side of the normals
    flat: int = 0  # number of triangles without area that were left out

    @cached_property
    def border(self) -> Ints:
        """(B,) vertices of the border in order, with the surface on the left."""
        starts, ends = border_edges(self.triangles).T
        after = dict(zip(starts.tolist(), ends.tolist(), strict=True))
        ring = [int(starts.min())]
        while (vertex := after[ring[-1]]) != ring[0]:
            ring.append(vertex)
        return np.asarray(ring)

    @cached_property
    def inner(self) -> Ints:
        """(I,) vertices that are not on the border, in increasing order."""
        return np.setdiff1d(np.arange(len(self.vertices)), self.border)

    @cached_property
    def angle_sums(self) -> Floats:
        """(V,) rad, sum of the angles around each vertex.

        On the border, pi minus the sum is the integral of the geodesic curvature.
        """
        return angle_sums(self.vertices, self.triangles)

    @cached_property
    def gauss_curvature(self) -> Floats:
        """(I,) rad, integral of the Gauss curvature over the cell of each inner vertex."""
        return np.asarray(2.0 * np.pi - self.angle_sums[self.inner])

    @cached_property
    def laplacian(self) -> sp.csc_array:
        """(V, V) the matrix A of `flatten`: minus the integral of the Laplacian over the cell of each vertex."""
        return laplacian(self.vertices, self.triangles)

    def turned_over(self) -> Disk:
        """The same surface with its normals on the other side."""
        return Disk(self.vertices, np.ascontiguousarray(self.triangles[:, ::-1]))


def disk_of(vertices: Floats, triangles: Ints, name: str) -> Disk:
    """The disk of some triangles, welded and equally oriented.

    `vertices`: (V, 3) mm; `triangles`: (T, 3); `name`: of the target, for messages.

    Raises TargetError: the triangles are no disk: many without area, several pieces, closed, holes, a handle, one side
    only, edges of three triangles, or a border that touches itself.
    """
    vertices, triangles = _welded(vertices, triangles)
    if len(triangles) == 0:
        raise TargetError(name, "holds no triangles: a target is a triangulated surface")
    triangles, flat = _without_flat(vertices, triangles, name)
    edges = np.sort(directed_edges(triangles), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    if count.max() > 2:
        place = vertices[unique[count.argmax()]].mean(axis=0)
        raise TargetError(name, f"{count.max()} triangles share the edge at {place_text(place)}: at most 2 can")
    pieces, piece = connected_components(_graph(unique, len(vertices)), directed=False)
    if pieces > 1:
        share = np.bincount(piece[triangles[:, 0]], minlength=pieces)
        held = f"has {pieces} pieces, the largest with {share.max()} of {len(triangles)} triangles"
        raise TargetError(name, f"{held}: {_gap(vertices, piece, int(share.argmax())) or 'keep one piece'}")
    triangles, parts = _equally_oriented(triangles, name)
    _check_border(vertices, triangles, unique, name)
    if parts > 1:
        raise TargetError(name, f"has {parts} parts that share corners only, no edge: keep one of them")
    return Disk(vertices, triangles, flat)


def _gap(vertices: Floats, piece: Ints, largest: int) -> str:
    """Words on corners of two pieces that nearly coincide; empty if no other piece is near the largest."""
    others = vertices[piece != largest]
    distance = cKDTree(vertices[piece == largest]).query(others)[0]
    # corners of two pieces nearer to each other than this part of the extent were meant to be one
    if distance.min() > 1e-3 * np.ptp(vertices, axis=0).max():
        return ""
    return f"corners are {distance.min():.2g} mm apart at {place_text(others[distance.argmin()])}, weld them"


def _welded(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Vertices in their order, without copies and unused ones, and triangles without those that have a vertex twice."""
    if len(triangles) == 0:
        return vertices, triangles
    used, corners = np.unique(triangles, return_inverse=True)
    # vertices nearer to each other than this part of the extent are one vertex: files store each triangle by itself
    step = 1e-6 * max(float(np.ptp(vertices[used], axis=0).max()), 1e-300)
    # cells of a grid first: any number of vertices may stand at one place
    keys = np.round((vertices[used] - vertices[used].min(axis=0)) / step).astype(np.int64)
    _, first, same = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    near, points = clusters(vertices[used][first[order]], step)
    triangles = near[rank[same.ravel()]][corners.reshape(-1, 3)]
    kept, triangles = np.unique(_proper(triangles), return_inverse=True)
    return points[kept], np.asarray(triangles, dtype=np.int64).reshape(-1, 3)


def _without_flat(vertices: Floats, triangles: Ints, name: str) -> tuple[Ints, int]:
    """The triangles without those that have no area, if these are few, and their number.

    Three corners lie on a line: the middle one becomes a corner of the triangle beyond the edge of the others.
    """
    is_flat = _is_flat(vertices, triangles)
    count = int(np.count_nonzero(is_flat))
    if count == 0:
        return triangles, 0
    is_near = np.isin(triangles, triangles[is_flat]).any(axis=1)
    near = triangles[is_near]
    few = count <= min(max(0.01 * len(triangles), 10), 1000, len(triangles) / 2)
    for _ in range(10 * count if few else 0):
        flat = np.flatnonzero(_is_flat(vertices, near))
        if len(flat) == 0:
            return np.concatenate([triangles[~is_near], near]), count
        corners, near = near[flat[0]], np.delete(near, flat[0], axis=0)
        apart = vertices[np.roll(corners, -1)] - vertices[np.roll(corners, 1)]
        start, middle, end = np.roll(corners, 1 - int(np.linalg.norm(apart, axis=1).argmax()))
        beyond = np.isin(near, [start, end]).sum(axis=1) == 2
        halves = [np.where(near[beyond] == corner, middle, near[beyond]) for corner in (start, end)]
        near = _proper(np.concatenate([near[~beyond], *halves]))
    place = place_text(vertices[triangles[is_flat.argmax()]].mean(axis=0))
    raise TargetError(name, f"{count} of {len(triangles)} triangles have no area, the first at {place}")


def _is_flat(vertices: Floats, triangles: Ints) -> Bools:
    corners = vertices[triangles]
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    area = 0.5 * np.linalg.norm(triangle_normals(vertices, triangles), axis=1)
    # a triangle with less area than this part of its squared longest side has no area
    return np.asarray(area < 1e-7 * longest**2)


def _proper(triangles: Ints) -> Ints:
    """The triangles without those that have a vertex twice."""
    a, b, c = triangles.T
    return triangles[(a != b) & (b != c) & (c != a)]


def _check_border(vertices: Floats, triangles: Ints, edges: Ints, name: str) -> None:
    """Raise TargetError unless the border is one loop and the surface a disk."""
    border = border_edges(triangles)
    if len(border) == 0:
        raise TargetError(name, "is closed: cut it open, a target has one border")
    degree = np.bincount(border.ravel(), minlength=len(vertices))
    if degree.max() > 2:
        raise TargetError(name, f"the border touches itself at {place_text(vertices[degree.argmax()])}")
    ring = np.unique(border)
    loops = connected_components(_graph(border, len(vertices)), directed=False)[0] - (len(vertices) - len(ring))
    if loops > 1:
        holes = loops - 1
        raise TargetError(name, f"has {holes} hole{'s' if holes > 1 else ''}: fill or cut it, a target is one disk")
    if len(vertices) - len(edges) + len(triangles) != 1:
        raise TargetError(name, "has a handle: a target is one disk")


def _equally_oriented(triangles: Ints, name: str) -> tuple[Ints, int]:
    """The triangles, some reversed so that neighbours have the same side, as the first one; and the number of parts.

    The two sides of all triangles are the nodes of a graph, joined across the edges of neighbours: sides of one
    surface are connected. Where both sides of a triangle are, the surface has one side only.
    """
    count = len(triangles)
    edges = directed_edges(triangles)
    key = np.sort(edges, axis=1)
    order = np.lexsort(key.T[::-1])
    same = np.flatnonzero((key[order][1:] == key[order][:-1]).all(axis=1))
    first, second = order[same], order[same + 1]
    # neighbours that run through their common edge in the same direction have opposite sides
    opposite = (edges[first] == edges[second]).all(axis=1)
    one, other = first % count, second % count
    joined = np.column_stack(
        [np.concatenate([one, one + count]), np.concatenate([other + count * opposite, other + count * ~opposite])]
    )
    upper, lower = connected_components(_graph(joined, 2 * count), directed=False)[1].reshape(2, count)
    if upper[0] == lower[0]:
        raise TargetError(name, "has one side only, as a Moebius strip has: a target has two sides")
    parts = len(np.unique(np.minimum(upper, lower)))
    return np.where((upper != upper[0])[:, None], triangles[:, ::-1], triangles), parts


def _graph(edges: Ints, count: int) -> sp.csr_array:
    return sp.coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count)).tocsr()


def height_mesh(heights_mm: Floats, x_mm: Floats, y_mm: Floats) -> tuple[Floats, Ints]:
    """Vertices (V, 3) mm and triangles (T, 3) over a grid.

    `heights_mm`: (m, n), nan where there is no surface; `x_mm`, `y_mm`: (n,) and (m,), increasing.
    """
    number = np.arange(heights_mm.size).reshape(heights_mm.shape)
    corners = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    filled = np.isfinite(heights_mm.ravel())[corners]
    whole, cut = corners[filled.all(axis=1)], filled.sum(axis=1) == 3
    # the three corners in their order
    partial = corners[cut][filled[cut]].reshape(-1, 3)
    triangles = np.concatenate([whole[:, :3], whole[:, [0, 2, 3]], partial])
    grid = np.stack(np.meshgrid(x_mm, y_mm), axis=-1).reshape(-1, 2)
    heights = heights_mm.ravel()
    if not filled.all() and len(triangles):
        is_edge = np.ones(heights_mm.shape, dtype=bool)
        is_edge[1:-1, 1:-1] = False
        step = np.array([np.diff(x_mm).mean(), np.diff(y_mm).mean()])
        grid = _smoothed(grid, triangles, is_edge.ravel(), step)
        heights = _interpolated(_continued(heights_mm), x_mm, y_mm, grid)
    return np.column_stack([grid, np.nan_to_num(heights)]), triangles


def _smoothed(grid: Floats, triangles: Ints, is_edge: Bools, step: Floats) -> Floats:
    """The places (V, 2) with a smooth border half a cell further out, but at the edge of the grid; others follow."""
    border = border_edges(triangles)
    along, beside = _sums(border, len(grid)), np.bincount(border.ravel(), minlength=len(grid))
    moving = (beside == 2) & ~is_edge
    places = grid.copy()
    # even out the steps of the border over some cells; by the two shares the border does not shrink (Taubin, A signal
    # processing approach to fair surface design, 1995)
    for _ in range(10):
        for share in (0.5, -0.53):
            places[moving] += share * (0.5 * (along @ places) - places)[moving]
    # the surface is on the left of its border: it ends between the last height and the next, missing one
    chords = np.zeros_like(places)
    for end in (0, 1):
        np.add.at(chords, border[:, end], places[border[:, 1]] - places[border[:, 0]])
    outwards = np.column_stack([chords[:, 1], -chords[:, 0]])
    outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-300)
    places[moving] += (0.5 * np.abs(outwards * step).max(axis=1, keepdims=True) * outwards)[moving]
    edges = directed_edges(triangles)
    around, count = _sums(edges, len(grid)), np.bincount(edges.ravel(), minlength=len(grid))
    inner = (count > 0) & (beside == 0) & ~is_edge
    # the inner vertices follow
    for _ in range(5):
        places[inner] = (around @ places)[inner] / count[inner, None]
    return places


def _sums(pairs: Ints, size: int) -> sp.csr_array:
    """The matrix that adds, for each vertex, the values of those that it is paired with."""
    both = np.concatenate([pairs, pairs[:, ::-1]])
    return sp.coo_array((np.ones(len(both)), (both[:, 0], both[:, 1])), shape=(size, size)).tocsr()


def _continued(heights: Floats) -> Floats:
    """Heights (m, n) continued in straight lines beyond their border; 0 further away."""
    heights = heights.copy()
    # a cell each
    for _ in range(2):
        around = np.lib.stride_tricks.sliding_window_view(np.pad(heights, 2, constant_values=np.nan), (5, 5))
        steps = ((2, 3), (2, 1), (3, 2), (1, 2))
        guesses = np.stack([2.0 * around[..., i, j] - around[..., 2 * i - 2, 2 * j - 2] for i, j in steps])
        known = np.isfinite(guesses)
        mean = np.where(known, guesses, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        heights = np.where(np.isfinite(heights) | ~known.any(axis=0), heights, mean)
    return np.nan_to_num(heights)


def _interpolated(heights: Floats, x: Floats, y: Floats, places: Floats) -> Floats:
    """(V,) heights at places (V, 2)."""
    from scipy.interpolate import RegularGridInterpolator

    inside = np.clip(places, [x[0], y[0]], [x[-1], y[-1]])
    return np.asarray(RegularGridInterpolator((y, x), heights)(inside[:, ::-1]))
