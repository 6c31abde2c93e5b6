"""The isotropic plane stiffness nearest to a given one: its mean over all rotations."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats

# Kelvin notation (11, 22, sqrt 2 x 12): rotations keep the norm of a stiffness
KELVIN_FACTORS = np.array([1.0, 1.0, np.sqrt(2.0)])


def isotropic_constants(stiffness: Floats) -> tuple[float, float]:
    """Constants A11 and A12 of the isotropic tensor nearest to a Voigt stiffness (3, 3).

    Examples
    --------
    >>> isotropic_constants(np.array([[4.0, 1.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 1.5]]))
    (4.0, 1.0)
    """
    a = np.asarray(stiffness)
    one = (3 * a[0, 0] + 3 * a[1, 1] + 2 * a[0, 1] + 4 * a[2, 2]) / 8
    two = (a[0, 0] + a[1, 1] + 6 * a[0, 1] - 4 * a[2, 2]) / 8
    return float(one), float(two)


def distance_from_isotropy(stiffness: Floats) -> float:
    """Distance of a Voigt stiffness (3, 3) from the nearest isotropic one, over its own norm (Frobenius)."""
    one, two = isotropic_constants(stiffness)
    nearest = np.array([[one, two, 0.0], [two, one, 0.0], [0.0, 0.0, 0.5 * (one - two)]])
    scale = np.outer(KELVIN_FACTORS, KELVIN_FACTORS)
    return float(np.linalg.norm(scale * (stiffness - nearest)) / np.linalg.norm(scale * stiffness))
