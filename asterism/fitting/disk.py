"""A triangulated disk: one piece of a surface with one border and two sides."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import breadth_first_order, connected_components
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.fitting.errors import TargetError, place_text
from asterism.pattern.geometry.normals import triangle_normals
from asterism.pattern.geometry.planar import clusters

# vertices nearer to each other than this part of the extent are one vertex: files store each triangle by itself
WELD_SHARE = 1e-6
# a triangle with less area than this part of its squared longest side has no area
MIN_AREA_SHARE = 1e-7
# triangles without area are left out if there are at most so many, and at most this share of all
MAX_FLAT, MAX_FLAT_SHARE = 1000, 0.01
# corners of two pieces nearer to each other than this part of the extent were meant to be one
MAX_GAP_SHARE = 1e-3


@dataclass(frozen=True, eq=False)
class Disk:
    """A triangulated surface that is one disk, with equally oriented triangles; made by `disk_of`.

    Attributes
    ----------
    vertices : (V, 3) mm.
    triangles : (T, 3), counterclockwise seen from the side of the normals.
    flat : number of triangles without area that were left out.
    """

    vertices: Floats
    triangles: Ints
    flat: int = 0

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
    def angles(self) -> Floats:
        """(T, 3) rad, angles at the corners of each triangle."""
        corners = self.vertices[self.triangles]
        ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
        cross = np.linalg.norm(np.cross(ahead, behind), axis=2)
        return np.asarray(np.arctan2(cross, np.einsum("tkc,tkc->tk", ahead, behind)))

    @cached_property
    def angle_sums(self) -> Floats:
        """(V,) rad, sum of the angles around each vertex.

        On the border, pi minus the sum is the integral of the geodesic curvature.
        """
        return np.asarray(np.bincount(self.triangles.ravel(), self.angles.ravel(), len(self.vertices)))

    @cached_property
    def gauss_curvature(self) -> Floats:
        """(I,) rad, integral of the Gauss curvature over the cell of each inner vertex."""
        return np.asarray(2.0 * np.pi - self.angle_sums[self.inner])

    @cached_property
    def laplacian(self) -> sp.csc_array:
        """(V, V) the matrix A of `flatten`: minus the integral of the Laplacian over the cell of each vertex."""
        half, count = 0.5 / np.tan(self.angles), len(self.vertices)
        i, j = np.roll(self.triangles, -1, axis=1).ravel(), np.roll(self.triangles, 1, axis=1).ravel()
        weights = sp.coo_array((half.ravel(), (i, j)), shape=(count, count))
        weights = weights + weights.T
        return sp.csc_array(sp.diags_array(np.asarray(weights.sum(axis=1)).ravel()) - weights)

    def turned_over(self) -> Disk:
        """The same surface with its normals on the other side."""
        return Disk(self.vertices, np.ascontiguousarray(self.triangles[:, ::-1]))


def disk_of(vertices: Floats, triangles: Ints, name: str) -> Disk:
    """The disk of some triangles, welded and equally oriented.

    Parameters
    ----------
    vertices : (V, 3) mm.
    triangles : (T, 3).
    name : of the target, for messages.

    Raises
    ------
    TargetError
        The triangles are no disk: many without area, several pieces, closed, holes, a handle, one side only, edges of
        three triangles, or a border that touches itself.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [9.0, 9.0, 0.0], [0.0, 9.0, 0.0]])
    >>> disk_of(square, np.array([[0, 1, 2], [0, 3, 2]]), "square").border.tolist()
    [0, 1, 2, 3]
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
    triangles = _equally_oriented(triangles, name)
    _check_border(vertices, triangles, unique, name)
    return Disk(vertices, triangles, flat)


def _gap(vertices: Floats, piece: Ints, largest: int) -> str:
    """Words on corners of two pieces that nearly coincide; empty if no other piece is near the largest."""
    others = vertices[piece != largest]
    distance = cKDTree(vertices[piece == largest]).query(others)[0]
    if distance.min() > MAX_GAP_SHARE * np.ptp(vertices, axis=0).max():
        return ""
    return f"corners are {distance.min():.2g} mm apart at {place_text(others[distance.argmin()])}, weld them"


def _welded(vertices: Floats, triangles: Ints) -> tuple[Floats, Ints]:
    """Vertices in their order, without copies and unused ones, and triangles without those that have a vertex twice."""
    if len(triangles) == 0:
        return vertices, triangles
    used, corners = np.unique(triangles, return_inverse=True)
    step = WELD_SHARE * max(float(np.ptp(vertices[used], axis=0).max()), 1e-300)
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
    few = count <= min(max(MAX_FLAT_SHARE * len(triangles), 10), MAX_FLAT, len(triangles) / 2)
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
    return np.asarray(area < MIN_AREA_SHARE * longest**2)


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


def _equally_oriented(triangles: Ints, name: str) -> Ints:
    """The triangles, some of them reversed, so that neighbours have the same side; the first one stays."""
    count = len(triangles)
    edges = directed_edges(triangles)
    owner = np.tile(np.arange(count), 3)
    key = np.sort(edges, axis=1)
    order = np.lexsort(key.T[::-1])
    same = np.flatnonzero((key[order][1:] == key[order][:-1]).all(axis=1))
    first, second = order[same], order[same + 1]
    # neighbours that run through their common edge in the same direction have opposite sides
    opposite = (edges[first] == edges[second]).all(axis=1)
    graph = sp.coo_array((np.ones(len(first)), (owner[first], owner[second])), shape=(count, count)).tocsr()
    visited, before = breadth_first_order(graph, 0, directed=False)
    # each triangle against the one that it was reached from, then against the first one along the chain of these
    low, high = np.minimum(owner[first], owner[second]), np.maximum(owner[first], owner[second])
    pair, where = np.unique(low * count + high, return_index=True)
    child, parent = visited[1:], before[visited[1:]]
    is_reversed = np.zeros(count, dtype=bool)
    asked = np.minimum(child, parent) * count + np.maximum(child, parent)
    is_reversed[child] = opposite[where[np.searchsorted(pair, asked)]]
    above = np.zeros(count, dtype=np.int64)
    above[child] = parent
    while above.any():
        is_reversed ^= is_reversed[above]
        above = above[above]
    if (is_reversed[owner[first]] ^ is_reversed[owner[second]] ^ opposite).any():
        raise TargetError(name, "has one side only, as a Moebius strip has: a target has two sides")
    return np.where(is_reversed[:, None], triangles[:, ::-1], triangles)


def directed_edges(triangles: Ints) -> Ints:
    """(3 T, 2) edges in the direction of their triangles: first edges of all triangles, second ones, third ones."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def border_edges(triangles: Ints) -> Ints:
    """(B, 2) edges of one triangle only, in its direction."""
    edges = directed_edges(triangles)
    _, where, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    return edges[count[where.ravel()] == 1]


def _graph(edges: Ints, count: int) -> sp.csr_array:
    return sp.coo_array((np.ones(len(edges)), (edges[:, 0], edges[:, 1])), shape=(count, count)).tocsr()
