"""The common point group of a star and its lattice, the mirror lines of the sheet, and the directions of its tubes.

The law holds means over directions, and the part of the energy that varies as cos 6 phi, with phi from the print's y
axis. With threefold symmetry the rest is the part with sin 6 phi. It vanishes if arms and lattice lines lie at
multiples of 30 degrees, and is left out otherwise. Without threefold symmetry there are parts of lower order in phi,
usually larger ones, and on fabric with a grain or two stretches. Of these the law holds what is quadratic in strains
and curvatures (`homogenize.law.anisotropy`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS

# a sixfold function has its extremes at the first and the last
THREEFOLD_ANGLES_RAD = (0.0, np.pi / 12, np.pi / 6)
# their mean is the mean over all directions, for functions with up to five periods in half a turn
ALL_ANGLES_RAD = tuple(np.pi / 6 * k for k in range(6))
# natural curvature times spacing, below which energies of two directions differ by rounding only
MIN_RESOLVED_CURL = 0.03


def tube_angles(design: Design) -> tuple[float, ...]:
    """Angles (rad) of the tubes that the law of such stars needs."""
    return ALL_ANGLES_RAD if differs_by_direction(design) else THREEFOLD_ANGLES_RAD


def differs_by_direction(design: Design) -> bool:
    """Whether a sheet of equal stars differs between directions: the fabric does, or star and lattice do."""
    return design.fabric.is_directional or not is_threefold(design.lattice)


def averaged_directions(tubes: Sequence[object] | Floats) -> list[int]:
    """Indices of the directions whose mean the law holds."""
    return list(range(len(ALL_ANGLES_RAD))) if len(tubes) == len(ALL_ANGLES_RAD) else [0, -1]


def is_threefold(lattice: Lattice) -> bool:
    """Whether lattice and star repeat after a third of a turn."""
    turn = np.array([[-0.5, -np.sqrt(0.75)], [np.sqrt(0.75), -0.5]])
    return bool(np.isclose(point_group(lattice), turn, rtol=0.0, atol=POINT_GROUP_TOLERANCE).all(axis=(1, 2)).any())


# of unit vectors, and of lattice coordinates
POINT_GROUP_TOLERANCE = 1e-6
# stars whose arms, up to the spacing long, may come close, as numbers of lattice vectors
NEIGHBOUR_STEPS = np.array([[i, j] for i in range(-3, 4) for j in range(-3, 4) if (i, j) != (0, 0)])
GRADED_OFF_LINES = "cells have graded meshes only if all arms lie on lattice lines and the grid has their symmetry"


def arm_directions(lattice: Lattice) -> Floats:
    """(arms, 2) unit vectors. A star that is turned onto itself has the same ones, digit by digit."""
    sector = 360.0 / lattice.arms
    turn = round(lattice.orientation_deg % sector, 9) % sector
    angle = np.radians(turn - 90.0 + sector * np.arange(lattice.arms))
    return np.column_stack([np.cos(angle), np.sin(angle)])


def point_group(lattice: Lattice) -> Floats:
    """(G, 2, 2) rotations and reflections about a star's centre that map its arms and the lattice onto themselves.

    The identity comes first, then the other rotations, then the reflections.

    >>> [len(point_group(Lattice(arms=arms))) for arms in (3, 4, 5, 6)]
    [6, 4, 2, 12]
    >>> [len(point_group(Lattice(kind="square", arms=4, orientation_deg=turn))) for turn in (0, 45, 10)]
    [8, 8, 4]
    """
    arms, vectors = arm_directions(lattice), np.asarray(lattice.vectors)
    inverse = np.linalg.inv(vectors)
    first = arms[0]
    cos, sin = arms @ first, arms @ np.array([-first[1], first[0]])
    rotations = np.array([[[c, -s], [s, c]] for c, s in zip(cos, sin, strict=True)])
    along = 2.0 * np.outer(first, first) - np.eye(2)  # reflection that keeps the first arm
    candidates = np.concatenate([rotations, rotations @ along])
    steps = vectors @ candidates.transpose(0, 2, 1) @ inverse
    keeps = np.abs(steps - np.rint(steps)).max(axis=(1, 2)) < POINT_GROUP_TOLERANCE
    return np.asarray(candidates[keeps])


def keeps_grid_lines(lattice: Lattice) -> bool:
    """Whether the point group maps the lines of the aligned grid (`GRID_DIRECTIONS`) onto themselves."""
    vectors = np.asarray(lattice.vectors)
    lines = GRID_DIRECTIONS @ vectors
    moved = np.einsum("gij,lj->gli", point_group(lattice), lines)
    distance = np.linalg.norm(moved[:, :, None] - lines, axis=-1).min(axis=-1)
    return bool(distance.max() < POINT_GROUP_TOLERANCE * np.linalg.norm(vectors[0]))


@dataclass(frozen=True)
class MirrorLine:
    """One class of mirror lines of the sheet: all others of the class are images by lattice vectors."""

    point: Floats  # (2,) mm, on the line
    direction: Floats  # (2,) unit vector along it
    length: float  # mm, after which the line repeats
    offset_step: float  # mm, smallest distance of two lines of the class

    @property
    def normal(self) -> Floats:
        """(2,) unit vector."""
        return np.array([-self.direction[1], self.direction[0]])


def mirror_lines(vectors: Floats, group: Floats) -> list[MirrorLine]:
    """All classes of mirror lines of a sheet with these lattice vectors (2, 2) and this point group (G, 2, 2)."""
    steps = NEIGHBOUR_STEPS @ vectors
    tolerance = POINT_GROUP_TOLERANCE * float(np.linalg.norm(vectors[0]))
    lines = []
    for reflection in group[np.linalg.det(group) < 0.0]:
        values, axes = np.linalg.eigh(0.5 * (reflection + reflection.T))
        direction, normal = axes[:, values.argmax()], axes[:, values.argmin()]
        across, along = np.abs(steps @ normal), np.abs(steps @ direction)
        height = float(across[along < tolerance].min())  # shortest lattice vector across the line
        length = float(along[across < tolerance].min())
        step = float(across[across > tolerance].min())
        lines.append(MirrorLine(np.zeros(2), direction, length, step))
        if step > 0.75 * height:  # otherwise a centred lattice shifts the line to the middle
            lines.append(MirrorLine(0.5 * height * normal, direction, length, step))
    return lines


def aligned_lines(lattice: Lattice) -> Ints | None:
    """(arms,) the grid line of each arm, an index into `GRID_DIRECTIONS`; None if the aligned mesh does not fit.

    It fits if all arms lie on such lines, and if the grid has the symmetry of star and lattice. The grid of a square
    lattice has one of its two diagonals only.
    """
    if not keeps_grid_lines(lattice):
        return None
    along = GRID_DIRECTIONS @ np.asarray(lattice.vectors)
    along = along / np.linalg.norm(along, axis=1, keepdims=True)
    match = np.asarray(lattice.arm_directions) @ along.T
    return match.argmax(axis=1) if (match.max(axis=1) > 1.0 - 1e-9).all() else None
