"""Differences between directions in a sheet without threefold symmetry, or on fabric that has a grain or two stretches.

The cell of such a star is rolled in six directions.

**Metric and membrane.** The squared stretches around and along the tubes are those of one metric G (least squares).
Its mean contraction is a number of the law; the rest, `log(G) - I tr log(G)/2`, stands here. So does the mean membrane
stiffness of the tubes, over its isotropic part.

**Bending.** The model of the sheet has an energy that is quadratic in the curvature c (Voigt vector, per mm of the
sheet contracted by lam in all directions),

    psi(c) = D (c . Q c / 2 - m . c),

with the mean bending stiffness D of the tubes. A tube around the direction n has `psi = D (q c^2/2 - m c)`, with
`q = Q[n n, n n]` and `m = m[n n]`: its natural curvature is m/q and its gain of energy `D m^2/(2 q)`. A least-squares
fit gives Q and m, from the natural curvatures and gains of the cells. Tubes determine a symmetric Q up to one number,
the stiffness against Gaussian curvature: a weight keeps the mean of Q12 over all axes near Poisson's ratio. Model,
unknowns and starts of the fit are the same in all axes. It starts from the isotropic plate and from the linear fit of q
and q c, and keeps the lower minimum.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats

# Poisson's ratio of bending. It changes caps, but no tubes: small free sheets agree best with the exact model for 0 to
# 0.1
BENDING_POISSON = 0.05


def isotropic_plane(poisson: float) -> Floats:
    """(3, 3) Voigt stiffness of an isotropic plane over its first constant."""
    return np.array([[1.0, poisson, 0.0], [poisson, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - poisson)]])


ISOTROPIC_PLATE = isotropic_plane(BENDING_POISSON)
# bending energy of any curvature in Q, over that in the isotropic plate
MIN_BENDING_RATIO = 0.15
# weight of the distance from the isotropic plate, beside the errors of the tubes
PLATE_WEIGHT = 0.02
# weight of the distance of the mean of Q12 over all axes from Poisson's ratio
Q12_WEIGHT = 1.0
# square root of how often the tensor has each Voigt entry, which is its entry in an orthonormal basis over the Voigt
# entry: this norm is the same in all axes
VOIGT_NORM = np.sqrt([[1.0, 1.0, 2.0], [1.0, 1.0, 2.0], [2.0, 2.0, 4.0]])
VOIGT_ENTRIES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # of a symmetric Voigt matrix (11, 22, 2 x 12)
# columns of `sample_anisotropy`
ANISOTROPY_SIZE = 17
BENDING_COLUMNS = np.arange(6)
MOMENT_COLUMNS = np.arange(6, 9)
METRIC_COLUMNS = np.arange(9, 11)
MEMBRANE_COLUMNS = np.arange(11, ANISOTROPY_SIZE)
# the same curvature in all directions, components 11, 22, 12
SPHERICAL = np.array([1.0, 1.0, 0.0])
_LOWER = np.tril_indices(3)
# W, and how often symmetric matrices and curvatures have each entry, as square roots
_KELVIN = np.array([1.0, 1.0, np.sqrt(0.5)])
_LOWER_NORM = np.where(_LOWER[0] == _LOWER[1], 1.0, np.sqrt(2.0))
_MOMENT_NORM = np.array([1.0, 1.0, np.sqrt(2.0)])


def sample_anisotropy(sample: dict[str, Any]) -> Floats:
    """(K,) differences between directions of a cell that was rolled in six directions.

    - `BENDING_COLUMNS` (6): `VOIGT_ENTRIES` of Q - `ISOTROPIC_PLATE`;
    - `MOMENT_COLUMNS` (3): m minus the mean natural curvature, components 11, 22, 12, 1/mm;
    - `METRIC_COLUMNS` (2): components 11 and 12 of the deviator of the metric's logarithm;
    - `MEMBRANE_COLUMNS` (6): `VOIGT_ENTRIES` of the membrane stiffness minus its isotropic part, over A11 of that.
    """
    angles, kappa, stiff, hoop, axial = (
        np.array(sample[name], dtype=float)
        for name in ("angles_rad", "natural_curvature", "bending", "natural_hoop", "natural_axial")
    )
    directions = angles + 0.5 * np.pi  # from x
    lam = np.sqrt(hoop * axial).mean()
    if kappa.any():
        q, m = _nearest(directions, kappa * (hoop / lam) ** 2, 0.5 * stiff * kappa**2 / stiff.mean())
    else:  # bare fabric
        q, m = _linear_fit(directions, (hoop / lam) ** 2, 0.5 * stiff / stiff.mean(), 1.0)[0], np.zeros(3)
    around, along = _squares(directions), _squares(angles)
    g11, g22, g12 = np.linalg.lstsq(np.vstack([around, along]), np.concatenate([hoop, axial]) ** 2, rcond=None)[0]
    sizes, axes = np.linalg.eigh([[g11, g12], [g12, g22]])
    metric = (axes * (np.log(sizes) - np.log(sizes).mean())) @ axes.T
    membrane = np.mean(sample["natural_membrane"], axis=0)
    a11, a12 = isotropic_constants(membrane)
    uneven = membrane / a11 - isotropic_plane(float(a12 / a11))
    return np.array(
        [
            *(q[i, j] - ISOTROPIC_PLATE[i, j] for i, j in VOIGT_ENTRIES),
            *(m - kappa.mean() * SPHERICAL),
            *metric[0],
            *(uneven[i, j] for i, j in VOIGT_ENTRIES),
        ]
    )


def isotropic_constants(stiffness: Floats) -> tuple[Floats, Floats]:
    """(...) constants A11 and A12 of the isotropic tensor nearest to a Voigt stiffness (..., 3, 3).

    They are the means of the entries 11 and 12 over all axes.

    >>> [float(a) for a in isotropic_constants(np.array([[4.0, 1.0, 0.0], [1.0, 4.0, 0.0], [0.0, 0.0, 1.5]]))]
    [4.0, 1.0]
    """
    a11, a22, a12, a33 = (stiffness[..., i, j] for i, j in ((0, 0), (1, 1), (0, 1), (2, 2)))
    return (3 * a11 + 3 * a22 + 2 * a12 + 4 * a33) / 8, (a11 + a22 + 6 * a12 - 4 * a33) / 8


def predicted_curvatures(sample: dict[str, Any], share: float = 1.0) -> Floats:
    """(6,) 1/mm, natural curvatures of the model, which compare with the sample's `natural_curvature`."""
    columns = share * sample_anisotropy(sample)
    angles, kappa, hoop, axial = (
        np.array(sample[name], dtype=float)
        for name in ("angles_rad", "natural_curvature", "natural_hoop", "natural_axial")
    )
    m = kappa.mean() * SPHERICAL + columns[MOMENT_COLUMNS]
    curvatures = natural_curvatures(
        ISOTROPIC_PLATE + voigt_matrices(columns[BENDING_COLUMNS]), m, angles + 0.5 * np.pi
    )[0]
    return np.asarray(curvatures * (np.sqrt(hoop * axial).mean() / hoop) ** 2)


def voigt_matrices(entries: Floats) -> Floats:
    """Symmetric matrices (..., 3, 3) from their `VOIGT_ENTRIES` (..., 6)."""
    out = np.empty((*entries.shape[:-1], 3, 3))
    for number, (i, j) in enumerate(VOIGT_ENTRIES):
        out[..., i, j] = out[..., j, i] = entries[..., number]
    return out


def natural_curvatures(q: Floats, m: Floats, directions: Floats) -> tuple[Floats, Floats]:
    """Natural curvatures (..., D), 1/mm, and gains of energy over D (..., D), 1/mm^2, of tubes.

    Parameters
    ----------
    q, m : (..., 3, 3) and (..., 3), 1/mm.
    directions : (D,) or (..., D), rad from x, around the tube.
    """
    along = _squares(directions)
    moment = (along @ m[..., None])[..., 0]
    curvature = moment / ((along @ q) * along).sum(axis=-1)
    return curvature, 0.5 * moment * curvature


def _nearest(directions: Floats, curvature: Floats, gain: Floats) -> tuple[Floats, Floats]:
    """Q (3, 3) and m (3,) nearest to natural curvatures (D,) and gains over D (D,) of tubes around directions (D,)."""
    curvature_scale, gain_scale = float(np.sqrt((curvature**2).mean())), float(np.abs(gain).mean())
    if curvature_scale == 0.0 or gain_scale == 0.0:
        return ISOTROPIC_PLATE, np.zeros(3)
    from scipy.optimize import least_squares  # slow to import; previews of three-armed stars do without it

    def unpacked(x: Floats) -> tuple[Floats, Floats]:
        root = np.zeros((3, 3))
        root[_LOWER] = x[:6] / _LOWER_NORM
        root = root + np.tril(root, -1).T
        rest = root @ root * np.outer(_KELVIN, _KELVIN)
        return MIN_BENDING_RATIO * ISOTROPIC_PLATE + rest, curvature_scale * x[6:] / _MOMENT_NORM

    def errors(x: Floats) -> Floats:
        q, m = unpacked(x)
        predicted, gained = natural_curvatures(q, m, directions)
        from_plate = (PLATE_WEIGHT * VOIGT_NORM * (q - ISOTROPIC_PLATE)).ravel()
        return np.concatenate(
            [
                (predicted - curvature) / curvature_scale,
                (gained - gain) / gain_scale,
                from_plate,
                [Q12_WEIGHT * (isotropic_constants(q)[1] - BENDING_POISSON)],
            ]
        )

    moment: Floats = np.asarray(
        np.linalg.lstsq(_squares(directions), curvature / curvature_scale, rcond=None)[0], float
    )
    starts = [
        (ISOTROPIC_PLATE, moment),
        _linear_fit(directions, curvature / curvature_scale, gain / gain_scale, gain_scale / curvature_scale**2),
    ]
    fits = [least_squares(errors, _packed(*start)) for start in starts]
    return unpacked(min(fits, key=lambda fit: fit.cost).x)


def _packed(q: Floats, m: Floats) -> Floats:
    """(9,) unknowns of the fit: six of S and three of m, each orthonormal, so that a turn of the axes is orthogonal.

    `Q = MIN_BENDING_RATIO ISOTROPIC_PLATE + W S S W` with a symmetric S and `W = diag(1, 1, 1/sqrt 2)`.
    """
    rest = (q - MIN_BENDING_RATIO * ISOTROPIC_PLATE) / np.outer(_KELVIN, _KELVIN)
    sizes, axes = np.linalg.eigh(rest)
    # smallest eigenvalue of S S in a start of the fit: at 0 it could not grow
    root = (axes * np.sqrt(np.maximum(sizes, 1e-3))) @ axes.T
    return np.concatenate([root[_LOWER] * _LOWER_NORM, m * _MOMENT_NORM])


def _linear_fit(directions: Floats, curvature: Floats, gain: Floats, gain_per_square: float) -> tuple[Floats, Floats]:
    """Q (3, 3) and m (3,) of the linear least squares `c^2 q = 2 gain` and `c m = 2 gain`, in units of the scales.

    Parameters
    ----------
    curvature, gain : (D,) over their scales.
    gain_per_square : scale of the gains over the squared scale of the curvatures.
    """
    along = _squares(directions)
    pairs = np.array([along[:, i] * along[:, j] * (1.0 if i == j else 2.0) for i, j in VOIGT_ENTRIES]).T
    entries = np.array([VOIGT_NORM[i, j] * (1.0 if i == j else np.sqrt(2.0)) for i, j in VOIGT_ENTRIES])
    plate = np.array([ISOTROPIC_PLATE[i, j] for i, j in VOIGT_ENTRIES])
    mean = isotropic_constants(voigt_matrices(np.eye(6)))[1]
    rows = np.vstack([curvature[:, None] ** 2 * pairs, PLATE_WEIGHT * np.diag(entries), Q12_WEIGHT * mean])
    doubled = 2.0 * gain * gain_per_square
    wish = np.concatenate([doubled, PLATE_WEIGHT * entries * plate, [Q12_WEIGHT * BENDING_POISSON]])
    q = voigt_matrices(np.linalg.lstsq(rows, wish, rcond=None)[0])
    return q, np.asarray(np.linalg.lstsq(curvature[:, None] * along, doubled, rcond=None)[0], dtype=float)


def _squares(directions: Floats) -> Floats:
    """(..., 3) Voigt vector of n n: its product with the 11, 22, 12 of a tensor is the component along n."""
    c, s = np.cos(directions), np.sin(directions)
    return np.stack([c * c, s * s, 2.0 * c * s], axis=-1)


# Search for the direction of largest energy gain. The first pass separates two maxima of nearly equal height:
FIRST_ANGLES: Floats = np.radians(np.arange(-90.0, 90.0, 2.5))
# later passes try angles around the best one, relative to the last step
ANGLE_STEPS: Floats = np.linspace(-1.0, 1.0, 13)


def tensors(kappa: Floats, anisotropy: Floats) -> tuple[Floats, Floats]:
    """Q (..., 3, 3) and m (..., 3) in 1/mm, from the mean natural curvature (...) and the K anisotropies (..., K)."""
    q = ISOTROPIC_PLATE + voigt_matrices(anisotropy[..., BENDING_COLUMNS])
    return q, kappa[..., None] * SPHERICAL + anisotropy[..., MOMENT_COLUMNS]


def tube_of_largest_gain(kappa: Floats, anisotropy: Floats) -> Floats:
    """(n,) natural curvature in 1/mm of the tube of largest energy gain over all axes; kappa (n,) if K = 0."""
    if anisotropy.shape[-1] == 0:
        return kappa
    q, m = tensors(kappa, anisotropy)
    tried, step = np.broadcast_to(FIRST_ANGLES, (len(kappa), len(FIRST_ANGLES))), FIRST_ANGLES[1] - FIRST_ANGLES[0]
    best = _of_largest_gain(q, m, tried)
    for _ in range(2):
        best = _of_largest_gain(q, m, best + step * ANGLE_STEPS)
        step *= ANGLE_STEPS[1] - ANGLE_STEPS[0]
    return np.asarray(natural_curvatures(q, m, best)[0][:, 0])


def _of_largest_gain(q: Floats, m: Floats, tried: Floats) -> Floats:
    """(n, 1) rad, of the directions tried (n, D), the one whose tube gains most."""
    chosen = natural_curvatures(q, m, tried)[1].argmax(axis=-1)[:, None]
    return np.take_along_axis(tried, chosen, axis=-1)
