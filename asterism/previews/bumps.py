"""The corrugation: heights of the stars' bumps over the smooth surface of the shell.

The law describes the heights of a cell over its mean surface by the amplitudes of a few waves of the lattice
(`homogenize.cell.corrugation_waves`): amplitudes of the flat cell, and their change as the sheet curls to its natural
tube. At a place shared by several stars, the amplitudes are averaged, so that the corrugation has no jumps. The bare
rim is as low as the tips of the arms beside it. A printed point moves by its height along the shell's normal.

**Between the flat and the natural cell.** Stars that hardly buckle in a flat sheet buckle soon after the sheet begins
to curl. In cells of long thin stars, seven tenths of the change are complete when a star turns by half a radian over
its spacing d, independently of its natural curvature kappa. The share of the change at a curvature k is

    s(k) = tanh(k d / t) / tanh(kappa d / t),    t = `BUMP_TURN_RAD`,

which is linear for stars of small natural curvature. In a sheet that is bent to the other side, s(k) is negative.

**Supports that stretch the sheet** flatten the bumps: the tension grows with the strain, and a bump is inversely
proportional to its stiffness. If lengths exceed those of the flat cell by the strain e, the height is divided by
`1 + e / e_0`, with e_0 = `BUMP_STRAIN`.

**At supports** the corrugation is zero, and it grows over the distance in which fabric follows a tip,
`FABRIC_BEYOND_TIP`.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.previews.fields.star_cells import beside, stars_share
from asterism.previews.fields.star_values import StarValues

# turn over a spacing in which bumps come most of the way from flat to natural: cells of long thin stars
BUMP_TURN_RAD = 0.55
# strain over the flat cell at which half of a bump is left: a fit to bumps of seven equal stars on held borders
BUMP_STRAIN = 0.045
# smallest natural turn over one spacing in the formula for s(k), to avoid a division by zero
MIN_NATURAL_TURN_RAD = 1e-4


def corrugation_heights(
    waves: Floats,
    values: StarValues,
    weights: sp.csr_matrix,
    curvature: Floats,
    nearest: Ints,
    spacing: float,
) -> Floats:
    """(n,) heights in mm over the smooth surface.

    Parameters
    ----------
    waves : (n, W) the law's waves at the points.
    values : the law at the stars.
    weights : (n, S) share of each star at the points.
    curvature : (n,) 1/mm, sum of the shell's principal curvatures, positive where the plastic side is convex.
    nearest : (n,) nearest star of each point.
    spacing : mm, spacing of the stars.
    """
    flat, more = np.moveaxis(_shared(weights, values.corrugation), 1, 0)
    bent = _bent(_shared(weights, values.value["kappa"]), curvature, spacing)
    stars = np.einsum("nw,nw->n", flat + bent[:, None] * more, waves)
    near = beside(weights, values.value["kappa"][:-1], nearest)
    low, lower = beside(weights, values.tip_heights[:-1], nearest).T
    side = values.side[nearest]
    rim = side * np.minimum(side * (low + _bent(near, curvature, spacing) * lower), 0.0)
    return np.asarray(stars + (1.0 - stars_share(weights)) * rim)


def flattening(values: StarValues, weights: sp.csr_matrix, area: Floats) -> Floats:
    """(n,) factor by which the stretch of a supported sheet reduces the height of its bumps.

    Parameters
    ----------
    weights : (n, S) share of each star.
    area : (n,) area of the sheet per printed area.
    """
    lam = np.maximum(beside(weights, values.value["lam"][:-1]), values.value["lam"].min())
    return np.asarray(1.0 / (1.0 + np.maximum(np.sqrt(area) / lam - 1.0, 0.0) / BUMP_STRAIN))


def _bent(kappa: Floats, curvature: Floats, spacing: float) -> Floats:
    """(n,) `kappa s(k)` in 1/mm at curvatures k (n,): zero for a flat sheet, kappa at the natural curvature."""
    own = np.maximum(np.abs(kappa) * spacing, MIN_NATURAL_TURN_RAD)
    return np.asarray(own / spacing * np.tanh(curvature * spacing / BUMP_TURN_RAD) / np.tanh(own / BUMP_TURN_RAD))


def _shared(weights: sp.csr_matrix, values: Floats) -> Floats:
    """(n, ...) weighted mean of values (S + 1, ...) of the stars and, last, of bare fabric."""
    bare = values[-1]
    more = (values[:-1] - bare).reshape(len(values) - 1, -1)
    return np.asarray(bare + (weights @ more).reshape(-1, *values.shape[1:]))
