"""Distances of a scan from a shape after registration, and the size in which the scan would fit its shape best.

Photogrammetry gives a shape, but its size is only as accurate as the scale that was set.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.compare.nearest import NearestOnSurface
from asterism.measure.compare.registration import Pose, distinct_poses, register
from asterism.measure.compare.scan import Scan
from asterism.pattern.geometry.diameter import diameter
from asterism.results.records.comparison import ScanDistancesRecord
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import surface_triangle_areas

# random points in a half plane: distance of the nearest point from a place on the rim, over the spacing of the points
_INSIDE_SPACINGS = 2.0 * np.sqrt(2.0) / np.pi
# largest distance from the middle of the fabric to the scanned side
_MAX_LIFT_MM = 2.0


@dataclass(frozen=True)
class FittedSize:
    """The size of a scan relative to the size in which it fits its shape best.

    Attributes
    ----------
    ratio : 1.1 if the scan is a tenth too large.
    rms_mm : rms distance from the shape, if the scan is scaled by 1 / `ratio`.
    lifted_rms_mm : rms distance in the scan's own size from a surface parallel to the shape, because a scan shows one
        side of the sheet.
    """

    ratio: float
    rms_mm: float
    lifted_rms_mm: float


def fitted_size(shape: Shape, points: Floats, cut_mm: float) -> FittedSize | None:
    """The size of a scan whose points (n, 3) mm lie in their pose on a shape; None for a scan of a part.

    Gauss-Newton steps on rotation, shift and scale, or lift. The distances run from the scan to the shape, and outwards
    from the rim of the shape to the scan, so that a smaller scan does not fit inside. Points farther than `cut_mm`
    belong to other objects.

    References
    ----------
    Chen and Medioni 1992 (point to plane); Umeyama 1991 (motion with scale).
    """
    surface = NearestOnSurface(shape.positions, shape.triangles)
    rim = _rim(shape.positions, shape.triangles, surface.normals)
    scaled, lifted = (_fit(surface, rim, points, cut_mm, lift) for lift in (False, True))
    if scaled is None:
        return None
    # without a fit in its own size the scan counts as far away
    return FittedSize(1.0 / scaled[0], scaled[1], cut_mm if lifted is None else lifted[1])


def _fit(
    surface: NearestOnSurface, rim: tuple[Floats, Floats], points: Floats, cut_mm: float, lift: bool
) -> tuple[float, float] | None:
    """Scale factor of points (n, 3) mm, or with `lift` the lift of the surface in mm; and the rms distance left."""
    places, outwards = rim
    rng = np.random.default_rng(0)
    some = points[rng.choice(len(points), min(len(points), 3000), replace=False)]
    tree = cKDTree(points)
    inside = _INSIDE_SPACINGS * float(np.median(tree.query(some, k=2)[0][:, 1]))
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    motion, shift, factor, raised = np.eye(3), np.zeros(3), 1.0, 0.0
    for _ in range(30):
        here = surface(laid := some @ motion.T + shift)
        # the rim moves to the scan, so that the search tree of the scan stays valid
        gap, last = tree.query((places - shift) @ motion / factor**2)
        of_sheet, scanned = np.abs(here.distance) <= cut_mm, factor * gap <= cut_mm
        if np.count_nonzero(of_sheet) < 10 or np.mean(scanned) < 0.1:
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
        # flat and round shapes have motions that change no distance: damp them
        information += 1e-6 * np.trace(information) / 7 * np.eye(7)
        step = -np.linalg.solve(information, rows.T @ offset)
        if lift and abs(raised + step[6]) > _MAX_LIFT_MM:
            step[6] = np.copysign(_MAX_LIFT_MM, raised + step[6]) - raised
            step[:6] = -np.linalg.solve(information[:6, :6], rows[:, :6].T @ (offset + step[6] * rows[:, 6]))
        larger = 1.0 if lift else 1.0 + step[6] / size
        turn = larger * Rotation.from_rotvec(step[:3] / size).as_matrix()
        motion, shift = turn @ motion, turn @ (shift - centre) + centre + step[3:6]
        factor *= larger
        raised += float(step[6]) if lift else 0.0
        if np.abs(step[3:]).max() <= 1e-5 * size:
            break
    # a piece without all its rim fits a smooth shape in many sizes
    if not lift and np.mean(scanned) < 0.9:
        return None
    left = surface((some @ motion.T + shift)[of_sheet]).distance - raised
    return raised if lift else factor, float(np.sqrt(np.mean(left**2)))


def _rim(vertices: Floats, triangles: Ints, normals: Floats) -> tuple[Floats, Floats]:
    """Midpoints (r, 3) mm of the boundary edges, and unit vectors (r, 3) in the surface that point outwards."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    single = first[count == 1]
    start, end = vertices[edges[single]].transpose(1, 0, 2)
    outwards = np.cross(end - start, normals[single % len(triangles)])
    return 0.5 * (start + end), outwards / np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-12)


# poses count as equally good up to this factor of the best spread, ...
_EQUAL_SPREAD_FACTOR = 1.1
# ... plus this error of the registration
_EQUAL_SPREAD_MM = 0.02
# factor of the number of starts where the registration is hard
_REPEATED_EFFORT = 3


@dataclass(frozen=True)
class ScanComparison:
    """A scan compared with a shape.

    Attributes
    ----------
    shape : the shape.
    scan : the scan in its own pose.
    points : (n, 3) mm, the scan's points after the motion onto the shape.
    distance : (n,) mm, distance of each point from the shape, positive on its plastic side.
    triangle : (n,) the nearest triangle of the shape.
    used : (n,) bool, points that belong to the sheet; others (a table, clamps) are farther than `cut_mm`.
    covered : (T,) bool, triangles of the shape with points of the scan nearby.
    poses : all poses of the registration, the best first.
    size : the size in which the scan fits best; None for a scan of a part.
    """

    shape: Shape
    scan: Scan
    points: Floats
    distance: Floats
    triangle: Ints
    used: np.ndarray
    cut_mm: float
    covered: np.ndarray
    poses: tuple[Pose, ...]
    size: FittedSize | None

    @property
    def vertex_distance(self) -> Floats:
        """(V,) mm, mean distance of the used points around each vertex; NaN without such points."""
        corners = self.shape.triangles[self.triangle[self.used]]
        count = len(self.shape.positions)
        total = np.bincount(corners.ravel(), np.repeat(self.distance[self.used], 3), minlength=count)
        points = np.bincount(corners.ravel(), minlength=count)
        return np.where(points > 0, total / np.maximum(points, 1), np.nan)

    def distances(self) -> ScanDistancesRecord:
        """The distances in numbers."""
        used, size = np.abs(self.distance[self.used]), diameter(self.shape.positions)
        rms = float(np.sqrt(np.mean(used**2)))
        area = surface_triangle_areas(self.shape.positions, self.shape.triangles)
        own = self.size
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.poses[0].rotation, self.poses[0].shift
        return ScanDistancesRecord(
            scan_triangles=self.scan.triangles,
            scan_vertices=self.scan.vertices,
            rms_mm=rms,
            rms_percent=100 * rms / size,
            median_mm=float(np.median(used)),
            largest_twentieth_above_mm=float(np.quantile(used, 0.95)),
            max_mm=float(used.max()),
            mean_to_plastic_side_mm=float(self.distance[self.used].mean()),
            rms_of_all_points_mm=float(np.sqrt(np.mean(self.distance**2))),
            points=len(self.distance),
            points_left_out_percent=100 * float(np.mean(~self.used)),
            left_out_beyond_mm=self.cut_mm,
            shape_covered_percent=100 * float(area[self.covered].sum() / area.sum()),
            diameter_mm=size,
            best_size=None if own is None else own.ratio,
            rms_percent_at_best_size=None if own is None else 100 * own.rms_mm / size,
            rms_percent_lifted=None if own is None else 100 * own.lifted_rms_mm / size,
            poses_as_good=sum(
                p.spread_mm <= _EQUAL_SPREAD_FACTOR * self.poses[0].spread_mm + _EQUAL_SPREAD_MM for p in self.poses
            ),
            scan_to_shape=matrix.tolist(),
        )


def compare_scan(shape: Shape, scan: Scan, trim: float = 0.2) -> ScanComparison:
    """Register a scan with a shape, and measure the distances; at most a part `trim` of its points are other things."""
    # a sheet among many other objects needs more starts
    effort = _REPEATED_EFFORT if trim > 0.3 else 1
    poses = register(scan.points, shape.positions, shape.triangles, trim, 0, effort)
    if effort == 1 and poses[0].spread_mm >= 0.002 * diameter(shape.positions):
        poses += register(scan.points, shape.positions, shape.triangles, trim, 1, _REPEATED_EFFORT)
        poses = distinct_poses(poses)
    points = poses[0](scan.points)
    nearest = NearestOnSurface(shape.positions, shape.triangles)(points)
    distance = np.abs(nearest.distance)
    scatter = 1.4826 * float(np.quantile(distance, (1 - trim) / 2))
    # points nearer than a part of the diameter belong to the sheet in any case
    cut = max(5 * scatter, 0.03 * diameter(shape.positions))
    used = distance <= cut
    covered, size = _covered(shape, points[used], 5 * scatter), fitted_size(shape, points, cut)
    return ScanComparison(
        shape, scan, points, nearest.distance, nearest.triangle, used, cut, covered, tuple(poses), size
    )


def _covered(shape: Shape, points: Floats, off_mm: float) -> np.ndarray:
    """(T,) bool, triangles with a point nearer to their centre than point spacing and triangle size."""
    tree = cKDTree(points)
    corners = shape.positions[shape.triangles]
    size = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    some = points[:: max(len(points) // 1000, 1)]
    gap = float(np.quantile(tree.query(some, k=2)[0][:, 1], 0.9))
    distance, _ = tree.query(corners.mean(axis=1))
    return np.asarray(distance <= np.hypot(size + gap, off_mm))
