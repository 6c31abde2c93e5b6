"""How the arms of the last stars bend the free rim beyond them.

The fabric between two stars lies under the arm of one of them only (`asterism.previews.fields.star_arms`), and a rim
under arms that point outwards curls along them, where the next star would be flat. Sheets of three-armed stars get
three corners that hang from it, or roll about an axis that it chooses. In a free sheet the natural curvature of bare
fabric is that of a strain rosette of the stars half a spacing back along each arm, less what is the same in all
directions.

**It takes fabric to bend an arm.** What pulls at an arm is the fabric that it lies on and that follows its tip. At the
border nothing does: an arm that ends there is hardly bent, one with a wide rim before it as much as among its like. By
the distance x from the star to the border along its arm, over the spacing, the part that it carries on is

    (x - rim_arm_start)/(rim_arm_full - rim_arm_start), from 0 to 1.

An arm that leads to another star goes on under it; beside it the rim takes `rim_arm_among` of its curvature.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp

from asterism.previews.edges.free_rim import MIN_STAR_SHARE, beside, stars_share
from asterism.previews.fields.star_arms import are_last_arms, rosette
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from pattern.geometry.arrays import Floats
from pattern.geometry.planar import distance_along
from pattern.layout.layout import Layout


def carried(layout: Layout, directions: Floats, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S, N) part of the natural curvature that each star's arms carry on; directions (N, 2) of arms."""
    start, full = model.rim_arm_start, model.rim_arm_full
    part = np.empty((len(layout.centres), len(directions)))
    for k, along in enumerate(directions):
        width = distance_along(layout.centres, along, layout.outline) / layout.spacing_mm
        last = are_last_arms(layout, layout.centres, np.broadcast_to(along, layout.centres.shape), model)
        part[:, k] = np.where(last, np.clip((width - start) / (full - start), 0.0, 1.0), model.rim_arm_among)
    return part


def arm_curvature(
    weights: sp.csr_matrix,
    values: StarValues,
    normals: Floats,
    arms: Sequence[tuple[Floats, sp.csr_matrix]],
    part: Floats,
) -> Floats:
    """(n, 3) 1/mm, the rosette of the shares of stars along the arms times the natural curvature beside.

    It vanishes among stars, and where the rim is held.

    Parameters
    ----------
    weights : (n, S) share of each star at n places.
    normals : (n, 2), see `asterism.previews.edges.free_rim.free_normals`.
    arms : direction (2,) of each of N arms, and the weights (n, S) half a spacing back along it.
    part : (S, N), see `carried`.
    """
    shares = np.column_stack([stars_share(along) for _, along in arms])
    parts = np.column_stack([along @ part[:, k] for k, (_, along) in enumerate(arms)]) / np.maximum(
        shares, MIN_STAR_SHARE
    )
    more = shares - shares.min(axis=1, keepdims=True)
    deviator = rosette(parts * more, np.array([direction for direction, _ in arms]))
    near = np.where(normals.any(axis=1), beside(weights, values.value["kappa"][:-1]), 0.0)
    return np.asarray(near[:, None] * deviator)
