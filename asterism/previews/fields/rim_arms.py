"""Curl of a free rim along the arms that point into it.

The fabric between two stars lies under the arm of only one of them (`sheet_fields.rosette_metric`). Likewise, a rim
below arms that point outwards curls along these arms. This term bends three corners of a sheet of three-armed stars
down, or determines the axis about which it rolls. In a free sheet, the additional rest curvature of bare fabric is the
deviator of a strain rosette of the stars half a spacing back along each arm.

**Wide rims.** The tension of the fabric along an arm and beyond its tip bends the arm. An arm that ends at the border
stays nearly straight; an arm with a wide rim ahead bends as much as one among other stars. If the cell of a star ends
at the border, the border is half a spacing away; if the rim ahead has room for a whole cell, it is a spacing further
away. With the distance x from the star to the border along its arm, in spacings, the arm carries this share of its
natural curvature into the rim:

    (x - RIM_ARM_START) / (RIM_ARM_FULL - RIM_ARM_START), limited to the range from 0 to 1.

If an arm leads to another star, the rim beside it takes the share `rim_arm_among`.

**Free sides.** A side is not free if it is supported along its length, or at a point of a sheet with several supported
points: there the fabric is pulled straight along the rim. Points that slide along the print do not pull. A hole in the
sheet has sides like the outline. A hole in the pattern, lattice sites without a star that are enclosed by stars, has no
side: the fabric is whole there.

On fabric with a grain each arm curls by its own direction, which a mean over the directions does not say: sheets are
nearer to the exact model without this term.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import label
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats
from asterism.fem.shell.fields import Fields
from asterism.homogenize.law.anisotropy import BENDING_POISSON
from asterism.pattern.geometry.planar import (
    distance_along,
    distance_to_outline,
    distance_to_segment,
    nearest_segment,
)
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.star_cells import CELL_RADIUS, MIN_STAR_SHARE, beside, stars_share
from asterism.previews.fields.star_values import StarPlaces, rosette
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# border distances in spacings at which an arm carries nothing, without room ahead, and all, with room for a whole cell
RIM_ARM_START = 0.5
RIM_ARM_FULL = 1.5
# an arm is a last one if the next star is further away by this, in spacings; origin unknown
LAST_ARM_MARGIN = 0.3
# spacings; a side is supported by points nearer to it than this; origin unknown
RIM_PIN_DISTANCE = 0.5


def rim_arms(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the curl of free rims."""
    if at.stars.carried is None or at.has_grain:
        return fields
    more = at.lam[..., None] ** 2 * arm_curvature(at).reshape(*at.shape, 3) / (1.0 + BENDING_POISSON)
    return replace(fields, curvature=np.asarray(fields.curvature) - more)


def arm_curvature(at: StarPlaces) -> Floats:
    """(n, 3) 1/mm, additional rest curvature, components 11, 22, 12: shares along the arms times natural curvature.

    It is zero among stars and at supported sides.
    """
    assert at.stars.carried is not None and at.stars.normals is not None
    shares = np.column_stack([stars_share(along) for along in at.along_arms])
    parts = np.column_stack([along @ part for along, part in zip(at.along_arms, at.stars.carried.T, strict=True)])
    parts /= np.maximum(shares, MIN_STAR_SHARE)
    more = shares - shares.min(axis=1, keepdims=True)
    deviator = rosette(parts * more, at.stars.directions)
    near = np.where(at.stars.normals.any(axis=1), beside(at.weights, at.values.value["kappa"][:-1]), 0.0)
    return np.asarray(near[:, None] * deviator)


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
        room = np.clip((width - RIM_ARM_START) / (RIM_ARM_FULL - RIM_ARM_START), 0.0, 1.0)
        part[:, k] = np.where(_are_last_arms(layout, along), room, model.rim_arm_among)
    return part


def _are_last_arms(layout: Layout, direction: Floats) -> Bools:
    """(S,) whether the arms of the stars along a direction (2,) end at the rim: the site ahead has no star."""
    ahead = layout.spacing_mm * direction
    steps = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    sites = cKDTree(steps[steps.any(axis=1)] @ layout.lattice_vectors)
    to_star = cKDTree(layout.centres).query(layout.centres + ahead)[0]
    return np.asarray(to_star > sites.query(ahead)[0] + LAST_ARM_MARGIN * layout.spacing_mm)


def free_normals(layout: Layout, points: Floats) -> Floats:
    """(n, 2) unit normals of the sides nearest to printed points (n, 2) mm; zero at supported sides and in holes.

    A side is supported along its length, or at a point if supports fix at least two points of the sheet along the
    print.
    """
    edges = layout.edges
    start, end = edges.start, edges.end
    along = end - start
    nearest = nearest_segment(points, start, end)
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    normal[layout.supported_edges] = 0.0
    pins = layout.in_plane_pin_points
    if len(pins) > 1:
        near = RIM_PIN_DISTANCE * layout.spacing_mm
        held = (distance_to_segment(pins[:, None], start, end) < near).any(axis=0)
        side = edges.straight_sides
        normal[np.isin(side, side[held])] = 0.0
    return np.where(in_holes(layout, points)[:, None], 0.0, normal[nearest])


def in_holes(layout: Layout, points: Floats) -> Bools:
    """(n,) whether printed points (n, 2) mm are nearer to a site of a hole in the pattern than to all stars."""
    holes = hole_sites(layout)
    if not len(holes):
        return np.zeros(len(points), dtype=bool)
    return np.asarray(cKDTree(holes).query(points)[0] < cKDTree(layout.centres).query(points)[0])


def hole_sites(layout: Layout) -> Floats:
    """(n, 2) mm, lattice sites without a star that are not connected to the rim through other such sites."""
    vectors = layout.lattice_vectors
    sites = np.rint((layout.centres - layout.lattice_origin) @ np.linalg.inv(vectors)).astype(np.int64)
    first = sites.min(axis=0) - 1
    empty = np.ones(np.ptp(sites, axis=0) + 3, dtype=bool)
    empty[tuple((sites - first).T)] = False
    steps = np.array([[(i, j) for j in (-1, 0, 1)] for i in (-1, 0, 1)]) @ vectors
    longest = (1.0 + 1e-6) * np.linalg.norm(vectors, axis=1).max()  # of a step to a neighbour
    region = label(empty, np.linalg.norm(steps, axis=-1) <= longest)[0][empty]
    places = layout.lattice_origin + (np.argwhere(empty) + first) @ vectors
    near = CELL_RADIUS * layout.spacing_mm  # the cells of nearer sites reach the outline
    away = np.min([distance_to_outline(places, ring) for ring in layout.edges.rings], axis=0)
    rim = ~layout.is_on_sheet(places) | (away < near)
    return np.asarray(places[~np.isin(region, region[rim])])
