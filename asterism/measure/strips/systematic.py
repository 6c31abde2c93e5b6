"""Effect of errors that all strips share on E1/E2. The confidence intervals do not contain it."""

from __future__ import annotations

from dataclasses import replace

from asterism.measure.strips.curvature_model import StripData
from asterism.measure.strips.parameter_estimate import estimate_parameters
from asterism.measure.strips.strip_fit import StripFit
from asterism.results.records.strips import (
    FABRIC_ERROR_MM,
    PLASTIC_ERROR_MM,
    STRETCH_ERROR_PERCENT,
    SharedErrorRecord,
)


def shared_errors(fit: StripFit) -> SharedErrorRecord:
    """Change of E1/E2 if the stretch or the thickness of fabric or plastic were larger than stated."""
    data = StripData.of(list(fit.used), fit.flat_height_mm)
    stretch = (1 - data.mismatch) ** -0.5 * (1 + STRETCH_ERROR_PERCENT / 100)
    thicker = data.thickness + PLASTIC_ERROR_MM
    changed = {
        "stretch": (replace(data, mismatch=1 - stretch**-2), fit.model),
        "fabric_thickness": (replace(data, fabric=data.fabric + FABRIC_ERROR_MM), fit.model),
        "plastic_thickness": (
            replace(data, thickness=thicker),
            replace(fit.model, thicknesses=fit.model.thicknesses + PLASTIC_ERROR_MM),
        ),
    }
    before = 1 / float(fit.estimate.parameters[0])
    return SharedErrorRecord(
        **{
            name: 100 * (1 / float(estimate_parameters(model, other).parameters[0]) / before - 1)
            for name, (other, model) in changed.items()
        }
    )
