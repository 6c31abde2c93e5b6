"""Estimated error of the preview of a motif: rms distance to the exact shape, in % of the diameter.

As for stars (`asterism.previews.uncertainty.distance_error`), with a floor of their own:

    error^2 = floor^2 + (share a)^2 + max P_j d_j^2.

The floor is that of the shell: it has no rods that end at the rim, where the exact sheet bends more or less than its
cell. The error of the height has a further part in % of the height, for the same reason, and one in mm, which counts on
low sheets. `python -m benchmarks.motif_previews` states how many sheets and heights the estimates cover.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from asterism.previews.search.near_zero_modes import amplitudes_percent, has_two_near_zero_modes
from asterism.previews.state import AnyPreviewState
from asterism.previews.uncertainty.distance_error import distance_error_percent
from asterism.previews.uncertainty.error_estimate import ErrorEstimate
from asterism.previews.uncertainty.height_error import height_doubts, height_error_percent
from asterism.previews.uncertainty.other_forms import close_form, other_forms
from asterism.shape.diameter import diameter
from asterism.shape.shape import Shape
from equilibrium.arrays import Floats
from equilibrium.clock import Clock
from fem.search.mean_fields import mean_fields
from pattern.layout.free_rotations import count_free_tilts

# share of the places on rods: with more of them outside the law no estimate is available
MAX_OUTSIDE_SHARE = 0.1


@dataclass(frozen=True)
class MotifErrorModel:
    """Constants of the estimate for motifs. The percentages are judged from a few sheets of `benchmarks.motif_shells`,
    and not fitted.

    Attributes
    ----------
    floor_percent : of the distance, in % of the diameter.
    height_percent : of the height, in % of it.
    height_mm : of the height. The median of the absolute errors of the working sheets of `benchmarks.motif_previews`
        whose form is the exact one: 0.2, 0.4, 1.2, 1.9, 2.9 and 3.8 mm.
    """

    floor_percent: float = 0.8
    height_percent: float = 10.0
    height_mm: float = 1.5


MOTIF_ERROR = MotifErrorModel()


def estimate_motif_error(state: AnyPreviewState, shape: Shape, up: Floats, clock: Clock) -> ErrorEstimate:
    """The estimated error of a state with its near-zero modes.

    Parameters
    ----------
    shape : the sheet, its height along z.
    up : (3,) unit vector, that direction in the pose of the shell.
    """
    equilibrium, layout = state.equilibrium, state.layout
    model = replace(state.model, floor_percent=MOTIF_ERROR.floor_percent)
    is_supported = state.is_supported
    has_height = state.design.gravity.on or not layout.pins or not count_free_tilts(layout)
    doubts = None
    if equilibrium.is_minimum and has_height:
        doubts = clock("expected height", height_doubts, state, shape, up)
    across = diameter(shape.positions)
    amplitudes = amplitudes_percent(equilibrium.soft_modes, equilibrium.absolute_energy, layout.area_mm2, across)
    means = mean_fields(state.shell) if is_supported else None
    size_ratio = means.chord / means.stretch if means else np.inf
    others = other_forms(state, across)
    distance, height = None, None
    if len(state.values.outside) <= MAX_OUTSIDE_SHARE * state.values.places:
        distance = distance_error_percent(amplitudes, others, model=model)
        near = height_error_percent(doubts, across, model) if doubts else None
        if doubts is not None and near is not None:
            parts = near, MOTIF_ERROR.height_percent, 100.0 * MOTIF_ERROR.height_mm / doubts.height
            height = math.hypot(*parts)
    return ErrorEstimate(
        distance_percent=distance,
        height_percent=height,
        diameter_mm=across,
        amplitudes_percent=amplitudes,
        sensitivity_percent=0.0,
        other_forms=tuple(others),
        close_form=close_form(others, model.energy_uncertainty),
        size_ratio=size_ratio,
        has_two_near_zero_modes=has_two_near_zero_modes(amplitudes, model),
        energy_uncertainty=model.energy_uncertainty,
        height_doubts=doubts,
    )
