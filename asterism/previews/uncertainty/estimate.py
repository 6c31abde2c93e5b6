"""The estimated error of a preview, from its state and the shape that is shown: the entry point of this folder."""

from __future__ import annotations

import numpy as np

from asterism.previews.law_warnings import mesh_warning, pleat_warning
from asterism.previews.search.near_zero_modes import amplitudes_percent, has_two_near_zero_modes
from asterism.previews.state import StarState
from asterism.previews.uncertainty.distance_error import distance_error_percent
from asterism.previews.uncertainty.error_estimate import ErrorEstimate
from asterism.previews.uncertainty.height_error import height_doubts, height_error_percent
from asterism.previews.uncertainty.other_forms import close_form, other_forms
from asterism.previews.uncertainty.strain_sensitivity import strain_sensitivity
from asterism.shape.diameter import diameter
from asterism.shape.shape import Shape
from equilibrium.arrays import Floats
from equilibrium.clock import Clock
from fem.search.mean_fields import mean_fields
from homogenize.cell.tube_directions import is_threefold, omitted_anisotropy
from pattern.layout.free_rotations import count_free_tilts

# share of the stars: with more of them outside the law, strongly anisotropic or inverted no estimate is available
MAX_FOREIGN_SHARE = 0.1


def estimate_error(state: StarState, shape: Shape, up: Floats, clock: Clock) -> ErrorEstimate:
    """The estimated error of a state with its near-zero modes.

    Parameters
    ----------
    shape : the sheet with its bumps, its height along z.
    up : (3,) unit vector, that direction in the pose of the shell.
    """
    equilibrium, layout, model = state.equilibrium, state.layout, state.model
    is_supported = state.is_supported
    doubts, sensitivity = None, 0.0
    # supports that let the sheet tilt leave open what counts as its height, unless weight decides
    has_height = state.design.gravity.on or not layout.pins or not count_free_tilts(layout)
    if equilibrium.is_minimum and has_height:
        doubts = clock("expected height", height_doubts, state, shape, up)
    if equilibrium.is_minimum and not is_supported:
        sensitivity = clock("contrast", strain_sensitivity, state)
    area, across = layout.area_mm2, diameter(shape.positions)
    amplitudes = amplitudes_percent(equilibrium.soft_modes, equilibrium.absolute_energy, area, across)
    means = mean_fields(state.shell) if is_supported else None
    size_ratio = means.chord / means.stretch if means else np.inf
    others = other_forms(state, across)
    sensitivity_percent = 100.0 * sensitivity / across
    distance, height = None, None
    if _is_within_experience(state):
        distance = distance_error_percent(amplitudes, others, sensitivity_percent, model)
        height = height_error_percent(doubts, across, model) if doubts else None
    return ErrorEstimate(
        distance_percent=distance,
        height_percent=height,
        diameter_mm=across,
        amplitudes_percent=amplitudes,
        sensitivity_percent=sensitivity_percent,
        other_forms=tuple(others),
        close_form=close_form(others, model.energy_uncertainty),
        size_ratio=size_ratio,
        has_two_near_zero_modes=has_two_near_zero_modes(amplitudes, model),
        energy_uncertainty=model.energy_uncertainty,
        height_doubts=doubts,
    )


def _is_within_experience(state: StarState) -> bool:
    """Whether the estimate holds: it comes from three-armed stars within their law, and holds for stable cells."""
    inverted = int(np.count_nonzero(state.layout.star_branch < 0))
    foreign = max(len(state.values.outside), len(state.values.strongly_anisotropic), inverted)
    lattice = state.design.lattice
    is_turned = is_threefold(lattice) and bool(omitted_anisotropy(lattice))
    is_known = not (is_turned or mesh_warning(state.law) or pleat_warning(state.law))
    return is_known and foreign <= MAX_FOREIGN_SHARE * len(state.layout.centres)
