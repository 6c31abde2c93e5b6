"""Anisotropic stars: bending stiffness and rest curvature of the shell (`homogenize.law.anisotropy`).

The law holds the anisotropy of cells at their natural curvature, where it is largest. Flat cells are nearly isotropic,
and sheets are in between. Therefore the share `anisotropy_share` of the anisotropy acts in the shell.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

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
    stiffness = np.array(fields.density.stiffness)
    stiffness[..., 3:, 3:] = (at.log_mean("bending") / at.lam**4)[..., None, None] * q
    # -lam^2 Q^-1 m with components 11, 22, 12
    bend = -(at.lam**2)[..., None] * np.linalg.solve(q, m[..., None])[..., 0] * np.array([1.0, 1.0, 0.5])
    return replace(fields, density=replace(fields.density, stiffness=stiffness), curvature=bend)
