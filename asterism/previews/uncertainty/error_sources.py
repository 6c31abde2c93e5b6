"""The quantities of a preview from which its error is estimated, for any kind of pattern."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.fem.search.linear_response import STIFFNESSES, rms_of, stiffness_responses
from asterism.fem.search.mean_fields import mean_fields
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import count_free_tilts
from asterism.previews.search.near_zero_modes import amplitudes_percent
from asterism.previews.state import AnyPreviewState
from asterism.previews.uncertainty.height_doubts import HeightDoubts, height_doubts
from asterism.previews.uncertainty.other_forms import OtherForm, other_forms
from asterism.shape.shape import Shape


@dataclass(frozen=True)
class ErrorSources:
    """Distances are rms over the sheet, in % of the diameter.

    Attributes
    ----------
    diameter_mm : of the shape.
    amplitudes_percent : (k,) of the near-zero modes, the largest first.
    stiffness_percent : (4,) responses per relative error of each of `fem.search.linear_response.STIFFNESSES`.
    size_ratio : size that the supports allow over the natural size; inf unless two points are fixed in all directions.
    other_forms : minima that are not the one shown, the lowest first.
    height : of the height; None without a certain height.
    """

    diameter_mm: float
    amplitudes_percent: Floats
    stiffness_percent: Floats = field(default_factory=lambda: np.zeros(len(STIFFNESSES)))
    size_ratio: float = np.inf
    other_forms: tuple[OtherForm, ...] = ()
    height: HeightDoubts | None = None

    @property
    def narrowing(self) -> float:
        """By how much of the natural size the supports hold the sheet narrower; 0 for other sheets.

        Examples
        --------
        >>> ErrorSources(100.0, np.array([6.0, 4.0]), size_ratio=0.75).narrowing
        0.25
        """
        return max(1.0 - self.size_ratio, 0.0)


def error_sources(state: AnyPreviewState, shape: Shape, up: Floats, clock: Clock) -> ErrorSources:
    """The sources of a state with its near-zero modes; the factor holds the Hessian at its equilibrium.

    Parameters
    ----------
    shape : as it is shown, its height along z.
    up : (3,) unit vector, that direction in the pose of the shell.
    """
    equilibrium, layout, shell = state.equilibrium, state.layout, state.shell
    across, heights, shares = diameter(shape.positions), None, np.zeros(len(STIFFNESSES))
    if equilibrium.is_minimum:
        with clock("expected error"):
            moves = stiffness_responses(shell, equilibrium.x, state.factor)
        shares = 100.0 / across * rms_of(shell, equilibrium.x, moves)
        # supports that let the sheet tilt leave open what counts as its height, unless weight decides
        if state.design.gravity.on or not layout.pins or not count_free_tilts(layout):
            with clock("expected height"):
                heights = height_doubts(state, shape, up, moves)
    ratio = np.inf
    if state.is_supported:
        means = mean_fields(shell)
        ratio = means.chord / means.stretch
    return ErrorSources(
        across,
        amplitudes_percent(equilibrium.soft_modes, equilibrium.absolute_energy, layout.area_mm2, across),
        shares,
        ratio,
        tuple(other_forms(state, across)),
        heights,
    )
