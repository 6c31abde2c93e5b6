"""Stars prefer some axes of rolling: the sixfold term of the shell's energy (`fem.shell.density`).

`b = -kappa lam^2 t t^T` has `Re[((b11 - b22)/2 + i b12)^3] = -(kappa lam^2)^3 cos(6 phi)/8` if t is at the angle phi to
the x axis. The law's `c3` is `4 (psi_0 - psi_30)/kappa^3` with angles from y. These are phi = 90 and 120 degrees, where
cos(6 phi) is -1 and 1. So the factor of the term per printed area is `c3 / lam^6`, in N mm^2, times `sixfold_factor`,
enlarged by the part that the saturation removes at the natural curvature.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.fem.shell.density import Density
from asterism.fem.shell.fields import Fields
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.previews.fields.star_places import StarPlaces

# saturation curvature of the sixfold term over the natural one; origin unknown
SATURATION = 3.0
# lower limit of the saturation curvature, as a turn over one spacing
MIN_SATURATION_TURN_RAD = 1e-3 * DEFAULT_SPACING_MM


def roll_axis(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the sixfold term."""
    assert isinstance(fields.density, Density)
    natural = 0.5 * np.abs(at.mean("kappa")) * at.lam**2
    density = replace(
        fields.density,
        sixfold=at.model.sixfold_factor * (1.0 + 1.0 / SATURATION**2) * at.mean("c3") / at.lam**6,
        orientation=np.zeros(at.shape),
        saturation=np.maximum(SATURATION * natural, MIN_SATURATION_TURN_RAD / at.spacing_mm),
    )
    return replace(fields, density=density)
