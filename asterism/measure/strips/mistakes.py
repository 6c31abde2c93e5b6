"""Tables whose strips contradict the formula, and mistakes that would explain it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.measure.strips.agreement import FALSE_ALARM, lack_of_fit
from asterism.measure.strips.curvature_model import CurvatureModel, StripData
from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.parameter_estimate import ParameterEstimate, estimate_parameters

# thicknesses that are off by a little do not look so unlikely, and mend at the same time by a mistake's correction
_SURE = 1e-6
# by such a part of the curvature no thickness is off
_MOST_OFF = 0.5


def check_mistakes(model: CurvatureModel, found: ParameterEstimate, data: StripData, chance: float | None) -> None:
    """Refuse tables that make sense only without a mistake, or not at all.

    Parameters
    ----------
    chance : of such strips, if the model holds.

    Raises
    ------
    UndeterminedMaterialError
        With the mistake, if one explains all.
    """
    if chance is None or chance >= _SURE:
        return
    turned = replace(data, curvature=np.where(data.peeled, -1.0, 1.0) * data.curvature)
    swapped = replace(data, thickness=data.fabric, fabric=data.thickness)
    if data.peeled.any() and _agrees(model, turned):
        raise UndeterminedMaterialError(
            "all would agree if the peeled strips bent to the other side: if they do, give their curvatures with a "
            "minus, in peeled_curvature_per_mm"
        )
    if _agrees(model, swapped):
        raise UndeterminedMaterialError(
            "all would agree if thickness_mm and fabric_thickness_mm were swapped: check the two columns"
        )
    if found.common.with_fabric > _MOST_OFF:
        raise UndeterminedMaterialError(
            f"strips of different thickness contradict the formula, by {100 * found.common.with_fabric:.0f} % of their "
            "curvature: check thickness_mm and fabric_thickness_mm, and to which side peeled strips bend"
        )


def _agrees(model: CurvatureModel, other: StripData) -> bool:
    """Whether readings without the mistake agree with the model."""
    try:
        changed = CurvatureModel.of(other, model.formula, model.kappa_bar)
        found = estimate_parameters(changed, other)
    except (UndeterminedMaterialError, np.linalg.LinAlgError):
        return False
    chance = lack_of_fit(changed, found, other)
    return found.parameters[0] > 0 and chance is not None and chance >= FALSE_ALARM
