"""Tables that contradict the formula, and mistakes that explain the contradiction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.measure.strips.agreement import FALSE_ALARM, lack_of_fit
from asterism.measure.strips.curvature_model import CurvatureModel, StripData
from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.parameter_estimate import ParameterEstimate, estimate_parameters

# tables that are more probable than this are not examined: small errors of the thickness explain them
_MAX_PROBABILITY_OF_MISTAKE = 1e-6
# larger deviations of a kind, as parts of its curvature, are not errors of the thickness
_MAX_KIND_DEVIATION = 0.5


def check_mistakes(model: CurvatureModel, estimate: ParameterEstimate, data: StripData, chance: float | None) -> None:
    """Refuse a table that agrees with the formula only after the correction of a mistake, or not at all.

    Parameters
    ----------
    chance : probability of such strips if the model holds; None if it is not known.

    Raises
    ------
    UndeterminedMaterialError
        The table contradicts the formula; the message names the mistake if one is found.
    """
    if chance is None or chance >= _MAX_PROBABILITY_OF_MISTAKE:
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
    if estimate.common.with_fabric > _MAX_KIND_DEVIATION:
        raise UndeterminedMaterialError(
            f"strips of different thickness contradict the formula, by {100 * estimate.common.with_fabric:.0f} % of "
            "their curvature: check thickness_mm and fabric_thickness_mm, and to which side peeled strips bend"
        )


def _agrees(model: CurvatureModel, other: StripData) -> bool:
    """Whether the corrected readings agree with the model."""
    try:
        changed = CurvatureModel.of(other, model.formula, model.kappa_bar)
        estimate = estimate_parameters(changed, other)
    except (UndeterminedMaterialError, np.linalg.LinAlgError):
        return False
    chance = lack_of_fit(changed, estimate, other)
    return estimate.parameters[0] > 0 and chance is not None and chance >= FALSE_ALARM
