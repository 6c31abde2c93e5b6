"""Anisotropic stars: bending stiffness and rest curvature of the shell (`homogenize.law.anisotropy`).

The law holds the anisotropy of cells at their natural curvature, where it is largest. Flat cells are nearly isotropic,
and sheets are in between. Therefore the share `anisotropy_share` of the anisotropy acts in the shell.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import tensors
from asterism.previews.fields.star_places import StarPlaces


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


def with_bending_tensor(stiffness: Floats, bending: Floats, q: Floats) -> Floats:
    """(..., 6, 6) stiffness with the bending part `bending Q` in place of an isotropic one; bending (...) in N mm."""
    anisotropic = stiffness.copy()
    anisotropic[..., 3:, 3:] = bending[..., None, None] * q
    return anisotropic


def rest_curvature_tensor(lam: Floats, q: Floats, m: Floats) -> Floats:
    """(..., 3) rest curvature `-lam^2 Q^-1 m` in 1/mm, components 11, 22, 12, for contractions lam (...)."""
    voigt = np.linalg.solve(q, m[..., None])[..., 0]
    return np.asarray(-(lam**2)[..., None] * voigt * np.array([1.0, 1.0, 0.5]))
