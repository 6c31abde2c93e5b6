"""Gaussian modulus of the shell: work of the self-stress within cells when the sheet takes Gaussian curvature.

A flat sheet of stars is self-stressed: its fabric is in tension, its arms are in compression. Gaussian curvature K
changes lengths within a cell, and the self-stress does work on that. The energy changes by the integral of -phi K. Here
phi is Airy's stress function, which vanishes at a free border and is positive among the stars. The shell includes the
part of this energy that acts between bare rim and stars, through its rest metric. The part within cells is added as a
Gaussian modulus g, of the energy -g det b per printed area,

    g = G (A11 + A12) (lam^2 - lam_bare^2) / 2,

with the membrane stiffness A of bare fabric. Periodic cells on tubes have no Gaussian curvature, so that they cannot
show g. Ribbons can, since all of their area is near a border. Without g, previews of ribbons roll up to a quarter too
little, and sheets supported at their corners rise a tenth too little.

**Planar sheets.** G is the difference of two integrals of phi, for the exact model and for the shell
(`python -m benchmarks.self_stress`). It grows with the square of the arm length l, the distance between tension and
compression. The second term compensates for the rim of the shell, whose energy is quadratic in Green's strain and
therefore too stiff at large strains:

    G = a l^2 - b d^2 (lam / lam_bare - 1),

with the spacing d, a = `gaussian_arm_factor` and b = `gaussian_strain_factor`.

**Stars with bumps** have a smaller membrane stiffness than bare fabric, so that the shell carries less of the
self-stress than the exact model. The factor `(A_bare / A_star)^n` corrects this, with n = `gaussian_softening_exponent`
fitted to ribbons and free caps. G is at most `max_gaussian_area d^2`.
"""

from __future__ import annotations

import numpy as np

from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from equilibrium.arrays import Floats


def gaussian_moduli(values: StarValues, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S,) Gaussian moduli g of the stars in N mm; the spacing is in mm."""
    stretching = values.value["a11"] + values.value["a12"]
    bumps = (stretching[-1] / stretching[:-1]) ** model.gaussian_softening_exponent
    return np.asarray(
        np.minimum(plane_areas(values, spacing, model) * bumps, model.max_gaussian_area * spacing**2) * pulls(values)
    )


def plane_areas(values: StarValues, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S,) areas G of planar sheets in mm^2."""
    lam = values.value["lam_n"]
    strain = np.maximum(lam[:-1] / lam[-1] - 1.0, 0.0)
    return np.asarray(
        np.maximum(
            model.gaussian_arm_factor * values.sizes[:, 0] ** 2 - model.gaussian_strain_factor * spacing**2 * strain,
            0.0,
        )
    )


def pulls(values: StarValues) -> Floats:
    """(S,) tension in N/mm of bare fabric that is held at the contraction of each star."""
    value = values.value
    more = np.maximum(value["lam_n"][:-1] ** 2 - value["lam_n"][-1] ** 2, 0.0)
    return np.asarray(0.5 * (value["a11"][-1] + value["a12"][-1]) * more)
