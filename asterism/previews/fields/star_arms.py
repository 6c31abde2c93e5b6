"""The rest metric where stars change over the sheet.

A star of three arms is not the same in opposite directions. On a lattice whose lines follow the arms, the fabric
between two neighbours lies under the arm of one of them only: the star that the line leaves along its arm. So at a
place of the sheet, the contraction along an arm's direction `d_k` is not that of the stars around it, but of those half
a spacing back along the arm:

    rho_k(X) = lam(X - spacing/2 d_k).

The metric with these stretches along all N arms, scaled so that their geometric mean stays `lam`, is that of a strain
rosette,

    a_r = lam^2 (m I + 4/N sum_k (s_k - m) (d_k d_k - I/2)),    s_k = rho_k^2 / (prod_j rho_j)^(2/N),    m = mean s_k.

with 2/N for four arms: they lie along two lines only, which know nothing of the shear between them. For equal stars it
is `lam^2 I`; for other numbers of arms than three a gradient does not change it.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout


def arm_metric(lam: Floats, along: Floats, directions: Floats) -> Floats:
    """(..., 3) components 11, 22, 12 of the rest metric.

    Parameters
    ----------
    lam : (...) contraction of a place.
    along : (..., N) contraction of the stars half a spacing back along each arm.
    directions : (N, 2) unit vectors of the arms.
    """
    stretch = (along / np.exp(np.log(along).mean(axis=-1, keepdims=True))) ** 2
    mean = stretch.mean(axis=-1)
    mean_part = mean[..., None] * np.array([1.0, 1.0, 0.0])
    return np.asarray((lam**2)[..., None] * (mean_part + rosette(stretch, directions)))


def rosette(along: Floats, directions: Floats) -> Floats:
    """(..., 3) components 11, 22, 12 of `4/N sum_k (s_k - m) (d_k d_k - I/2)`: a strain rosette less its mean.

    Of four directions, opposite in pairs, it is half of that.

    Parameters
    ----------
    along : (..., N) s_k along each direction; m is their mean.
    directions : (N, 2) unit vectors d_k.
    """
    x, y = directions.T
    rest = (2.0 if len(directions) == 4 else 4.0) / len(directions) * (along - along.mean(axis=-1, keepdims=True))
    return np.stack([rest @ (x * x - 0.5), rest @ (y * y - 0.5), rest @ (x * y)], axis=-1)


def are_last_arms(
    layout: Layout, centres: Floats, directions: Floats, model: PreviewModel = PREVIEW_MODEL
) -> np.ndarray:
    """Which arms (n,), of stars at `centres` (n, 2) mm along unit `directions` (n, 2), have no star ahead."""
    ahead = layout.spacing_mm * directions
    steps = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    others = cKDTree(steps[steps.any(axis=1)] @ layout.lattice_vectors)
    found = cKDTree(layout.centres).query(centres + ahead)[0]
    return np.asarray(found > others.query(ahead)[0] + model.last_arm_margin * layout.spacing_mm)
