"""Anisotropic stars: bending stiffness and rest curvature of the shell (`homogenize.law.anisotropy`).

The law holds the anisotropy of cells at their natural curvature, where it is largest. Flat cells are nearly isotropic,
and sheets are in between. Therefore the share `anisotropy_share` of the anisotropy acts in the shell.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import (
    BENDING_COLUMNS,
    ISOTROPIC_PLATE,
    MOMENT_COLUMNS,
    SPHERICAL,
    natural_curvatures,
    voigt_matrices,
)

if TYPE_CHECKING:
    from asterism.previews.fields.star_places import StarPlaces

# Search for the direction of largest energy gain. The first pass separates two maxima of nearly equal height:
FIRST_ANGLES: Floats = np.radians(np.arange(-90.0, 90.0, 2.5))
# later passes try angles around the best one, relative to the last step
ANGLE_STEPS: Floats = np.linspace(-1.0, 1.0, 13)
LATER_PASSES = 2


def directions(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the bending tensor and the rest curvature of anisotropic stars."""
    anisotropy = at.values.anisotropy
    if not anisotropy.shape[1]:
        return fields
    assert isinstance(fields.density, Density)
    q, m = tensors(at.mean("kappa"), np.asarray(at.weights @ anisotropy[:-1]).reshape(*at.shape, -1))
    stiffness = with_bending_tensor(fields.density.stiffness, at.log_mean("bending") / at.lam**4, q)
    return replace(
        fields,
        density=replace(fields.density, stiffness=stiffness),
        curvature=rest_curvature_tensor(at.lam, q, m),
    )


def tensors(kappa: Floats, anisotropy: Floats) -> tuple[Floats, Floats]:
    """Q (..., 3, 3) and m (..., 3) in 1/mm, from the mean natural curvature (...) and the K anisotropies (..., K)."""
    q = ISOTROPIC_PLATE + voigt_matrices(anisotropy[..., BENDING_COLUMNS])
    return q, kappa[..., None] * SPHERICAL + anisotropy[..., MOMENT_COLUMNS]


def with_bending_tensor(stiffness: Floats, bending: Floats, q: Floats) -> Floats:
    """(..., 6, 6) stiffness with the bending part `bending Q` in place of an isotropic one; bending (...) in N mm."""
    anisotropic = stiffness.copy()
    anisotropic[..., 3:, 3:] = bending[..., None, None] * q
    return anisotropic


def rest_curvature_tensor(lam: Floats, q: Floats, m: Floats) -> Floats:
    """(..., 3) rest curvature `-lam^2 Q^-1 m` in 1/mm, components 11, 22, 12, for contractions lam (...)."""
    voigt = np.linalg.solve(q, m[..., None])[..., 0]
    return np.asarray(-(lam**2)[..., None] * voigt * np.array([1.0, 1.0, 0.5]))


def tube_of_largest_gain(kappa: Floats, anisotropy: Floats) -> Floats:
    """(n,) natural curvature in 1/mm of the tube of largest energy gain over all axes; kappa (n,) if K = 0."""
    if anisotropy.shape[-1] == 0:
        return kappa
    q, m = tensors(kappa, anisotropy)
    tried, step = np.broadcast_to(FIRST_ANGLES, (len(kappa), len(FIRST_ANGLES))), FIRST_ANGLES[1] - FIRST_ANGLES[0]
    best = _of_largest_gain(q, m, tried)
    for _ in range(LATER_PASSES):
        best = _of_largest_gain(q, m, best + step * ANGLE_STEPS)
        step *= ANGLE_STEPS[1] - ANGLE_STEPS[0]
    return np.asarray(natural_curvatures(q, m, best)[0][:, 0])


def _of_largest_gain(q: Floats, m: Floats, tried: Floats) -> Floats:
    """(n, 1) rad, of the directions tried (n, D), the one whose tube gains most."""
    chosen = natural_curvatures(q, m, tried)[1].argmax(axis=-1)[:, None]
    return np.take_along_axis(tried, chosen, axis=-1)
