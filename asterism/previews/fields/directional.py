"""Stars that are not the same in all directions: what they make of a shell's bending (`homogenize.law.anisotropy`).

Cells are asked at their natural curvature, where directions differ most; flat ones hardly differ, and sheets, as caps
mostly, are in between. `anisotropy_share` of the difference counts.
"""

from __future__ import annotations

import numpy as np

from homogenize.law.anisotropy import (
    BENDING_COLUMNS,
    ISOTROPIC_PLATE,
    MOMENT_COLUMNS,
    SPHERICAL,
    natural_curvatures,
    voigt_matrices,
)
from pattern.geometry.arrays import Floats

# the strongest direction is sought on both sides of the best one so far: in steps of 15 degrees, then ever closer
ANGLE_STEPS: Floats = np.linspace(-1.0, 1.0, 13)
ANGLE_REFINEMENT, ANGLE_REFINEMENTS = 6.0, 4


def tensors(kappa: Floats, anisotropy: Floats) -> tuple[Floats, Floats]:
    """Q (..., 3, 3) and m (..., 3), 1/mm, for the mean natural curvature kappa (...) and K numbers (..., K)."""
    q = ISOTROPIC_PLATE + voigt_matrices(anisotropy[..., BENDING_COLUMNS])
    return q, kappa[..., None] * SPHERICAL + anisotropy[..., MOMENT_COLUMNS]


def with_bending_tensor(stiffness: Floats, bending: Floats, q: Floats) -> Floats:
    """(..., 6, 6) with the bending stiffness `bending Q`, (...) N mm, in place of an isotropic one."""
    found = stiffness.copy()
    found[..., 3:, 3:] = bending[..., None, None] * q
    return found


def rest_curvature(lam: Floats, q: Floats, m: Floats) -> Floats:
    """(..., 3) curvature at rest (11, 22, 12), `-lam^2 Q^-1 m`, of a sheet that contracts by lam (...)."""
    voigt = np.linalg.solve(q, m[..., None])[..., 0]
    return np.asarray(-(lam**2)[..., None] * voigt * np.array([1.0, 1.0, 0.5]))


def strongest(kappa: Floats, anisotropy: Floats) -> Floats:
    """(n,) 1/mm, natural curvature of the tube that gains most; kappa (n,) where directions do not differ, K = 0."""
    if anisotropy.shape[-1] == 0:
        return kappa
    q, m = tensors(kappa, anisotropy)
    best, half = np.zeros((len(kappa), 1)), 0.5 * np.pi
    for _ in range(ANGLE_REFINEMENTS):
        tried = best + half * ANGLE_STEPS
        chosen = natural_curvatures(q, m, tried)[1].argmax(axis=-1)[:, None]
        best, half = np.take_along_axis(tried, chosen, axis=-1), half / ANGLE_REFINEMENT
    return np.asarray(natural_curvatures(q, m, best)[0][:, 0])
