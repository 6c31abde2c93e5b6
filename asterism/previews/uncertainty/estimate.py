"""The estimated error of a preview of stars, from its state and the shape that is shown."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.homogenize.cell.tube_directions import is_threefold, omitted_anisotropy
from asterism.previews.law_warnings import mesh_warning, pleat_warning
from asterism.previews.state import StarState
from asterism.previews.uncertainty.error_estimate import ErrorEstimate
from asterism.previews.uncertainty.error_sources import error_sources
from asterism.shape.shape import Shape

# share of the stars: with more of them outside the law, strongly anisotropic or inverted no estimate is available
MAX_FOREIGN_SHARE = 0.1


def estimate_error(state: StarState, shape: Shape, up: Floats, clock: Clock) -> ErrorEstimate:
    """The estimated error of a state with its near-zero modes; arguments as for `error_sources`."""
    return ErrorEstimate.of(error_sources(state, shape, up, clock), state.model, _is_within_experience(state))


def _is_within_experience(state: StarState) -> bool:
    """Whether the estimate holds: it comes from three-armed stars within their law, and holds for stable cells."""
    inverted = int(np.count_nonzero(state.layout.star_branch < 0))
    foreign = max(len(state.values.outside), len(state.values.strongly_anisotropic), inverted)
    lattice = state.design.lattice
    is_turned = is_threefold(lattice) and bool(omitted_anisotropy(lattice))
    is_known = not (is_turned or mesh_warning(state.law) or pleat_warning(state.law))
    return is_known and foreign <= MAX_FOREIGN_SHARE * len(state.layout.centres)
