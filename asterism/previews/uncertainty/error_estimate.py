"""The estimated error of a preview as a value."""

from __future__ import annotations

from dataclasses import dataclass

from asterism.previews.uncertainty.height_error import HeightDoubts
from asterism.previews.uncertainty.other_forms import OtherForm
from equilibrium.arrays import Floats


@dataclass(frozen=True)
class ErrorEstimate:
    """Estimated error of a preview, and what it is computed from.

    Attributes
    ----------
    distance_percent : rms distance to the exact shape, in % of the diameter; None if no estimate is available.
    height_percent : error of the height in % of it; None if no estimate is available.
    diameter_mm : of the shape.
    amplitudes_percent : (k,) of the near-zero modes, in % of the diameter, the largest first.
    sensitivity_percent : to size-dependent strain error, in % of the diameter; 0 for equal stars and supported sheets.
    other_forms : minima that are not the one shown, the lowest first.
    close_form : the one of these that the sheet may rest in as well.
    size_ratio : size that the supports allow over the natural size; inf for free sheets.
    has_two_near_zero_modes : another form is likely.
    energy_uncertainty : of the law, as a share of the energy.
    height_doubts : contributions to the error of the height; None without a certain height.
    """

    distance_percent: float | None
    height_percent: float | None
    diameter_mm: float
    amplitudes_percent: Floats
    sensitivity_percent: float
    other_forms: tuple[OtherForm, ...]
    close_form: OtherForm | None
    size_ratio: float
    has_two_near_zero_modes: bool
    energy_uncertainty: float
    height_doubts: HeightDoubts | None
