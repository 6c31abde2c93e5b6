"""The isotropic plane stiffness nearest to a given one: the mean of it over all turns."""

from __future__ import annotations

import numpy as np

from pattern.geometry.arrays import Floats

# Voigt stiffnesses as matrices of the orthonormal basis (11, 22, sqrt 2 x 12), in which turns keep their size
KELVIN_FACTORS = np.array([1.0, 1.0, np.sqrt(2.0)])


def isotropic_constants(stiffness: Floats) -> tuple[float, float]:
    """The constants (11 and 12) of the isotropic tensor nearest to a Voigt matrix (3, 3) of (11, 22, 2 x 12)."""
    a = np.asarray(stiffness)
    one = (3 * a[0, 0] + 3 * a[1, 1] + 2 * a[0, 1] + 4 * a[2, 2]) / 8
    two = (a[0, 0] + a[1, 1] + 6 * a[0, 1] - 4 * a[2, 2]) / 8
    return float(one), float(two)


def distance_from_isotropy(stiffness: Floats) -> float:
    """Distance of a Voigt matrix (3, 3) from that isotropic tensor, over its own size (Frobenius norms)."""
    one, two = isotropic_constants(stiffness)
    nearest = np.array([[one, two, 0.0], [two, one, 0.0], [0.0, 0.0, 0.5 * (one - two)]])
    scale = np.outer(KELVIN_FACTORS, KELVIN_FACTORS)
    return float(np.linalg.norm(scale * (stiffness - nearest)) / np.linalg.norm(scale * stiffness))
