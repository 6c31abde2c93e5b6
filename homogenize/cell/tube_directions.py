"""The directions that a cell is rolled in, and what the law leaves out of them.

The law holds means over directions, and the part of the energy that goes as cos 6 phi, with angles from the print's y
axis. Where lattice and star repeat after a third of a turn, all there is beyond is its sine, which vanishes if arms and
lattice lines lie at multiples of 30 degrees, and is left out elsewhere. Without threefold symmetry there are parts with
fewer periods, usually larger ones: of these the law holds what is quadratic in the curvature
(`homogenize.law.anisotropy`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pattern.design.lattice import Lattice
from pattern.geometry.arrays import Floats

# radians from y: a function of sixfold symmetry has its extremes at the first and the last
THREEFOLD_ANGLES_RAD = (0.0, np.pi / 12, np.pi / 6)
# the mean over these is that over all directions for functions with up to five periods in half a turn
ALL_ANGLES_RAD = tuple(np.pi / 6 * k for k in range(6))
LATTICE_ANGLE_TOLERANCE = 1e-6
# natural curvature times spacing below which the energies of two directions differ by rounding only
MIN_RESOLVED_CURL = 0.03


def tube_angles(lattice: Lattice) -> tuple[float, ...]:
    """Angles of the tubes that a law of such stars needs."""
    return THREEFOLD_ANGLES_RAD if is_threefold(lattice) else ALL_ANGLES_RAD


def averaged_directions(tubes: Sequence[object] | Floats) -> list[int]:
    """Which of the directions, or of what belongs to them, the law takes the mean of."""
    return list(range(len(ALL_ANGLES_RAD))) if covers_all_directions(tubes) else [0, -1]


def covers_all_directions(tubes: Sequence[object] | Floats) -> bool:
    """Whether these, of the cells of a law, are the directions of stars without threefold symmetry."""
    return len(tubes) == len(ALL_ANGLES_RAD)


def is_threefold(lattice: Lattice) -> bool:
    """Whether lattice and star repeat after a third of a turn."""
    vectors = np.asarray(lattice.vectors)
    turn = np.array([[-0.5, np.sqrt(0.75)], [-np.sqrt(0.75), -0.5]])
    steps = vectors @ turn @ np.linalg.inv(vectors)
    return lattice.arms % 3 == 0 and bool(np.abs(steps - np.round(steps)).max() < LATTICE_ANGLE_TOLERANCE)


def curvature_misfit(curvatures: Sequence[float] | Floats) -> float:
    """How far natural curvatures of `THREEFOLD_ANGLES_RAD` are at most from mean and sixfold part, over their mean."""
    found = np.asarray(curvatures, dtype=float)
    mean, sixfold = 0.5 * (found[0] + found[-1]), 0.5 * (found[0] - found[-1])
    return float(np.abs(found - mean - sixfold * np.linspace(1.0, -1.0, len(found))).max() / abs(mean))


def omitted_anisotropy(lattice: Lattice) -> str | None:
    """What the law of such stars leaves out, in one line; None if a smooth sheet of them has no more to it."""
    if not is_threefold(lattice):
        return "stars curl and bend differently in each direction; previews follow most of that"
    lines = np.vstack([np.asarray(lattice.arm_directions)[:1], np.asarray(lattice.vectors)[:1]])
    angle = np.degrees(np.arctan2(lines[:, 1], lines[:, 0])) / 30.0
    if np.abs(angle - np.round(angle)).max() < LATTICE_ANGLE_TOLERANCE:
        return None
    return "stars that are turned may roll about other axes than multiples of 30 degrees; the law has these only"
