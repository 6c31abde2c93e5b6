"""Tangents and curvatures of the line that mesh edges approximate.

A held edge may be straight, oblique or curved; the mesh has straight edges only. If the sheet were held along each of
them, its gradient would be fixed at every vertex of a curve, and refining the mesh would not help (Babuska's paradox).
So a vertex where the line turns by little is a point of a smooth curve, whose circle passes through it and its two
neighbours. Where it turns by more there is a corner, held along both edges.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from skfem import MeshTri

from fem.elements.tabulation import Floats, Ints


@dataclass(frozen=True)
class EdgeCurve:
    """Of E mesh edges, each walked from its first end to its second.

    Attributes
    ----------
    vertices : (E, 2).
    ends : (E, 2, 2) mm.
    tangents : (E, 2, 2) unit tangents of the curve at both ends.
    curvatures : (E, 2) per mm, positive where the curve turns left.
    """

    vertices: Ints
    ends: Floats
    tangents: Floats
    curvatures: Floats

    def along(self, share: float) -> tuple[Floats, Floats]:
        """Points (E, 2) and unit tangents (E, 2) of the curves, `share` of the way; arcs as parabolas on the chord."""
        chord = self.ends[:, 1] - self.ends[:, 0]
        normal = left(chord)
        bend = self.curvatures.mean(axis=1)[:, None]
        points = self.ends[:, 0] + share * chord
        # left of the chord is inside of a curve that turns left
        length = np.linalg.norm(chord, axis=1, keepdims=True)
        points = points - 0.5 * bend * length * share * (1.0 - share) * normal
        tangents = chord - 0.5 * bend * length * (1.0 - 2.0 * share) * normal
        return points, tangents / np.linalg.norm(tangents, axis=1, keepdims=True)


def left(vectors: Floats) -> Floats:
    """(..., 2) turned by 90 degrees to the left."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def edge_curve(mesh: MeshTri, facets: Ints, corner_deg: float) -> EdgeCurve:
    """The curve through mesh edges; on the mesh's rim the whole rim counts, also where it is not held.

    Parameters
    ----------
    mesh : scikit-fem's.
    facets : (E,) numbers of its edges.
    corner_deg : a line that turns by more than this at a vertex has a corner there.
    """
    points = mesh.p.T
    pairs = mesh.facets[:, facets].T
    outer = mesh.f2t[1, facets] < 0
    rim = _neighbours(mesh.facets[:, mesh.boundary_facets()].T)
    line = _neighbours(pairs)
    bends = np.zeros((len(facets), 2))
    for row, (pair, on_rim) in enumerate(zip(pairs, outer, strict=True)):
        near = rim if on_rim else line
        found = [_bend(points, near, int(pair[1 - end]), int(pair[end]), corner_deg) for end in (0, 1)]
        # walked from its first end: a bend seen on the way to the first end has the other sign
        first, second = (None if found[0] is None else -found[0]), found[1]
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
    near: dict[int, list[int]] = defaultdict(list)
    for a, b in pairs.tolist():
        near[a].append(b)
        near[b].append(a)
    return near


def _bend(points: Floats, near: dict[int, list[int]], start: int, vertex: int, corner_deg: float) -> float | None:
    """Curvature of the circle through `start`, `vertex` and the next one; None at an end or a corner."""
    beyond = [other for other in near[vertex] if other != start]
    if len(beyond) != 1:
        return None
    p, q, r = points[start], points[vertex], points[beyond[0]]
    u, v, w = q - p, r - q, r - p
    cross, dot = u[0] * v[1] - u[1] * v[0], u @ v
    if abs(np.degrees(np.arctan2(cross, dot))) > corner_deg:
        return None
    return float(2.0 * cross / np.sqrt((u @ u) * (v @ v) * (w @ w)))
