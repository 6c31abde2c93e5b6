"""Tangents and curvatures of the curve that mesh edges approximate.

A supported edge may be straight, oblique or curved, but mesh edges are straight. Supports along each straight edge
would fix the gradient at every vertex of a curve, and refinement would not remove this error (Babuska's paradox).
Therefore a vertex with a small turning angle is a point of a smooth curve, with the curvature of the circle through it
and its two neighbours. A vertex with a larger turning angle is a corner, supported along both edges.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats, Ints


@dataclass(frozen=True)
class EdgeCurve:
    """The curve at E mesh edges, each directed from its first end to its second.

    Attributes
    ----------
    vertices : (E, 2) vertices of the edges.
    ends : (E, 2, 2) mm, their positions.
    tangents : (E, 2, 2) unit tangents of the curve at both ends.
    curvatures : (E, 2) per mm, at both ends; positive if the curve turns left.
    """

    vertices: Ints
    ends: Floats
    tangents: Floats
    curvatures: Floats


def left(vectors: Floats) -> Floats:
    """(..., 2) vectors rotated by 90 degrees to the left."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def edge_curve(mesh: MeshTri, facets: Ints, corner_deg: float) -> EdgeCurve:
    """The curve through mesh edges. On the boundary, unsupported boundary edges count as neighbours too.

    Parameters
    ----------
    mesh : mesh of scikit-fem.
    facets : (E,) numbers of its edges.
    corner_deg : deg, turning angle above which a vertex is a corner.

    Examples
    --------
    The corners of a square are corners, so its edges are straight:

    >>> mesh = MeshTri()
    >>> bool(edge_curve(mesh, mesh.boundary_facets(), 30.0).curvatures.any())
    False
    """
    points = mesh.p.T
    pairs = mesh.facets[:, facets].T
    outer = mesh.f2t[1, facets] < 0
    rim = _neighbours(mesh.facets[:, mesh.boundary_facets()].T)
    line = _neighbours(pairs)
    bends = np.zeros((len(facets), 2))
    for row, (pair, on_rim) in enumerate(zip(pairs, outer, strict=True)):
        neighbours = rim if on_rim else line
        at_ends = [_bend(points, neighbours, int(pair[1 - end]), int(pair[end]), corner_deg) for end in (0, 1)]
        # at the first end the curvature is measured in the opposite direction of the edge
        first, second = (None if at_ends[0] is None else -at_ends[0]), at_ends[1]
        bends[row, 0] = first if first is not None else second or 0.0
        bends[row, 1] = second if second is not None else first or 0.0
    ends = points[pairs]
    chord = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    bends[np.abs(bends * length) < 1e-9] = 0.0
    half = np.arcsin(np.clip(0.5 * bends * length, -1.0, 1.0)) * np.array([-1.0, 1.0])
    direction = (chord / length)[:, None]
    tangents = np.cos(half)[..., None] * direction + np.sin(half)[..., None] * left(direction)
    return EdgeCurve(pairs, ends, tangents, bends)


def _neighbours(pairs: Ints) -> dict[int, list[int]]:
    """The vertices connected to each vertex by an edge."""
    neighbours: dict[int, list[int]] = defaultdict(list)
    for a, b in pairs.tolist():
        neighbours[a].append(b)
        neighbours[b].append(a)
    return neighbours


def _bend(points: Floats, neighbours: dict[int, list[int]], start: int, vertex: int, corner_deg: float) -> float | None:
    """Curvature of the circle through `start`, `vertex` and the next vertex; None at an end or a corner."""
    following = [number for number in neighbours[vertex] if number != start]
    if len(following) != 1:
        return None
    p, q, r = points[start], points[vertex], points[following[0]]
    u, v, w = q - p, r - q, r - p
    cross, dot = u[0] * v[1] - u[1] * v[0], u @ v
    if abs(np.degrees(np.arctan2(cross, dot))) > corner_deg:
        return None
    return float(2.0 * cross / np.sqrt((u @ u) * (v @ v) * (w @ w)))
