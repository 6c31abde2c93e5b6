"""Rigid motions that the supports leave to a sheet, and the one of these that brings it closest to another sheet.

An infinitesimal rigid motion moves a point p by v + w x (p - c): three components of the translation v, three of the
rotation w about the centre c. Each supported component of a supported point gives one linear equation in these six
numbers, and the free motions are the null space. Two rules make these motions free for any distance, and not only to
first order:

- Points whose x and y are both supported keep their distance and their horizontal distance. So they keep the difference
  of their heights too.
- Gravity fixes every rotation that turns its direction relative to the sheet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.supports import SupportSamples

RIGID_MOTION_TOLERANCE = 1e-6  # of the supports' size: smaller motions leave them in place
START_TURNS_RAD = (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi)  # starts of a fit about each free axis


@dataclass(frozen=True)
class FreeMotions:
    """Rigid motions that supports leave to a sheet as it lies in space; all six by default."""

    points: Floats = field(default_factory=lambda: np.empty((0, 3)))  # (P, 3) mm, supported points
    # (P, 3) which of their components are supported.
    fixed: NDArray[np.bool_] = field(default_factory=lambda: np.empty((0, 3), dtype=bool))
    gravity: Floats | None = None  # (3,) unit vector of its direction if the sheet has weight

    @cached_property
    def count(self) -> int:
        """Number of independent free motions, from 0 to 6."""
        return int(self.basis(self.points, self._centre).shape[1])

    def basis(self, points: Floats, centre: Floats) -> Floats:
        """(6, k) orthonormal free motions (v, w L) at supported points (P, 3), about a centre (3,); L mm is `size`."""
        if not len(points):
            return np.eye(6)
        _, sizes, motions = np.linalg.svd(self.equations(points, centre))
        return np.asarray(motions[np.count_nonzero(sizes > RIGID_MOTION_TOLERANCE * np.sqrt(len(points))) :].T)

    def fit(self, points: Floats, targets: Floats, weights: Floats | None = None) -> tuple[Floats, Floats]:
        """Rotation (3, 3) and shift (3,) that bring points (n, 3) closest to targets: `x @ rotation.T + shift`.

        Least squares with weights (n,), over the free motions alone.

        A sheet that is fixed at a point turns about it.

        >>> points = np.array([[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        >>> at_a_point = FreeMotions(np.zeros((1, 3)), np.ones((1, 3), dtype=bool))
        >>> rotation, shift = at_a_point.fit(points, points[:, [1, 0, 2]] * [-1.0, 1.0, 1.0])
        >>> bool(np.allclose(rotation, [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
        True
        >>> bool(np.allclose(shift, 0.0))
        True
        """
        if not len(self.points):
            return rigid_fit(points, targets, weights)
        if self.count == 0:
            return np.eye(3), np.zeros(3)
        share = np.full(len(points), 1.0) if weights is None else weights
        problem = _Fit(self, points, targets, share / share.sum())
        return min((problem.solve(*start) for start in self._starts()), key=lambda motion: problem.square(*motion))

    @cached_property
    def size(self) -> float:
        """mm, how far the supports reach from their centre; 1 mm for a single point."""
        reach = float(np.abs(self.points - self._centre).max())
        return reach if reach > 0.0 else 1.0

    @property
    def _centre(self) -> Floats:
        return np.asarray(self.points.mean(axis=0)) if len(self.points) else np.zeros(3)

    def equations(self, points: Floats, centre: Floats) -> Floats:
        """(m, 6) coefficients of the motions (v, w L): a free motion makes all m products zero."""
        rows = np.array([np.hstack([np.eye(3), _turning((point - centre) / self.size)]) for point in points])
        pinned = rows[self.fixed[:, 0] & self.fixed[:, 1], 2]
        turned = np.zeros((0, 6)) if self.gravity is None else np.hstack([np.zeros((3, 3)), _turning(self.gravity)])
        return np.concatenate([rows[self.fixed], pinned[1:] - pinned[:1], turned])

    def misses(self, rotation: Floats, shift: Floats) -> Floats:
        """(m,) mm, by how much a finite motion misses the equations."""
        gaps = self.points @ rotation.T + shift - self.points
        pinned = gaps[self.fixed[:, 0] & self.fixed[:, 1], 2]
        turned = np.zeros(0) if self.gravity is None else self.size * (rotation @ self.gravity - self.gravity)
        return np.concatenate([gaps[self.fixed], pinned[1:] - pinned[:1], turned])

    def _starts(self) -> Iterator[tuple[Floats, Floats]]:
        """Motions from which the best one is sought: quarter turns about each free axis."""
        for twist in self.basis(self.points, self._centre).T:
            length = float(np.linalg.norm(twist[3:]))
            for angle in START_TURNS_RAD if length > RIGID_MOTION_TOLERANCE else START_TURNS_RAD[:1]:
                turn = Rotation.from_rotvec(angle * twist[3:] / max(length, RIGID_MOTION_TOLERANCE)).as_matrix()
                yield turn, self._centre - turn @ self._centre


class _Fit:
    """Least squares over the free motions; points and targets enter by their moments alone."""

    def __init__(self, free: FreeMotions, points: Floats, targets: Floats, weights: Floats) -> None:
        self.free = free
        self.centre, self.goal = weights @ points, weights @ targets
        arms, goals = points - self.centre, targets - self.goal
        self.moments, self.mixed = (weights[:, None] * arms).T @ arms, (weights[:, None] * arms).T @ goals
        self.squares = float(weights @ (arms**2 + goals**2).sum(axis=1))

    def square(self, rotation: Floats, shift: Floats) -> float:
        """mm^2, mean square distance after a motion."""
        gap = rotation @ self.centre + shift - self.goal
        return self.squares - 2.0 * float(np.trace(rotation @ self.mixed)) + float(gap @ gap)

    def solve(self, rotation: Floats, shift: Floats) -> tuple[Floats, Floats]:
        """The local minimum from a start: Newton's method in the null space; each step returns to the supports."""
        free, size = self.free, self.free.size
        for _ in range(60):
            centre = rotation @ self.centre + shift
            points = free.points @ rotation.T + shift
            back = -np.linalg.pinv(free.equations(points, centre), RIGID_MOTION_TOLERANCE) @ free.misses(
                rotation, shift
            )
            basis = free.basis(points, centre)
            overlap = rotation @ self.mixed
            moments = rotation @ self.moments @ rotation.T
            pull = np.array([overlap[i, j] - overlap[j, i] for i, j in ((1, 2), (2, 0), (0, 1))])
            gradient = np.concatenate([centre - self.goal, -pull / size])
            # Gauss-Newton, which has no direction of negative curvature
            stiffness = np.zeros((6, 6))
            stiffness[:3, :3] = np.eye(3)
            stiffness[3:, 3:] = (np.trace(moments) * np.eye(3) - moments) / size**2
            inner = basis.T @ stiffness @ basis
            step = back - basis @ np.linalg.lstsq(inner, basis.T @ (gradient + stiffness @ back), rcond=None)[0]
            turn = Rotation.from_rotvec(step[3:] / size).as_matrix()
            rotation, shift = turn @ rotation, turn @ (shift - centre) + centre + step[:3]
            # relative to the sheet: a smaller step ends a fit
            if float(np.abs(step).max()) < 1e-12 * size:
                break
        return rotation, shift


def free_motions(samples: SupportSamples, positions: Floats, gravity: Sequence[float] | None = None) -> FreeMotions:
    """The free motions of a sheet on its supports.

    Parameters
    ----------
    samples : of its supports.
    positions : (P, 3) mm, where the sheet has these points; they count along the directions in which it slides.
    gravity : its direction, of any length, if the sheet has weight.
    """
    fixed = ~np.isnan(samples.places)
    pull = None if gravity is None else np.asarray(gravity) / np.linalg.norm(gravity)
    return FreeMotions(np.where(fixed, samples.places, positions), fixed, pull)


def _turning(arm: Floats) -> Floats:
    """(3, 3) matrix of w -> w x arm."""
    x, y, z = arm
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def free_rotation_axes(layout: Layout) -> Floats:
    """(k, 3) orthonormal axes of the rotations, with or without a translation, that all supports together leave free.

    All three axes for a free sheet, no axis where the supports determine how it lies. Gravity plays no part.
    """
    printed, places, _ = layout.support_samples
    fixed = ~np.isnan(places)
    if not fixed.any():
        return np.eye(3)
    # where the sheet slides, assume places near those of the print, at heights that no plane has
    x, y = (printed - printed.mean(axis=0)).T / max(float(np.ptp(printed, axis=0).max()), 1e-9)
    assumed = np.column_stack([printed, np.ptp(printed) * (0.07 * x**2 + 0.13 * y**2 + 0.09 * x * y)])
    points = np.where(fixed, places, assumed)
    free = FreeMotions(points, fixed).basis(points, points.mean(axis=0)).T
    _, sizes, axes = np.linalg.svd(free[:, 3:])
    return np.asarray(axes[: np.count_nonzero(sizes > RIGID_MOTION_TOLERANCE)])


def count_free_tilts(layout: Layout) -> int:
    """Number of independent horizontal axes about which the supports let the sheet rotate.

    If it is above 0, only gravity determines how the sheet lies.
    """
    return int(np.linalg.matrix_rank(free_rotation_axes(layout)[:, :2], RIGID_MOTION_TOLERANCE))


def check_weight_is_supported(design: Design, layout: Layout) -> None:
    """Refuse a sheet that falls: its first pins must support it along every axis along which gravity acts.

    Raises `DesignError` if gravity is on, and the sheet is free along x, y or z. The message names the axes.
    """
    if not design.gravity.on:
        return
    if not layout.pins:
        raise DesignError("gravity.on", "needs [[pins]] to support the sheet: a free sheet falls", True)
    first = min(pins.step for pins in layout.pins)
    held = np.array([pins.fixed for pins in layout.pins if pins.step == first]).any(axis=0)
    falls = ~held & (np.abs(design.gravity.direction) > 1e-6 * np.linalg.norm(design.gravity.direction))
    if falls.any():
        along = " and ".join(axis for axis, free in zip("xyz", falls, strict=True) if free)
        problem = f"needs [[pins]] that do not slide along {along}, among the first: the sheet falls"
        raise DesignError("gravity.on", problem, True)
