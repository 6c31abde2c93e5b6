"""Turn of a free rim: the bare fabric beyond the last stars.

In a periodic cell, the fabric rises again between a star and its neighbour. Beyond the last stars it stays as low as
the tips of their arms, and goes nearly straight on. A bump of height B over arms of length l is a cap whose slope is
`2 B / l` at the tips. By this angle times lam, the rim turns out of the mean surface of the stars. The rims of endless
ribbons turn more: by 1.4 to 2.1 times `2 B / l` for stars of 0.3 mm, and by 0.23
to 0.34 for stars of 0.43 mm, where `2 B / l` is 0.05. The turn is at the border of the stars' share s. Therefore bare
fabric has the rest curvature

    b_r = (2 B / l) lam^2 (n . grad s) n n^T

across the nearest side of the outline, whose normal is n, and zero rest curvature along it. The integral of
`-n . grad s` across the rim is the share inside less that at the side: one for rims wider than the smoothing, and less
for narrower ones.

A side has no rest curvature if it is supported along its length, or at a point of a sheet with several supported
points: there the fabric is pulled straight along the rim. Points that slide along the print do not pull. A hole, bare
sites enclosed by stars, has no side to turn to; a hole in the sheet has sides like the outline.

Below arms that point outwards, the rim also curls along the arms (`asterism.previews.fields.rim_arms`).
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import distance_to_segment, nearest_segment
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.holes import in_holes
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# a place with a smaller share of stars counts as far from all stars
MIN_STAR_SHARE = 0.02


def free_normals(layout: Layout, points: Floats, model: PreviewModel = PREVIEW_MODEL) -> Floats:
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
        near = model.rim_pin_distance * layout.spacing_mm
        held = (distance_to_segment(pins[:, None], start, end) < near).any(axis=0)
        side = edges.straight_sides
        normal[np.isin(side, side[held])] = 0.0
    return np.where(in_holes(layout, points, model)[:, None], 0.0, normal[nearest])


def rim_curvature(weights: sp.csr_matrix, values: StarValues, normals: Floats, border: Floats) -> Floats:
    """(n, 3) 1/mm, components 11, 22, 12 of `-(2 B / l) (n . grad s) n n^T`.

    Parameters
    ----------
    weights : (n, S) share of each star at the places.
    normals : (n, 2), from `free_normals`.
    border : (n,) 1/mm, `-n . grad s`, from `asterism.previews.sheet.StarShares.border`.
    """
    size = border * beside(weights, values.tip_slope[:-1])
    x, y = normals.T
    return np.asarray(size[:, None] * np.column_stack([x * x, y * y, x * y]))


def stars_share(weights: sp.csr_matrix) -> Floats:
    """(n,) share of all stars together; bare fabric has the rest to 1."""
    return np.asarray(weights @ np.ones(weights.shape[1]))


def beside(weights: sp.csr_matrix, of: Floats, nearest: Ints | None = None) -> Floats:
    """(n, ...) mean of values (S, ...) over the stars near each place.

    Far from all stars, it is the value of the `nearest` star (n,), or zero if `nearest` is not given.
    """
    mean, share = weights @ of, stars_share(weights)
    if nearest is None:
        return np.asarray(mean / _rows(np.maximum(share, MIN_STAR_SHARE), mean))
    return np.asarray((mean + MIN_STAR_SHARE * of[nearest]) / _rows(share + MIN_STAR_SHARE, mean))


def _rows(of: Floats, like: Floats) -> Floats:
    """(n,) reshaped to (n, 1, ...), to divide the rows of the array `like`."""
    return of.reshape(-1, *[1] * (like.ndim - 1))
