"""How a sheet differs from one that is the same in all directions: what its cell's tubes say beyond their means.

A lattice that does not repeat after a third of a turn is rolled in six directions. Its sheet is taken to be quadratic
in the curvature c (positive with the plastic outside, per mm of the sheet contracted by lam in all directions),

    psi(c) = D (c . Q c / 2 - m . c),

with the mean bending stiffness D of the tubes. A tube around the direction n has `psi = D (q c^2/2 - m c)` with
`q = Q[n n, n n]` and `m = m[n n]`: it wants the curvature m/q and gains `D m^2/(2 q)`. Q and m are those whose
curvatures and gains are nearest to the cells' (least squares). Tubes say all of a symmetric Q but one number, what
Gaussian curvature costs: `mean_q12`, the mean of Q12 over all axes, is held near Poisson's ratio. That is the same
in all axes; the fit itself may still end in another minimum for a sheet that is printed turned.

A lattice with threefold symmetry has none of this.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import least_squares

from homogenize.cell.tube_directions import is_threefold
from pattern.design.lattice import Lattice
from pattern.geometry.arrays import Floats

# ratio of bending: it shapes no tube, but caps. Small free sheets are nearest to the exact model with 0 to .1
BENDING_POISSON = 0.05
ISOTROPIC_PLATE = np.array(
    [[1.0, BENDING_POISSON, 0.0], [BENDING_POISSON, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - BENDING_POISSON)]]
)
# what any curvature costs in Q, over what it costs in the isotropic plate, at least
MIN_BENDING_RATIO = 0.15
# weights beside the errors of tubes: of the distance from the isotropic plate, and of `mean_q12` from Poisson's ratio
PLATE_WEIGHT, Q12_WEIGHT = 0.02, 1.0
# of a Voigt matrix' entries, as many as the tensor has of them: its norm is the same in all axes
_NORM = np.sqrt([[1.0, 1.0, 2.0], [1.0, 1.0, 2.0], [2.0, 2.0, 4.0]])
VOIGT_ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # of a symmetric Voigt matrix (11, 22, 2 x 12)
BENDING_COLUMNS, MOMENT_COLUMNS = np.split(np.arange(9), [6])  # of `sample_anisotropy`
ANISOTROPY_SIZE = 9
SPHERICAL = np.array([1.0, 1.0, 0.0])
_LOWER = np.tril_indices(3)


def anisotropy_size(lattice: Lattice) -> int:
    """How many numbers a law of such stars has for what differs between directions: COUNT, or none."""
    return 0 if is_threefold(lattice) else ANISOTROPY_SIZE


def sample_anisotropy(sample: dict[str, Any]) -> Floats:
    """(COUNT,) of the sample of a cell that was rolled in six directions (`homogenize.cell.sample.Sample` as plain
    data).

    - BENDING (6): `VOIGT_ENTRIES` of Q less those of PLATE;
    - MOMENT (3): m less the mean natural curvature in all directions, 11, 22, 12, per mm.
    """
    angles, kappa, stiff, hoop, axial = (
        np.array(sample[name], dtype=float)
        for name in ("angles_rad", "natural_curvature", "bending", "natural_hoop", "natural_axial")
    )
    directions = angles + 0.5 * np.pi  # from x
    lam = np.sqrt(hoop * axial).mean()
    q, m = _nearest(directions, kappa * (hoop / lam) ** 2, 0.5 * stiff * kappa**2 / stiff.mean())
    return np.array([*(q[i, j] - ISOTROPIC_PLATE[i, j] for i, j in VOIGT_ENTRIES), *(m - kappa.mean() * SPHERICAL)])


def predicted_curvatures(sample: dict[str, Any], share: float = 1.0) -> Floats:
    """(6,) 1/mm, natural curvatures that a share of `sample_anisotropy` makes of a cell's `natural_curvature`."""
    own = share * sample_anisotropy(sample)
    angles, kappa, hoop, axial = (
        np.array(sample[name], dtype=float)
        for name in ("angles_rad", "natural_curvature", "natural_hoop", "natural_axial")
    )
    m = kappa.mean() * SPHERICAL + own[MOMENT_COLUMNS]
    found = natural_curvatures(ISOTROPIC_PLATE + voigt_matrices(own[BENDING_COLUMNS]), m, angles + 0.5 * np.pi)[0]
    return np.asarray(found * (np.sqrt(hoop * axial).mean() / hoop) ** 2)


def voigt_matrices(entries: Floats) -> Floats:
    """(..., 3, 3) symmetric ones of `VOIGT_ENTRIES` (..., 6)."""
    out = np.empty((*entries.shape[:-1], 3, 3))
    for number, (i, j) in enumerate(VOIGT_ENTRIES):
        out[..., i, j] = out[..., j, i] = entries[..., number]
    return out


def natural_curvatures(q: Floats, m: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """(..., D) 1/mm that tubes around directions (D,) or (..., D), rad from x, want, and gains over D.

    Q (..., 3, 3) and m (..., 3).
    """
    along = _squares(directions)
    wanted = (along @ m[..., None])[..., 0]
    curvature = wanted / ((along @ q) * along).sum(axis=-1)
    return curvature, 0.5 * wanted * curvature


def _nearest(directions: Floats, curvature: Floats, gain: Floats) -> tuple[Floats, Floats]:
    """Q (3, 3) and m (3,) of tubes around directions (D,) that want a curvature (D,) and gain so much over D (D,)."""
    unit, most = float(np.sqrt((curvature**2).mean())), float(np.abs(gain).mean())
    if unit == 0.0 or most == 0.0:
        return ISOTROPIC_PLATE, np.zeros(3)

    def unpacked(x: Floats) -> tuple[Floats, Floats]:
        half = np.zeros((3, 3))
        half[_LOWER] = x[:6]
        return MIN_BENDING_RATIO * ISOTROPIC_PLATE + half @ half.T, unit * x[6:]

    def misses(x: Floats) -> Floats:
        q, m = unpacked(x)
        found, gained = natural_curvatures(q, m, directions)
        from_plate = (PLATE_WEIGHT * _NORM * (q - ISOTROPIC_PLATE)).ravel()
        return np.concatenate(
            [
                (found - curvature) / unit,
                (gained - gain) / most,
                from_plate,
                [Q12_WEIGHT * (mean_q12(q) - BENDING_POISSON)],
            ]
        )

    half = np.linalg.cholesky((1.0 - MIN_BENDING_RATIO) * ISOTROPIC_PLATE)[_LOWER]
    moment = np.linalg.lstsq(_squares(directions), curvature / unit, rcond=None)[0]
    return unpacked(least_squares(misses, np.concatenate([half, moment])).x)


def mean_q12(q: Floats) -> Floats:
    """(...) mean of Q12 over all axes of Q (..., 3, 3); tubes do not feel Q12 + d with Q33 - d/2."""
    return np.asarray((q[..., 0, 0] + q[..., 1, 1] + 6.0 * q[..., 0, 1] - 4.0 * q[..., 2, 2]) / 8.0)


def min_bending_ratio(q: Floats) -> Floats:
    """(...) what the softest curvature costs in Q (..., 3, 3), over what it costs in the isotropic plate."""
    half = np.linalg.inv(np.linalg.cholesky(ISOTROPIC_PLATE))
    return np.asarray(np.linalg.eigvalsh(half @ q @ half.T)[..., 0])


def _squares(directions: Floats) -> Floats:
    """(..., 3) 11, 22 and twice 12 of n n: what a tensor's 11, 22, 12, or Voigt matrices, are multiplied with."""
    c, s = np.cos(directions), np.sin(directions)
    return np.stack([c * c, s * s, 2.0 * c * s], axis=-1)
