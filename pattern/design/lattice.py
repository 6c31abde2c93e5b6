"""Where stars may stand, and which way their arms point."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from pattern.design.errors import DesignError
from pattern.design.section import Number, Point, Section, Whole
from pattern.geometry.arrays import Floats, Ints

DEFAULT_SPACING = 10 * np.sqrt(3.0)
# along which a grid that refines the lattice has its lines, in its own coordinates, counterclockwise
DIRECTIONS = np.array([[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]])


class Lattice(Section):
    """The lattice of star centres and the arms of one star.

    Attributes
    ----------
    kind : `triangular` has neighbours at 30, 90, ... 330 deg, `square` at 0, 90, 180, 270 deg;
        `custom` is spanned by `vectors_mm`.
    spacing_mm : distance of nearest neighbours; follows from `vectors_mm` if those are given.
    origin_mm : place of one star.
    arms : arms of a star, equally spaced.
    orientation_deg : turns all stars counterclockwise; at 0 the first arm points to -90 deg.
    """

    kind: Literal["triangular", "square", "custom"] = "triangular"
    spacing_mm: Number = Field(float(DEFAULT_SPACING), ge=1, le=500)
    vectors_mm: tuple[Point, Point] | None = None
    origin_mm: Point = (0.0, 0.0)
    arms: Whole = Field(3, ge=3, le=8)
    orientation_deg: Number = Field(0.0, ge=-360, le=360)

    @model_validator(mode="after")
    def _one_description(self) -> Lattice:
        if self.kind == "custom" and self.vectors_mm is None:
            raise DesignError("vectors_mm", 'is missing: kind = "custom" needs two of them')
        if self.kind != "custom" and self.vectors_mm is not None:
            raise DesignError("vectors_mm", f'goes with kind = "custom", not with "{self.kind}"')
        if self.vectors_mm is None:
            return self
        basis = np.asarray(self.vectors_mm)
        if not np.all(np.linalg.norm(basis, axis=1) <= 1000):
            raise DesignError("vectors_mm", "must be at most 1000 mm long", self.vectors_mm)
        if abs(np.linalg.det(basis)) < 1:
            raise DesignError("vectors_mm", "must span at least 1 mm2, not a line", self.vectors_mm)
        shortest = float(np.linalg.norm(_reduced(basis), axis=1).min())
        if shortest < 1:
            raise DesignError("vectors_mm", "must leave at least 1 mm between stars", self.vectors_mm)
        if "spacing_mm" in self.model_fields_set and not np.isclose(self.spacing_mm, shortest, rtol=1e-6):
            raise DesignError("spacing_mm", f"follows from vectors_mm ({shortest:g}), leave it out", self.spacing_mm)
        object.__setattr__(self, "spacing_mm", shortest)  # frozen for users, not for its own making
        return self

    @property
    def vectors(self) -> Floats:
        """(2, 2) mm, rows: the shortest two that span the lattice, the second 60 to 90 degrees left of the first."""
        if self.vectors_mm is not None:
            return _reduced(np.asarray(self.vectors_mm))
        if self.kind == "square":
            return self.spacing_mm * np.eye(2)
        return self.spacing_mm * np.array([[np.sqrt(0.75), 0.5], [0.0, 1.0]])

    @property
    def arm_directions(self) -> Floats:
        """(arms, 2) unit vectors, counterclockwise."""
        angle = np.radians(self.orientation_deg - 90 + 360 / self.arms * np.arange(self.arms))
        return np.column_stack([np.cos(angle), np.sin(angle)])

    def place(self, cells: Ints) -> Floats:
        """(n, 2) mm, the star centres of the lattice cells (n, 2)."""
        return cells @ self.vectors + np.asarray(self.origin_mm)

    def cells_within(self, low: Floats, high: Floats) -> Ints:
        """(n, 2) every lattice cell whose centre lies in the box from `low` to `high` (mm), and some more."""
        box = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
        corners = (box - np.asarray(self.origin_mm)) @ np.linalg.inv(self.vectors)
        first, last = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0))
        i, j = (np.arange(a, b + 1, dtype=np.int64) for a, b in zip(first, last, strict=True))
        return np.stack(np.meshgrid(i, j, indexing="ij"), axis=-1).reshape(-1, 2)

    def nearest(self, points: Floats) -> Ints:
        """(n, 2) the lattice cell whose centre is nearest to each of the points (n, 2) mm."""
        # triangles of a shortest basis are not obtuse: the nearest centre is one of the four around
        place = (points - np.asarray(self.origin_mm)) @ np.linalg.inv(self.vectors)
        low = np.floor(place)
        corners = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
        centres = corners @ self.vectors
        # their squared distances, but for a part that is the same for all four
        far = (centres**2).sum(axis=1)[:, None] - 2.0 * (centres @ self.vectors.T) @ (place - low).T
        best, least = np.zeros(len(place), dtype=np.int64), far[0]
        for corner in range(1, 4):  # by argmin it takes several times as long
            best[far[corner] < least] = corner
            least = np.minimum(least, far[corner])
        return low.astype(np.int64) + corners.take(best, axis=0)

    def neighbours(self, cells: Ints) -> Ints:
        """(N, 2) pairs of rows of `cells` that are no further apart than the longer vector of the shortest basis.

        The second is on the right, or straight above: the same pairs whatever the basis.
        """
        offsets = np.array([[i, j] for i in range(-2, 3) for j in range(-2, 3)])
        steps = offsets @ self.vectors
        ahead = np.where(np.abs(steps[:, 0]) > 1e-6, steps[:, 0], steps[:, 1]) > 1e-6
        offsets, distance = offsets[ahead], np.linalg.norm(steps[ahead], axis=1)
        reach = np.linalg.norm(self.vectors, axis=1).max()
        row = {(int(i), int(j)): k for k, (i, j) in enumerate(cells)}
        pairs = [
            (k, row[other])
            for (i, j), k in row.items()
            for di, dj in offsets[distance <= reach * (1 + 1e-6)]
            if (other := (i + int(di), j + int(dj))) in row
        ]
        return np.array(sorted(pairs), dtype=np.int64).reshape(-1, 2)


def _reduced(basis: Floats) -> Floats:
    """The shortest basis of a plane lattice (Lagrange), so that neighbours are a step or two away.

    At most 90 degrees apart, the second to the left of the first: their difference is the third nearest step.
    """
    a, b = np.asarray(basis, dtype=float)
    while True:
        if a @ a > b @ b:
            a, b = b, a
        steps = np.round(a @ b / (a @ a))
        shorter = b - steps * a
        # halfway between two steps, rounding would go to and fro for ever
        if shorter @ shorter >= (1.0 - 1e-12) * (b @ b):
            break
        b = shorter
    if a @ b < -1e-9 * (a @ a):
        b = -b
    return np.array([a, b] if np.linalg.det([a, b]) > 0 else [b, a])
