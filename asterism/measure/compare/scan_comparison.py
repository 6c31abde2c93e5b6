"""Distances of a scan from a shape, after registration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.compare.fitted_size import FittedSize, fitted_size
from asterism.measure.compare.nearest import NearestOnSurface
from asterism.measure.compare.registration import SPREAD, Pose, distinct_poses, register
from asterism.measure.compare.scan import Scan
from asterism.pattern.geometry.diameter import diameter
from asterism.results.records.comparison import ScanDistancesRecord
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import surface_triangle_areas

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


def compare_scan(shape: Shape, scan: Scan, trim: float = 0.2, seed: int = 0) -> ScanComparison:
    """Register a scan with a shape, and measure the distances.

    Parameters
    ----------
    trim : largest part of the points that does not belong to the sheet.
    """
    poses = _laid(shape, scan, trim, seed)
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


def _laid(shape: Shape, scan: Scan, trim: float, seed: int) -> list[Pose]:
    """Poses of the scan on the shape, the best first."""
    surface = shape.positions, shape.triangles
    # a sheet among many other objects needs more starts
    has_other_objects = trim > 0.3
    poses = register(scan.points, *surface, trim, seed, _REPEATED_EFFORT if has_other_objects else 1)
    if has_other_objects or poses[0].spread_mm < 0.002 * diameter(shape.positions):
        return poses
    more = register(scan.points, *surface, trim, seed + 1, _REPEATED_EFFORT)
    return distinct_poses(sorted([*poses, *more], key=SPREAD))


def _covered(shape: Shape, points: Floats, off_mm: float) -> np.ndarray:
    """(T,) bool, triangles with a point nearer to their centre than point spacing and triangle size."""
    tree = cKDTree(points)
    corners = shape.positions[shape.triangles]
    size = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    some = points[:: max(len(points) // 1000, 1)]
    gap = float(np.quantile(tree.query(some, k=2)[0][:, 1], 0.9))
    distance, _ = tree.query(corners.mean(axis=1))
    return np.asarray(distance <= np.hypot(size + gap, off_mm))
