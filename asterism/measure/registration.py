"""Registration of a scan with a shape: many starts, then iterated closest points without the farthest ones.

An outline is registered with a silhouette by the first of these steps, in the plane. The motion is a rotation and a
shift, without reflection and scale: a mirrored shape is another shape.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from operator import attrgetter

import numpy as np
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.scan import surface_samples
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.shape.surface import NearestOnSurface

# key that sorts poses, the best first
SPREAD = attrgetter("spread_mm")


@dataclass(frozen=True)
class Pose:
    """The pose of a scan: `points @ rotation.T + shift` lies on the shape."""

    rotation: Floats  # (d, d), proper; d is 3, or 2 in the plane
    shift: Floats  # (d,) mm
    spread_mm: float  # rms distance of the nearest part `1 - trim` of the points

    def __call__(self, points: Floats) -> Floats:
        """(n, d) points of the scan in this pose."""
        return points @ self.rotation.T + self.shift


class _Target:
    """Samples (m, 3) of the shape with their normals and a search tree."""

    def __init__(self, surface: NearestOnSurface, count: int, rng: np.random.Generator) -> None:
        self.places, which = surface_samples(surface.vertices, surface.triangles, count, rng)
        self.normals, self.tree = surface.normals[which], cKDTree(self.places)
        self.spacing_mm = float(np.median(self.tree.query(self.places[:500], k=2)[0][:, 1]))


def register(
    points: Floats, vertices: Floats, triangles: Ints, trim: float = 0.2, seed: int = 0, effort: int = 1
) -> list[Pose]:
    """Poses of a scan on a surface, the best first, each at least 15 degrees from the others.

    `points`: (n, 3) mm, points of the scan, which shows the whole shape or a part; `vertices`, `triangles`: (V, 3) mm
    and (T, 3) of the shape; `trim`: largest part of the points that does not belong to the shape; `effort`: factor of
    the number of starts.

    Chetverikov, Stepanov and Krsek 2005 (trimmed ICP); Chen and Medioni 1992 (point to plane).
    """
    rng = np.random.default_rng(seed)
    surface = NearestOnSurface(vertices, triangles)
    coarse_target, target = (_Target(surface, count, rng) for count in (2000, 15_000))
    few, some, many = (
        points[rng.choice(len(points), min(len(points), count), replace=False)] for count in (150, 600, 3000)
    )
    # starts of the first stage with random rotations
    starts = _starts(points, coarse_target, effort * 200, rng)
    coarse = partial(closest_points, few, target=coarse_target.places, tree=coarse_target.tree, trim=trim)
    first = sorted((coarse(start, steps=4) for start in starts), key=SPREAD)[: effort * 50]
    best = distinct_poses([coarse(pose, steps=12) for pose in first])[: effort * 8]
    middle = sorted((_refine(some, pose, target, trim, 25) for pose in best), key=SPREAD)
    fine = distinct_poses(middle)[:4]
    # a scan that is further off than this part of the shape's diameter has no pose worth its last steps
    if middle[0].spread_mm < 0.05 * diameter(vertices):
        fine = [_refine(many, pose, target, trim, 60) for pose in fine]
    return distinct_poses(
        [replace(pose, spread_mm=_trimmed(np.abs(surface(pose(many)).distance), trim)) for pose in fine]
    )


def distinct_poses(poses: list[Pose]) -> list[Pose]:
    """Poses, the best first, whose rotation differs from that of all better poses by 15 degrees."""
    distinct: list[Pose] = []
    for pose in sorted(poses, key=SPREAD):
        cosines = [(np.trace(pose.rotation.T @ other.rotation) - 1) / 2 for other in distinct]
        if all(cosine < np.cos(np.deg2rad(15.0)) for cosine in cosines):
            distinct.append(pose)
    return distinct


def _trimmed(distance: Floats, trim: float) -> float:
    """Root mean square of the smallest part of the values."""
    kept = np.sort(distance)[: max(int((1 - trim) * len(distance)), 1)]
    return float(np.sqrt(np.mean(kept**2)))


def _starts(points: Floats, target: _Target, count: int, rng: np.random.Generator) -> list[Pose]:
    """Start poses: principal axes in all 24 ways, random rotations about the centre, and matches of single points.

    The matches serve scans of a part, and scans with other objects. A match brings a point of the scan to a sample of
    the shape, aligns their normals, and rotates by a random angle about them.
    """
    centre, goal = np.median(points, axis=0), target.places.mean(axis=0)
    ours, theirs = (_proper(np.linalg.svd(np.cov(p.T))[0]) for p in (points, target.places))
    cube = Rotation.create_group("O").as_matrix()
    turns = [*(theirs @ turn @ ours.T for turn in cube), *Rotation.random(count // 2, random_state=rng).as_matrix()]
    poses = [Pose(turn, goal - turn @ centre, np.inf) for turn in turns]

    some, there = rng.integers(len(points), size=count // 2), rng.integers(len(target.places), size=count // 2)
    # a patch of some mm determines the normal
    neighbours = points[cKDTree(points).query(points[some], k=min(60, len(points)))[1]]
    spread = neighbours - neighbours.mean(axis=1, keepdims=True)
    normals = np.linalg.svd(spread, full_matrices=False)[2][:, 2] * rng.choice([-1.0, 1.0], size=count // 2)[:, None]
    spins = rng.uniform(0, 2 * np.pi, count // 2)
    for point, normal, place, up, spin in zip(
        points[some], normals, target.places[there], target.normals[there], spins, strict=True
    ):
        upright, _ = Rotation.align_vectors(up[None], normal[None])
        turn = (Rotation.from_rotvec(spin * up) * upright).as_matrix()
        poses.append(Pose(turn, place - turn @ point, np.inf))
    return poses


def _proper(axes: Floats) -> Floats:
    return axes @ np.diag([1.0, 1.0, np.linalg.det(axes)])


def closest_points(points: Floats, pose: Pose, target: Floats, tree: cKDTree, trim: float, steps: int) -> Pose:
    """A few steps of point-to-point registration with a target (m, d) and its search tree."""
    for _ in range(steps):
        distance, index = tree.query(pose(points))
        near = distance <= np.sort(distance)[int((1 - max(trim, 0.1)) * (len(distance) - 1))]
        rotation, shift = rigid_fit(points[near], target[index[near]])
        pose = Pose(rotation, shift, float(np.sqrt(np.mean(distance[near] ** 2))))
    return pose


def _refine(points: Floats, pose: Pose, target: _Target, trim: float, most: int) -> Pose:
    """Gauss-Newton steps on the distances with Tukey's weights, until the pose converges.

    The distance of a point changes along the normal of the surface; beyond the rim, along the line to the rim.
    """
    rotation, shift, distance = pose.rotation, pose.shift, np.empty(0)
    size = np.linalg.norm(points - points.mean(axis=0), axis=1).max()
    cutoff = 4.685  # Tukey's biweight gives no weight to points beyond so many standard deviations
    reach = 5 * pose.spread_mm + 3 * target.spacing_mm
    for _ in range(most):
        placed = points @ rotation.T + shift
        # far points have no weight, and the search for their nearest points would take most of the time
        length, index = target.tree.query(placed, distance_upper_bound=reach)
        near = np.isfinite(length)
        index, length = np.where(near, index, 0), np.where(near, length, reach)
        away, direction = placed - target.places[index], target.normals[index]
        along_normal = np.einsum("ni,ni->n", away, direction)
        beyond = (np.abs(along_normal) < 0.5 * length) & (length > 3 * target.spacing_mm)
        direction = np.where(beyond[:, None], away / np.maximum(length, 1e-12)[:, None], direction)
        offset = np.where(beyond, length, along_normal)
        distance = np.where(near, np.abs(offset), reach)
        # smallest scale of the distances: errors of the shape's triangles and of the scanner
        scale = max(1.4826 * float(np.quantile(distance, (1 - trim) / 2)), 0.02)
        weight = np.maximum(1 - (distance / (cutoff * scale)) ** 2, 0.0) ** 2 * near
        if np.count_nonzero(weight) < 10:
            return replace(pose, spread_mm=np.inf)
        # the reach shrinks slowly, so that a step does not lose the surface
        reach = max(2 * cutoff * scale, 3 * target.spacing_mm, reach / 2)
        centre = weight @ placed / weight.sum()
        rows = np.concatenate([np.cross(placed - centre, direction) / size, direction], axis=1)
        information = (rows * weight[:, None]).T @ rows
        # flat and round shapes have motions that change no distance: damp them
        information += 1e-4 * np.trace(information) / 6 * np.eye(6)
        step = -np.linalg.solve(information, rows.T @ (weight * offset))
        turn = Rotation.from_rotvec(step[:3] / size).as_matrix()
        rotation, shift = turn @ rotation, turn @ (shift - centre) + centre + step[3:]
        if np.linalg.norm(step) < 1e-4:
            break
    u, _, vt = np.linalg.svd(rotation)
    return Pose(u @ vt, shift, _trimmed(distance, trim))
