"""Sheets that differ between directions: rest metric, stiffness and rest curvature (`homogenize.law.anisotropy`).

The law holds what cells are at their natural curvature. Stars whose arms differ from their lattice bend most
differently there, while flat cells of them are nearly isotropic, and sheets are in between. Therefore the share
`anisotropy_share` of these differences in bending acts in the shell. With the deviator d of the metric's logarithm, the
rest metric is `exp(d/2) a_r exp(d/2)`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import MEMBRANE_COLUMNS, METRIC_COLUMNS, tensors, voigt_matrices
from asterism.previews.fields.star_places import StarPlaces


def directions(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the tensors of sheets that differ between directions."""
    if not at.values.anisotropy.shape[1]:
        return fields
    assert isinstance(fields.density, Density)
    differs = at.anisotropy
    q, m = tensors(at.mean("kappa"), differs)
    stiffness = np.array(fields.density.stiffness)
    stiffness[..., :3, :3] += stiffness[..., :1, :1] * voigt_matrices(differs[..., MEMBRANE_COLUMNS])
    stiffness[..., 3:, 3:] = (at.log_mean("bending") / at.lam**4)[..., None, None] * q
    # -lam^2 Q^-1 m with components 11, 22, 12
    bend = -(at.lam**2)[..., None] * np.linalg.solve(q, m[..., None])[..., 0] * np.array([1.0, 1.0, 0.5])
    return replace(
        fields,
        density=replace(fields.density, stiffness=stiffness),
        metric=_deformed(np.asarray(fields.metric), differs[..., METRIC_COLUMNS]),
        curvature=bend,
    )


def _deformed(metric: Floats, deviator: Floats) -> Floats:
    """(..., 3) metric with components 11, 22, 12 after the stretch `exp(d/2)`, d with components 11, 12 (..., 2)."""
    size = np.hypot(deviator[..., 0], deviator[..., 1])
    part = np.sinh(0.5 * size) / np.where(size > 0.0, size, 1.0)
    root = np.cosh(0.5 * size)[..., None, None] * np.eye(2)
    root = root + part[..., None, None] * deviator[..., [[0, 1], [1, 0]]] * np.array([[1.0, 1.0], [1.0, -1.0]])
    full = root @ metric[..., [[0, 2], [2, 1]]] @ root
    return np.stack([full[..., 0, 0], full[..., 1, 1], full[..., 0, 1]], axis=-1)
