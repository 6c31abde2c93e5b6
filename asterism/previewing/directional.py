"""Stars that are not the same in all directions: what they make of a shell's bending (`homogenize.anisotropy`).

Cells are asked at their natural curvature, where directions differ most; flat ones hardly differ, and sheets, as caps
mostly, are in between. SHARE of the difference counts.
"""

from __future__ import annotations

import numpy as np

from homogenize.anisotropy import BENDING, MOMENT, PLATE, ROUND, least, matrices, natural
from pattern.layout import Floats

# nine in ten of 35 sheets are within 14.2 % with none of it, 4.5 with half, 5.6 with all (`benchmarks.other_stars`)
SHARE = 0.5
AROUND: Floats = np.pi / 12 * np.arange(12.0)  # directions that are tried


def tilted(stiffness: Floats, bending: Floats, anisotropy: Floats) -> Floats:
    """(..., 6, 6) with what differs between directions, K numbers (..., K), in an isotropic one, bending (...) N mm."""
    found = stiffness.copy()
    found[..., 3:, 3:] += bending[..., None, None] * matrices(anisotropy[..., BENDING])
    return found


def bends(lam: Floats, kappa: Floats, anisotropy: Floats) -> Floats:
    """(..., 3) curvature at rest (11, 22, 12), `-lam^2 Q^-1 m`, for the mean natural curvature kappa (...)."""
    q, m = _tensors(kappa, anisotropy)
    voigt = np.linalg.solve(q, m[..., None])[..., 0]
    return np.asarray(-(lam**2)[..., None] * voigt * np.array([1.0, 1.0, 0.5]))


def strongest(kappa: Floats, anisotropy: Floats) -> Floats:
    """(n,) 1/mm, natural curvature of the tube that gains most; kappa (n,) where directions do not differ, K = 0."""
    if anisotropy.shape[-1] == 0:
        return kappa
    curvature, gain = natural(*_tensors(kappa, anisotropy), AROUND)
    return np.asarray(np.take_along_axis(curvature, gain.argmax(axis=-1)[..., None], axis=-1)[..., 0])


def softest(anisotropy: Floats) -> Floats:
    """(...) what the softest curvature costs over what it costs in the isotropic plate."""
    return least(PLATE + matrices(anisotropy[..., BENDING]))


def _tensors(kappa: Floats, anisotropy: Floats) -> tuple[Floats, Floats]:
    """Q (..., 3, 3) and m (..., 3)."""
    return PLATE + matrices(anisotropy[..., BENDING]), kappa[..., None] * ROUND + anisotropy[..., MOMENT]
