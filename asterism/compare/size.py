"""The size that a scan would fit best in: photographs give a shape, and its size only as well as their scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from asterism.compare.nearest import NearestOnSurface
from asterism.shape import Shape
from pattern.layout import Floats, Ints

_POINTS, _STEPS, _STAYS = 3000, 30, 1e-5
# of random points in a half plane the nearest to a place on its rim lies inside by this part of the points' own gaps
_INSIDE = 2.0 * np.sqrt(2.0) / np.pi
# part of the rim that must be scanned: a smaller piece fits a smooth shape in many sizes
_WHOLE = 0.9


@dataclass(frozen=True)
class Size:
    """Of a scan, over that of the shape that it fits best.

    Attributes
    ----------
    ratio : 1.1 if it is a tenth too large.
    rms_mm : what distance from the shape is left of a scan divided by that.
    """

    ratio: float
    rms_mm: float


def fitted_size(shape: Shape, points: Floats, cut_mm: float) -> Size | None:
    """The size of a scan whose points (n, 3) mm are laid on a shape; None if it is of a part of it.

    Gauss and Newton's steps on turn, shift and scale. Distances count from the scan to the shape, and outwards from the
    shape's rim to the scan, so that a smaller one does not fit inside; what is farther than `cut_mm` belongs to other
    things.

    References
    ----------
    Chen and Medioni 1992 (point to plane); Umeyama 1991 (a scale beside the motion).
    """
    surface = NearestOnSurface(shape.positions, shape.triangles)
    rim, outwards = _rim(shape.positions, shape.triangles, surface.normals)
    rng = np.random.default_rng(0)
    some = points[rng.choice(len(points), min(len(points), _POINTS), replace=False)]
    laid, ratio = points, 1.0
    inside = _INSIDE * float(np.median(cKDTree(laid).query(some, k=2)[0][:, 1]))
    size = float(np.linalg.norm(np.ptp(shape.positions, axis=0)))
    for _ in range(_STEPS):
        here = surface(some)
        gap, last = cKDTree(laid).query(rim)
        of_sheet, scanned = np.abs(here.distance) <= cut_mm, gap <= cut_mm
        away = (some - here.places)[of_sheet]
        length = np.linalg.norm(away, axis=1)
        ours = np.concatenate([some[of_sheet], laid[last[scanned]]])
        direction = np.concatenate([away / np.maximum(length, 1e-12)[:, None], outwards[scanned]])
        beyond = np.einsum("ni,ni->n", (laid[last] - rim)[scanned], outwards[scanned])
        offset = np.concatenate([length, beyond + inside])
        centre = ours.mean(axis=0)
        arm = (ours - centre) / size
        rows = np.column_stack([np.cross(arm, direction), direction, np.einsum("ni,ni->n", arm, direction)])
        information = rows.T @ rows
        # flat and round shapes have directions in which nothing changes: stay there
        information += 1e-6 * np.trace(information) / 7 * np.eye(7)
        step = -np.linalg.solve(information, rows.T @ offset)
        turn, larger = Rotation.from_rotvec(step[:3] / size).as_matrix(), 1.0 + step[6] / size
        some, laid = (larger * (one - centre) @ turn.T + centre + step[3:6] for one in (some, laid))
        ratio *= larger
        if abs(larger - 1.0) <= _STAYS:
            break
    if np.mean(scanned) < _WHOLE:
        return None
    left = surface(some[of_sheet]).distance
    return Size(float(1.0 / ratio), float(np.sqrt(np.mean(left**2))))


def _rim(vertices: Floats, triangles: Ints, normals: Floats) -> tuple[Floats, Floats]:
    """Middles (r, 3) mm of the edges that only one triangle has, and unit vectors (r, 3) outwards along it."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    single = first[count == 1]
    start, end = vertices[edges[single]].transpose(1, 0, 2)
    outwards = np.cross(end - start, normals[single % len(triangles)])
    return 0.5 * (start + end), outwards / np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-12)
