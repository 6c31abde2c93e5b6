"""The directions in which a cell is rolled, and what the law leaves out of them.

The law holds means over directions, and the part of the energy that varies as cos 6 phi, with phi from the print's y
axis. With threefold symmetry the rest is the part with sin 6 phi. It vanishes if arms and lattice lines lie at
multiples of 30 degrees, and is left out otherwise. Without threefold symmetry there are parts of lower order in phi,
usually larger ones. Of these the law holds what is quadratic in the curvature (`homogenize.law.anisotropy`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.lattice import Lattice

# a sixfold function has its extremes at the first and the last
THREEFOLD_ANGLES_RAD = (0.0, np.pi / 12, np.pi / 6)
# their mean is the mean over all directions, for functions with up to five periods in half a turn
ALL_ANGLES_RAD = tuple(np.pi / 6 * k for k in range(6))
# of lattice coordinates, and of angles over 30 degrees
LATTICE_ANGLE_TOLERANCE = 1e-6
# natural curvature times spacing, below which energies of two directions differ by rounding only
MIN_RESOLVED_CURL = 0.03


def tube_angles(lattice: Lattice) -> tuple[float, ...]:
    """Angles (rad) of the tubes that the law of such stars needs."""
    return THREEFOLD_ANGLES_RAD if is_threefold(lattice) else ALL_ANGLES_RAD


def averaged_directions(tubes: Sequence[object] | Floats) -> list[int]:
    """Indices of the directions whose mean the law holds."""
    return list(range(len(ALL_ANGLES_RAD))) if covers_all_directions(tubes) else [0, -1]


def covers_all_directions(tubes: Sequence[object] | Floats) -> bool:
    """Whether these tubes are those of stars without threefold symmetry."""
    return len(tubes) == len(ALL_ANGLES_RAD)


def is_threefold(lattice: Lattice) -> bool:
    """Whether lattice and star repeat after a third of a turn."""
    vectors = np.asarray(lattice.vectors)
    turn = np.array([[-0.5, np.sqrt(0.75)], [-np.sqrt(0.75), -0.5]])
    steps = vectors @ turn @ np.linalg.inv(vectors)
    return lattice.arms % 3 == 0 and bool(np.abs(steps - np.round(steps)).max() < LATTICE_ANGLE_TOLERANCE)


def curvature_misfit(curvatures: Sequence[float] | Floats) -> float:
    """Largest distance of natural curvatures from their mean and sixfold part, over their mean.

    Parameters
    ----------
    curvatures : at `THREEFOLD_ANGLES_RAD`.
    """
    measured = np.asarray(curvatures, dtype=float)
    mean, sixfold = 0.5 * (measured[0] + measured[-1]), 0.5 * (measured[0] - measured[-1])
    return float(np.abs(measured - mean - sixfold * np.linspace(1.0, -1.0, len(measured))).max() / abs(mean))


def omitted_anisotropy(lattice: Lattice) -> str | None:
    """What the law of such stars leaves out, in one line; None if it is complete."""
    if not is_threefold(lattice):
        return "the stars curl and bend differently in each direction, which previews model in part"
    lines = np.vstack([np.asarray(lattice.arm_directions)[:1], np.asarray(lattice.vectors)[:1]])
    angle = np.degrees(np.arctan2(lines[:, 1], lines[:, 0])) / 30.0
    if np.abs(angle - np.round(angle)).max() < LATTICE_ANGLE_TOLERANCE:
        return None
    return "turned stars may roll about any axis, and the law has multiples of 30 degrees only"
