"""Curl of a free rim along the arms that point into it.

The fabric between two stars lies under the arm of only one of them (`asterism.previews.fields.rosette`). Likewise, a
rim below arms that point outwards curls along these arms. This term bends three corners of a sheet of three-armed stars
down, or determines the axis about which it rolls. In a free sheet, the additional rest curvature of bare fabric is the
deviator of a strain rosette of the stars half a spacing back along each arm.

**Wide rims.** The tension of the fabric along an arm and beyond its tip bends the arm. An arm that ends at the border
stays nearly straight; an arm with a wide rim ahead bends as much as one among other stars. If the cell of a star ends
at the border, the border is half a spacing away; if the rim ahead has room for a whole cell, it is a spacing further
away. With the distance x from the star to the border along its arm, in spacings, the arm carries this share of its
natural curvature into the rim:

    (x - RIM_ARM_START) / (RIM_ARM_FULL - RIM_ARM_START), limited to the range from 0 to 1.

If an arm leads to another star, the rim beside it takes the share `rim_arm_among`.

On fabric with a grain each arm curls by its own direction, which a mean over the directions does not say: sheets are
nearer to the exact model without this term.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import BENDING_POISSON
from asterism.pattern.geometry.planar import distance_along
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.rosette import rosette
from asterism.previews.fields.star_cells import MIN_STAR_SHARE, beside, stars_share
from asterism.previews.fields.star_places import StarPlaces
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# border distances in spacings at which an arm carries nothing, without room ahead, and all, with room for a whole cell
RIM_ARM_START = 0.5
RIM_ARM_FULL = 1.5
# an arm is a last one if the next star is further away by this, in spacings; origin unknown
LAST_ARM_MARGIN = 0.3


def rim_arms(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the curl of free rims."""
    if at.normals is None or at.carried is None or at.has_grain:
        return fields
    rim = arm_curvature(at.weights, at.values, at.normals, at.arms, at.carried).reshape(*at.shape, 3)
    more = at.lam[..., None] ** 2 * rim / (1.0 + BENDING_POISSON)
    return replace(fields, curvature=np.asarray(fields.curvature) - more)


def rim_curvature_share(layout: Layout, directions: Floats, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S, N) share of the natural curvature that the arms of each star carry into a free rim.

    Parameters
    ----------
    directions : (N, 2) unit vectors of the arms.
    """
    part = np.empty((len(layout.centres), len(directions)))
    for k, along in enumerate(directions):
        to_rings = [distance_along(layout.centres, along, ring) for ring in layout.edges.rings]
        width = np.min(to_rings, axis=0) / layout.spacing_mm
        last = are_last_arms(layout, layout.centres, np.broadcast_to(along, layout.centres.shape))
        room = np.clip((width - RIM_ARM_START) / (RIM_ARM_FULL - RIM_ARM_START), 0.0, 1.0)
        part[:, k] = np.where(last, room, model.rim_arm_among)
    return part


def arm_curvature(
    weights: sp.csr_matrix,
    values: StarValues,
    normals: Floats,
    arms: Sequence[tuple[Floats, sp.csr_matrix]],
    part: Floats,
) -> Floats:
    """(n, 3) 1/mm, additional rest curvature, components 11, 22, 12: shares along the arms times natural curvature.

    It is zero among stars and at supported sides.

    Parameters
    ----------
    weights : (n, S) share of each star at n places.
    normals : (n, 2), from `asterism.previews.fields.free_sides.free_normals`.
    arms : for each of N arms its direction (2,), and the weights (n, S) half a spacing back along it.
    part : (S, N), from `rim_curvature_share`.
    """
    shares = np.column_stack([stars_share(along) for _, along in arms])
    parts = np.column_stack([along @ part[:, k] for k, (_, along) in enumerate(arms)]) / np.maximum(
        shares, MIN_STAR_SHARE
    )
    more = shares - shares.min(axis=1, keepdims=True)
    deviator = rosette(parts * more, np.array([direction for direction, _ in arms]))
    near = np.where(normals.any(axis=1), beside(weights, values.value["kappa"][:-1]), 0.0)
    return np.asarray(near[:, None] * deviator)


def are_last_arms(layout: Layout, centres: Floats, directions: Floats) -> Bools:
    """(n,) whether arms end at the rim: the site ahead has no star.

    Parameters
    ----------
    centres : (n, 2) mm, centres of the stars.
    directions : (n, 2) unit vectors of the arms.
    """
    ahead = layout.spacing_mm * directions
    steps = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    sites = cKDTree(steps[steps.any(axis=1)] @ layout.lattice_vectors)
    to_star = cKDTree(layout.centres).query(centres + ahead)[0]
    return np.asarray(to_star > sites.query(ahead)[0] + LAST_ARM_MARGIN * layout.spacing_mm)
