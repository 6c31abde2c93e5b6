"""The size that a scan would fit best in: photographs give a shape, and its size only as well as their scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from asterism.measure.compare.nearest import NearestOnSurface
from asterism.shape.shape import Shape
from pattern.geometry.arrays import Floats, Ints

_POINTS, _STEPS, _STAYS = 3000, 30, 1e-5
# of random points in a half plane the nearest to a place on its rim lies inside by this part of the points' own gaps
_INSIDE = 2.0 * np.sqrt(2.0) / np.pi
# part of the rim that must be scanned: a smaller piece fits a smooth shape in many sizes
_WHOLE, _LOST = 0.9, 0.1
_THICK_MM = 2.0  # from the middle of the fabric to what is scanned, at most
_FEWEST = 10  # points that fix a motion


@dataclass(frozen=True)
class FittedSize:
    """Of a scan, over that of the shape that it fits best.

    Attributes
    ----------
    ratio : 1.1 if it is a tenth too large.
    rms_mm : what distance from the shape is left of a scan divided by that.
    lifted_rms_mm : what is left of one of its own size, on a parallel surface: a scan is of one side of the sheet.
    """

    ratio: float
    rms_mm: float
    lifted_rms_mm: float


def fitted_size(shape: Shape, points: Floats, cut_mm: float) -> FittedSize | None:
    """The size of a scan whose points (n, 3) mm are laid on a shape; None if it is of a part of it.

    Gauss and Newton's steps on turn, shift and scale, or lift. Distances count from the scan to the shape, and outwards
    from the shape's rim to the scan, so that a smaller one does not fit inside; what is farther than `cut_mm` belongs
    to other things.

    References
    ----------
    Chen and Medioni 1992 (point to plane); Umeyama 1991 (a scale beside the motion).
    """
    surface = NearestOnSurface(shape.positions, shape.triangles)
    rim = _rim(shape.positions, shape.triangles, surface.normals)
    scaled, lifted = (_fit(surface, rim, points, cut_mm, lift) for lift in (False, True))
    if scaled is None:
        return None
    # who lies nowhere in its own size is far off
    return FittedSize(1.0 / scaled[0], scaled[1], cut_mm if lifted is None else lifted[1])


def _fit(
    surface: NearestOnSurface, rim: tuple[Floats, Floats], points: Floats, cut_mm: float, lift: bool
) -> tuple[float, float] | None:
    """The factor of the points (n, 3) mm, or with `lift` the surface's lift in mm, and what rms distance is left."""
    places, outwards = rim
    rng = np.random.default_rng(0)
    some = points[rng.choice(len(points), min(len(points), _POINTS), replace=False)]
    tree = cKDTree(points)
    inside = _INSIDE * float(np.median(tree.query(some, k=2)[0][:, 1]))
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    motion, shift, factor, raised = np.eye(3), np.zeros(3), 1.0, 0.0
    for _ in range(_STEPS):
        here = surface(laid := some @ motion.T + shift)
        # the rim is looked for where the scan lies, so that its tree stays
        gap, last = tree.query((places - shift) @ motion / factor**2)
        of_sheet, scanned = np.abs(here.distance) <= cut_mm, factor * gap <= cut_mm
        if np.count_nonzero(of_sheet) < _FEWEST or np.mean(scanned) < _LOST:
            return None
        away, side = (laid - here.places)[of_sheet], surface.normals[here.triangle[of_sheet]]
        away -= raised * side
        length = np.linalg.norm(away, axis=1)
        direction = np.concatenate([away / np.maximum(length, 1e-12)[:, None], outwards[scanned]])
        last_laid = points[last[scanned]] @ motion.T + shift
        beyond = np.einsum("ni,ni->n", last_laid - places[scanned], outwards[scanned]) + inside
        ours, offset = np.concatenate([laid[of_sheet], last_laid]), np.concatenate([length, beyond])
        centre = ours.mean(axis=0)
        arm = (ours - centre) / size
        lifts = np.concatenate([-np.einsum("ni,ni->n", direction[: len(side)], side), np.zeros(len(beyond))])
        last_column = lifts if lift else np.einsum("ni,ni->n", arm, direction)
        rows = np.column_stack([np.cross(arm, direction), direction, last_column])
        information = rows.T @ rows
        # flat and round shapes have directions in which nothing changes: stay there
        information += 1e-6 * np.trace(information) / 7 * np.eye(7)
        step = -np.linalg.solve(information, rows.T @ offset)
        if lift and abs(raised + step[6]) > _THICK_MM:
            step[6] = np.copysign(_THICK_MM, raised + step[6]) - raised
            step[:6] = -np.linalg.solve(information[:6, :6], rows[:, :6].T @ (offset + step[6] * rows[:, 6]))
        larger = 1.0 if lift else 1.0 + step[6] / size
        turn = larger * Rotation.from_rotvec(step[:3] / size).as_matrix()
        motion, shift = turn @ motion, turn @ (shift - centre) + centre + step[3:6]
        factor *= larger
        raised += float(step[6]) if lift else 0.0
        if np.abs(step[3:]).max() <= _STAYS * size:
            break
    if not lift and np.mean(scanned) < _WHOLE:
        return None
    left = surface((some @ motion.T + shift)[of_sheet]).distance - raised
    return raised if lift else factor, float(np.sqrt(np.mean(left**2)))


def _rim(vertices: Floats, triangles: Ints, normals: Floats) -> tuple[Floats, Floats]:
    """Middles (r, 3) mm of the edges that only one triangle has, and unit vectors (r, 3) outwards along it."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    single = first[count == 1]
    start, end = vertices[edges[single]].transpose(1, 0, 2)
    outwards = np.cross(end - start, normals[single % len(triangles)])
    return 0.5 * (start + end), outwards / np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-12)
