"""The bumps of the stars, laid on the smooth surface of the shell.

The law gives each star the heights of its cell over the mean surface, as amplitudes of a few waves of the lattice
(`homogenize.cell.relief`): those of the flat cell, and how they change as the sheet curls to its natural tube.
Amplitudes are shared between stars as everything else is, so that the relief has no jumps. The bare rim lies as low as
the tips of the arms beside it, and goes on down where it is free (`asterism.previews.edges.free_rim`). A printed point
moves by its height along the shell's normal.

**Between flat and natural.** Stars that hardly buckle while flat do so soon after the sheet begins to curl. In cells of
long thin stars seven tenths of the way are made where a star turns by half a radian over its spacing d, whatever its
natural curvature kappa. The way at a curvature k is

    s(k) = tanh(k d / .55) / tanh(kappa d / .55),

a straight line for stars that curl little. Bent the other way the star loses as much.

**Held apart.** A sheet that is held wider than its flat cell is pulled flat. A bump has some length to spare, and what
is taken of it counts by the square of the height: where lengths are by a part e longer than those of the flat cell,
the height is that of the free cell times `sqrt(1 - e / APART)`, and nothing from APART on.

**What is held stays** where it is held. The relief grows from there over a quarter of the spacing.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.previews.edges.free_rim import beside, rim_fall, stars_share
from asterism.previews.fields.star_values import StarValues
from pattern.geometry.arrays import Floats, Ints

# turn over a star's spacing, rad, that takes its relief most of the way to the natural one
TURN = 0.55
# a natural turn below which stars have one relief
LEAST = 1e-4
# part by which sheets without bumps are longer
APART = 0.08
# distance from what is held, over the spacing, up to which the relief grows
STAYS = 0.25


def relief_heights(
    waves: Floats,
    values: StarValues,
    weights: sp.csr_matrix,
    curvature: Floats,
    beyond: Floats,
    nearest: Ints,
    spacing: float,
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
    flat, more = np.moveaxis(_shared(weights, values.relief), 1, 0)
    bent = _bent(_shared(weights, values.value["kappa"]), curvature, spacing)
    stars = np.einsum("nw,nw->n", flat + bent[:, None] * more, waves)
    near = beside(weights, values.value["kappa"][:-1], nearest)
    # no deeper than stars half as much again as the natural tube makes them
    most = 1.5 * np.abs(near)
    low, lower = beside(weights, values.tips[:-1], nearest).T
    rim = np.minimum(low + np.clip(_bent(near, curvature, spacing), -most, most) * lower, 0.0)
    rim -= rim_fall(weights, nearest, values, beyond, spacing)
    return np.asarray(stars + (1.0 - stars_share(weights)) * rim)


def held_still(far: Floats, spacing: float) -> Floats:
    """(n,) part of the relief that is left at a distance (n,) mm from where the sheet is held."""
    return np.minimum(far / (STAYS * spacing), 1.0)


def pulled_flat(values: StarValues, weights: sp.csr_matrix, area: Floats) -> Floats:
    """(n,) height of bumps over that of a sheet that nothing holds apart; area (n,) of the sheet per printed area."""
    lam = np.maximum(beside(weights, values.value["lam"][:-1]), values.value["lam"].min())
    return np.sqrt(np.clip(1.0 - (np.sqrt(area) / lam - 1.0) / APART, 0.0, 1.0))


def _bent(kappa: Floats, curvature: Floats, spacing: float) -> Floats:
    """(n,) 1/mm, the way from flat to natural: 0 at no curvature, and the natural one at that."""
    own = np.maximum(np.abs(kappa) * spacing, LEAST)
    return np.asarray(own / spacing * np.tanh(curvature * spacing / TURN) / np.tanh(own / TURN))


def _shared(weights: sp.csr_matrix, values: Floats) -> Floats:
    """(n, ...) of values (S + 1, ...), the last one the bare fabric's."""
    bare = values[-1]
    more = (values[:-1] - bare).reshape(len(values) - 1, -1)
    return bare + (weights @ more).reshape(-1, *values.shape[1:])
