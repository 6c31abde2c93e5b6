"""The bumps of the stars, laid on the smooth surface of the shell.

The law gives each star the heights of its cell over the mean surface, as amplitudes of a few waves of the lattice
(`homogenize.cell.corrugation_waves`): of the flat cell, and how they change as the sheet curls to its natural tube.
Amplitudes are shared between stars as everything else is, so that the relief has no jumps. The bare rim lies as low as
the tips of the arms beside it, and goes on down where it is free (`asterism.previews.edges.free_rim`). A printed point
moves by its height along the shell's normal.

**Between flat and natural.** Stars that hardly buckle while flat do so soon after the sheet begins to curl. In cells of
long thin stars seven tenths of the way are made where a star turns by half a radian over its spacing d, whatever its
natural curvature kappa. The way at a curvature k is

    s(k) = tanh(k d / t) / tanh(kappa d / t),    t = `bump_turn_rad`,

a straight line for stars that curl little. Bent the other way the star loses as much.

**Held apart.** A sheet that is held wider than its flat cell is pulled flat. A bump has some length to spare, and what
is taken of it counts by the square of the height: where lengths are by a part e longer than those of the flat cell,
the height is that of the free cell times `sqrt(1 - e / e_0)`, e_0 being `bump_flattening_strain`, and zero beyond.

**What is held stays** where it is held. The relief grows from there over a quarter of the spacing.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.previews.edges.free_rim import beside, rim_fall, stars_share
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from pattern.geometry.arrays import Floats, Ints

MIN_NATURAL_TURN_RAD = 1e-4  # below it the bumps of a star do not depend on the curvature


def corrugation_heights(
    waves: Floats,
    values: StarValues,
    weights: sp.csr_matrix,
    curvature: Floats,
    beyond: Floats,
    nearest: Ints,
    spacing: float,
    model: PreviewModel = PREVIEW_MODEL,
) -> Floats:
    """(n,) mm over the shell.

    Parameters
    ----------
    waves : (n, W) the law's waves at the points.
    weights : (n, S) share of each star at the points.
    curvature : (n,) 1/mm, sum of the shell's principal curvatures, positive where the plastic side is convex.
    beyond, nearest : (n,) mm, from the stars to the points where the rim is free, and the nearest star.
    spacing : mm, of the stars.
    """
    flat, more = np.moveaxis(_shared(weights, values.corrugation), 1, 0)
    bent = _bent(_shared(weights, values.value["kappa"]), curvature, spacing, model)
    stars = np.einsum("nw,nw->n", flat + bent[:, None] * more, waves)
    near = beside(weights, values.value["kappa"][:-1], nearest)
    most = model.max_rim_drop * np.abs(near)
    low, lower = beside(weights, values.tip_heights[:-1], nearest).T
    rim = np.minimum(low + np.clip(_bent(near, curvature, spacing, model), -most, most) * lower, 0.0)
    rim -= rim_fall(weights, nearest, values, beyond, spacing, model)
    return np.asarray(stars + (1.0 - stars_share(weights)) * rim)


def support_factor(far: Floats, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(n,) part of the relief that is left at a distance (n,) mm from where the sheet is held."""
    if model.bump_support_distance == 0.0:
        return np.ones_like(far)
    return np.asarray(np.minimum(far / (model.bump_support_distance * spacing), 1.0))


def flattening(values: StarValues, weights: sp.csr_matrix, area: Floats, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(n,) height of bumps over that of a sheet that nothing holds apart; area (n,) of the sheet per printed area."""
    lam = np.maximum(beside(weights, values.value["lam"][:-1]), values.value["lam"].min())
    strain = np.sqrt(area) / lam - 1.0
    return np.asarray(np.sqrt(np.clip(1.0 - strain / model.bump_flattening_strain, 0.0, 1.0)))


def _bent(kappa: Floats, curvature: Floats, spacing: float, model: PreviewModel) -> Floats:
    """(n,) 1/mm, the way from flat to natural: 0 at no curvature, and the natural one at that."""
    turn = model.bump_turn_rad
    own = np.maximum(np.abs(kappa) * spacing, MIN_NATURAL_TURN_RAD)
    return np.asarray(own / spacing * np.tanh(curvature * spacing / turn) / np.tanh(own / turn))


def _shared(weights: sp.csr_matrix, values: Floats) -> Floats:
    """(n, ...) of values (S + 1, ...), the last one the bare fabric's."""
    bare = values[-1]
    more = (values[:-1] - bare).reshape(len(values) - 1, -1)
    return np.asarray(bare + (weights @ more).reshape(-1, *values.shape[1:]))
