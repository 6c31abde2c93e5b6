"""How far a scan is from a shape, after the scan was laid on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.measure.compare.fitted_size import FittedSize, fitted_size
from asterism.measure.compare.nearest import NearestOnSurface
from asterism.measure.compare.registration import SPREAD, Pose, distinct_poses, register
from asterism.measure.compare.scan import Scan
from asterism.results.records.comparison import ScanDistancesRecord
from asterism.shape.diameter import diameter
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import surface_triangle_areas
from pattern.geometry.arrays import Floats, Ints

# poses whose spread is larger than the best one's by less than this are as good
_AS_GOOD = 1.1
_SAME_MM = 0.02  # spreads of a scan without noise are what its registration leaves
# parts of the diameter: with a larger spread a scan of a part may lie elsewhere, and is laid on the shape again with
# this many times as many starts
_UNSURE, _EFFORT = 0.002, 3
# nearer points, in parts of the diameter, are taken for the sheet's: a printed sheet may be that far off
_SHEETS_OWN = 0.03


@dataclass(frozen=True)
class ScanComparison:
    """A scan laid on a shape.

    Attributes
    ----------
    shape : the shape.
    scan : the scan in its own pose.
    points : (n, 3) mm, the scan's points after the motion onto the shape.
    distance : (n,) mm, from the shape, positive on its plastic side.
    triangle : (n,) the nearest triangle of the shape.
    used : (n,) bool, points that belong to the sheet; others (a table, clamps) are farther than `cut_mm`.
    covered : (T,) bool, triangles of the shape that the scan has points near.
    poses : all that were found, the best first.
    size : that it fits best in; None if it is of a part of the shape.
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
        """(V,) mm, mean over the used points around each vertex; NaN where there are none."""
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
            poses_as_good=sum(p.spread_mm <= _AS_GOOD * self.poses[0].spread_mm + _SAME_MM for p in self.poses),
            scan_to_shape=matrix.tolist(),
        )


def compare_scan(shape: Shape, scan: Scan, trim: float = 0.2, seed: int = 0) -> ScanComparison:
    """Lay a scan on a shape and measure.

    Parameters
    ----------
    trim : the part of the scan's points that may not belong to the sheet.
    """
    poses = _laid(shape, scan, trim, seed)
    points = poses[0](scan.points)
    nearest = NearestOnSurface(shape.positions, shape.triangles)(points)
    distance = np.abs(nearest.distance)
    scatter = 1.4826 * float(np.quantile(distance, (1 - trim) / 2))
    cut = max(5 * scatter, _SHEETS_OWN * diameter(shape.positions))
    used = distance <= cut
    return ScanComparison(
        shape,
        scan,
        points,
        nearest.distance,
        nearest.triangle,
        used,
        cut,
        _covered(shape, points[used], 5 * scatter),
        tuple(poses),
        fitted_size(shape, points, cut),
    )


def _laid(shape: Shape, scan: Scan, trim: float, seed: int) -> list[Pose]:
    """The best pose first."""
    surface = shape.positions, shape.triangles
    # among much else the sheet is hard to find
    much_else = trim > 0.3
    poses = register(scan.points, *surface, trim, seed, _EFFORT if much_else else 1)
    if much_else or poses[0].spread_mm < _UNSURE * diameter(shape.positions):
        return poses
    return distinct_poses(sorted([*poses, *register(scan.points, *surface, trim, seed + 1, _EFFORT)], key=SPREAD))


def _covered(shape: Shape, points: Floats, off_mm: float) -> np.ndarray:
    """(T,) bool, triangles with points nearer to their middle than the points' own gaps and the triangle's size."""
    tree = cKDTree(points)
    corners = shape.positions[shape.triangles]
    size = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    some = points[:: max(len(points) // 1000, 1)]
    gap = float(np.quantile(tree.query(some, k=2)[0][:, 1], 0.9))
    distance, _ = tree.query(corners.mean(axis=1))
    return np.asarray(distance <= np.hypot(size + gap, off_mm))
