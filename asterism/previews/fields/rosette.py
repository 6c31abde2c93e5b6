"""The rest metric where the stars change over the sheet.

A star with three arms differs between opposite directions. Where the lines of the lattice follow the arms, the fabric
between two neighbours lies under the arm of only one of them. Therefore the contraction along the direction `d_k` of an
arm is that of the stars half a spacing back along the arm:

    rho_k(X) = lam(X - spacing/2 d_k).

The rest metric has these contractions along all N arms, like a strain rosette, scaled so that their geometric mean is
`lam`:

    a_r = lam^2 (m I + 4/N sum_k (s_k - m) (d_k d_k - I/2)),    s_k = rho_k^2 / (prod_j rho_j)^(2/N),    m = mean s_k.

For four arms the factor is 2/N, since they lie along two lines only, which leaves the shear undetermined. For equal
stars, a_r is `lam^2 I`. A gradient of the sizes changes a_r only for three arms.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.fields import Fields
from asterism.previews.fields.star_values import StarPlaces


def rosette_metric(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the rest metric of changing stars."""
    if not at.along_arms:
        return fields
    along = np.stack([at.log_mean("lam_n", weights) for weights in at.along_arms], axis=-1)
    return replace(fields, metric=arm_metric(at.lam, along, at.stars.directions))


def arm_metric(lam: Floats, along: Floats, directions: Floats) -> Floats:
    """(..., 3) components 11, 22, 12 of the rest metric.

    Parameters
    ----------
    lam : (...) contraction of the places.
    along : (..., N) contraction of the stars half a spacing back along each arm.
    directions : (N, 2) unit vectors of the arms.

    Examples
    --------
    The metric of equal stars is isotropic:

    >>> angles = np.radians([90.0, 210.0, 330.0])
    >>> directions = np.column_stack([np.cos(angles), np.sin(angles)])
    >>> arm_metric(np.array(0.8), np.full(3, 0.8), directions).round(6) + 0.0
    array([0.64, 0.64, 0.  ])
    """
    stretch = (along / np.exp(np.log(along).mean(axis=-1, keepdims=True))) ** 2
    mean = stretch.mean(axis=-1)
    mean_part = mean[..., None] * np.array([1.0, 1.0, 0.0])
    return np.asarray((lam**2)[..., None] * (mean_part + rosette(stretch, directions)))


def rosette(along: Floats, directions: Floats) -> Floats:
    """(..., 3) components 11, 22, 12 of `4/N sum_k (s_k - m) (d_k d_k - I/2)`, the deviator of a strain rosette.

    For four directions, which are opposite in pairs, it is half of that.

    Parameters
    ----------
    along : (..., N) values s_k along the directions; m is their mean.
    directions : (N, 2) unit vectors d_k.
    """
    x, y = directions.T
    rest = (2.0 if len(directions) == 4 else 4.0) / len(directions) * (along - along.mean(axis=-1, keepdims=True))
    return np.stack([rest @ (x * x - 0.5), rest @ (y * y - 0.5), rest @ (x * y)], axis=-1)
