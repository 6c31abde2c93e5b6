"""Stars of a supported sheet that may stay inverted, from the two states of their unit cells.

Flat cells of long thin arms are unstable on 2 x 2 stars: adjacent stars prefer to bump up and down in turn. Their
natural tubes are stable. Supports hold a sheet flatter than its stars curl. The smallest eigenvalue is interpolated
between both states at the curvature of the sheet. Stars may be inverted where it is negative for two adjacent stars.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Ints
from asterism.previews.state import StarState
from asterism.previews.surface.smooth_surface import smooth_surface


def stars_that_may_be_inverted(state: StarState) -> Ints:
    """Numbers of the stars that may be inverted; none on a sheet without supports, which curls."""
    layout, values = state.layout, state.values
    long = values.sizes[:, 0] >= state.model.inverted_min_arm * layout.spacing_mm
    pairs = layout.neighbours[long[layout.neighbours].all(axis=1)]
    if not state.is_supported or not len(pairs):  # most sheets: the samples of the law stay packed
        return np.empty(0, dtype=np.int64)
    kappa = values.value["kappa"][:-1]
    curvature = 2.0 * smooth_surface(state.sheet.arms.at_centres, state.x).mean_curvature
    part = curvature / np.where(kappa == 0.0, np.inf, kappa)
    table = state.law.cell_stability(state.design.fabric.stretch_xy[0])
    unstable = table.eigenvalues(values.sizes, part) < 0.0
    return np.asarray(layout.star_number[np.unique(pairs[unstable[pairs].all(axis=1)])])
