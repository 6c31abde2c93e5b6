"""Estimated error of the preview of a motif: rms distance to the exact shape, in % of the diameter.

As for stars (`asterism.previews.uncertainty.distance_error`), with a floor of their own in place of the mesh error.

The floor is that of the shell: it has no rods that end at the rim, where the exact sheet bends more or less than its
cell. The error of the height has a further part in % of the height, for the same reason, and one in mm, which counts on
low sheets.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.previews.state import AnyPreviewState
from asterism.previews.uncertainty.error_estimate import ErrorEstimate
from asterism.previews.uncertainty.error_sources import error_sources
from asterism.shape.shape import Shape

# share of the places on rods: with more of them outside the law no estimate is available
MAX_OUTSIDE_SHARE = 0.1


@dataclass(frozen=True)
class MotifErrorModel:
    """Constants of the estimate for motifs. The percentages are judged from a few sheets, and not fitted.

    Attributes
    ----------
    floor_percent : of the distance, in % of the diameter.
    height_percent : of the height, in % of it.
    height_mm : of the height. The median of the absolute errors of six sheets whose form is the exact one: 0.2, 0.4,
        1.2, 1.9, 2.9 and 3.8 mm.
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
    model = replace(state.model, mesh_error_percent=MOTIF_ERROR.floor_percent)
    is_known = len(state.values.outside) <= MAX_OUTSIDE_SHARE * state.values.places
    estimate = ErrorEstimate.of(error_sources(state, shape, up, clock), model, is_known)
    doubts, near = estimate.sources.height, estimate.height_percent
    if doubts is None or near is None:
        return estimate
    parts = near, MOTIF_ERROR.height_percent, 100.0 * MOTIF_ERROR.height_mm / doubts.height
    return replace(estimate, height_percent=math.hypot(*parts))
