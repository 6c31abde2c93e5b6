"""How the rim of a sheet lies and curls where nothing holds it.

The law's cells are those of an endless sheet, where the fabric comes up again between a star and its neighbour. Beyond
the last stars there is none. The fabric lies as low as the tips of their arms, and goes on as their bumps leave it: a
bump of height B over arms of length l is a cap of curvature `2 B / l^2`. So bare fabric has the curvature at rest

    b_r = -c 2 B / l^2 lam^2 n n^T

across the nearest side of the outline, n being normal to it, and none along it; c is
`rim_curl_factor`: shares are smoothed, and less than half of the outline is bare, so that it is above 1.
Without it, free rims of previews turn
down less than the exact model's. A side that is held keeps none, along its length or at a point of it where the sheet
is held at more than one: there the fabric is pulled along the rim, and straight. Points that slide in their plane do
not pull. A hole, bare sites with stars all around, has no side to turn to.

Under arms that point outwards it curls along them too: `asterism.previews.edges.rim_arms`.

**Long arms turn it further.** In the exact model the rim beyond long arms goes down steeply even where bumps are flat.
So the bare fabric falls by `rim_fall_rad` per distance from the stars, less where bumps make it curl anyway. It does
so out to the corners of wide rims, far from all stars. What drives it is that the fabric contracts and the arms do not,
so that fabric of a small stretch falls less: in proportion to the area it gives up, up to that of `rim_fall_stretch`.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.previews.fields.holes import in_holes
from asterism.previews.fields.star_cells import long_arms
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from pattern.geometry.arrays import Floats, Ints
from pattern.geometry.planar import STRAIGHT_TURN_RAD, distance_to_segment, nearest_segment, turning_angles
from pattern.layout.layout import Layout

MIN_STAR_SHARE = 0.02  # share of the stars below which a place has no star beside it


def free_normals(layout: Layout, points: Floats, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(n, 2) unit normals of the sides nearest to printed points (n, 2) mm; zero where that side is held, and in holes.

    A side is held along its length, or at a point of it in a sheet that is held along the print at two points or more.
    """
    start, end = layout.outline, np.roll(layout.outline, -1, axis=0)
    along = end - start
    nearest = nearest_segment(points, start, end)
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    normal[layout.supported_edges] = 0.0
    pins = layout.in_plane_pin_points
    if len(pins) > 1:
        near = model.rim_pin_distance * layout.spacing_mm
        held = (distance_to_segment(pins[:, None], start, end) < near).any(axis=0)
        # a side in several pieces is one
        side = np.cumsum(np.abs(turning_angles(layout.outline)) > STRAIGHT_TURN_RAD)
        side[side == 0] = side[-1]
        normal[np.isin(side, side[held])] = 0.0
    return np.where(in_holes(layout, points, model)[:, None], 0.0, normal[nearest])


def rim_curvature(
    weights: sp.csr_matrix, values: StarValues, normals: Floats, model: PreviewModel = PREVIEW_MODEL
) -> Floats:
    """(n, 3) 1/mm, components 11, 22, 12 of `c 2 B / l^2 n n^T` times the share of bare fabric.

    `weights`: (n, S) share of each star at the places, `normals`: (n, 2), see `free_normals`.
    """
    share = stars_share(weights)
    size = model.rim_curl_factor * (1.0 - share) * beside(weights, values.bump_curvature[:-1])
    x, y = normals.T
    return np.asarray(size[:, None] * np.column_stack([x * x, y * y, x * y]))


def beyond_stars(layout: Layout, points: Floats, model: PreviewModel = PREVIEW_MODEL) -> tuple[Floats, Ints]:
    """(n,) mm of free rim between printed points (n, 2) mm and the stars, and (n,) the nearest star.

    Stars reach half a spacing far.
    """
    far, nearest = cKDTree(layout.centres).query(points)
    free = free_normals(layout, points, model).any(axis=1)
    return np.where(free, np.maximum(far - 0.5 * layout.spacing_mm, 0.0), 0.0), nearest


def rim_fall(
    weights: sp.csr_matrix,
    nearest: Ints,
    values: StarValues,
    beyond: Floats,
    spacing: float,
    model: PreviewModel = PREVIEW_MODEL,
) -> Floats:
    """(n,) rad times mm, by which bare fabric lies under the stars' tips, down being where the edges go.

    `weights`: (n, S) share of each star at the places, `beyond` and `nearest`: (n,), see `beyond_stars`.
    """
    straight = np.maximum(1.0 - np.abs(values.bump_curvature[:-1]) * spacing / model.rim_fall_bump_turn_rad, 0.0)
    pull = min((1.0 - values.value["lam_n"][-1] ** 2) / (1.0 - model.rim_fall_stretch**-2), 1.0)
    side, long = np.sign(values.value["kappa"][:-1]), long_arms(values.sizes[:, 0], spacing, model)
    turn = model.rim_fall_rad * pull * side * long * straight
    return beside(weights, turn, nearest) * beyond


def stars_share(weights: sp.csr_matrix) -> Floats:
    """(n,) of all stars together; what is missing to 1 is bare fabric."""
    return np.asarray(weights.sum(axis=1)).ravel()


def beside(weights: sp.csr_matrix, of: Floats, nearest: Ints | None = None) -> Floats:
    """(n, ...) mean over the stars beside a place of what each has (S, ...).

    Far from all stars it is that of the `nearest` one (n,), or vanishes if that is not given.
    """
    mean, share = weights @ of, stars_share(weights)
    if nearest is None:
        return np.asarray(mean / _rows(np.maximum(share, MIN_STAR_SHARE), mean))
    return np.asarray((mean + MIN_STAR_SHARE * of[nearest]) / _rows(share + MIN_STAR_SHARE, mean))


def _rows(of: Floats, like: Floats) -> Floats:
    """(n, 1, ...) of (n,), to divide another array's rows by."""
    return of.reshape(-1, *[1] * (like.ndim - 1))
