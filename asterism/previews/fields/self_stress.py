"""Gaussian modulus of the shell: work of the self-stress within cells when the sheet takes Gaussian curvature.

A flat sheet of stars is self-stressed: its fabric is in tension, its arms are in compression. Gaussian curvature K
changes lengths within a cell, and the self-stress does work on that. The energy changes by the integral of -phi K. Here
phi is Airy's stress function, which vanishes at a free border and is positive among the stars. The shell includes the
part of this energy that acts between bare rim and stars, through its rest metric. The part within cells is added as a
Gaussian modulus g, of the energy -g det b per printed area,

    g = a d^2 (A11 + A12) (lam^2 - lam_bare^2) / 2,    a = `gaussian_area`,

with the spacing d and the membrane stiffness A of bare fabric. It is multiplied by the squared share of the stars, so
that its slope vanishes at the border. Periodic cells on tubes have no Gaussian curvature, so
that they cannot show g. Ribbons can, since all of their area is near a border. Without g, previews of ribbons roll up
to a quarter too little, and sheets supported at their corners rise a tenth too little.

**Planar sheets.** The area a d^2 is the difference of two integrals of phi, for the exact model and for the shell.
For stars whose membrane is as stiff as bare fabric, it is 3 to 5 mm^2
at arms of 4.5 to 8 mm and the paper's spacing. Stars with bumps are softer, but cannot buckle in a planar sheet of the
exact model, which says nothing about them. a was fitted to ribbons and free caps, and is at the upper end of what flat
sheets give.

On fabric with a grain the tension differs between directions, and one number does not describe its work: sheets are
nearer to the exact model without it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density, gaussian_limits
from asterism.fem.shell.fields import Fields
from asterism.previews.fields.star_places import StarPlaces
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# largest modulus, as a share of the one at which the bending energy becomes indefinite
MAX_GAUSSIAN_SHARE = 0.95


def self_stress(fields: Fields, at: StarPlaces) -> Fields:
    """The fields with the Gaussian modulus -g."""
    if at.has_grain:
        return fields
    assert isinstance(fields.density, Density)
    moduli = gaussian_moduli(at.values, at.spacing_mm, at.model)
    saved = at.stars * np.asarray(at.weights @ moduli).reshape(at.shape)
    most = -gaussian_limits(np.asarray(fields.density.stiffness)[..., 3:, 3:])[0]
    return replace(fields, gaussian=-np.minimum(saved, MAX_GAUSSIAN_SHARE * most))


def gaussian_moduli(values: StarValues, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S,) Gaussian moduli g of the stars in N mm; the spacing is in mm. Bare sites have none."""
    has_arms = values.sizes[:, 0] > 0.0
    return np.asarray(model.gaussian_area * spacing**2 * has_arms * pulls(values))


def pulls(values: StarValues) -> Floats:
    """(S,) tension in N/mm of bare fabric that is held at the contraction of each star."""
    value = values.value
    more = np.maximum(value["lam_n"][:-1] ** 2 - value["lam_n"][-1] ** 2, 0.0)
    return np.asarray(0.5 * (value["a11"][-1] + value["a12"][-1]) * more)
