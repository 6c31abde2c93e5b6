"""What a sheet gains by Gaussian curvature from the stress that is in it.

A flat sheet of stars is under stress of its own: its fabric is pulled, and pushes the arms together. A Gaussian
curvature K changes lengths within a cell, and that stress does work: the energy changes by the integral of -phi K, with
phi Airy's function of the stress, which vanishes at a free border and is positive among the stars. The shell knows the
part of it that is between bare rim and stars, as the stress of its own metric. The rest, within cells, is a modulus

    g = G (A11 + A12)(lam^2 - lam_bare^2)/2,    of the energy -g det b per printed area,

with A of bare fabric. No tube shows it, hence no cell: ribbons do, which have a border wherever they are. Previews of
them roll up to a quarter too little without it, and sheets on their corners rise a tenth too little.

**G of a sheet that stays in its plane** is the difference of two integrals of phi: that of the exact model, and that of
the shell (`python -m benchmarks.self_stress`). It grows with the square of the arms' length l, over which pull and push
are apart, and has to make up for the shell's rim, which is stiff at large strains, Green's, unlike the fabric:

    G = a l^2 - b d^2 (lam / lam_bare - 1),    d being the spacing, a `gaussian_arm_factor` and b
`gaussian_strain_factor`.

**Bumps.** Stars that bump are softer to stretching than the fabric alone, and in the shell bear less of that stress
than they do. Ribbons and free caps are nearest to the exact model with `G (A_bare / A_star)^n`, n being
`gaussian_softening_exponent`, and no more than `max_gaussian_area d^2`.
"""

from __future__ import annotations

import numpy as np

from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from fem.elements.tabulation import Floats


def gaussian_moduli(values: StarValues, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S,) N mm, g of stars at a spacing in mm."""
    stretching = values.value["a11"] + values.value["a12"]
    bumps = (stretching[-1] / stretching[:-1]) ** model.gaussian_softening_exponent
    return np.asarray(
        np.minimum(plane_areas(values, spacing, model) * bumps, model.max_gaussian_area * spacing**2) * pulls(values)
    )


def plane_areas(values: StarValues, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(S,) mm^2, G of sheets that stay in their plane."""
    lam = values.value["lam_n"]
    strain = np.maximum(lam[:-1] / lam[-1] - 1.0, 0.0)
    return np.asarray(
        np.maximum(
            model.gaussian_arm_factor * values.sizes[:, 0] ** 2 - model.gaussian_strain_factor * spacing**2 * strain,
            0.0,
        )
    )


def pulls(values: StarValues) -> Floats:
    """(S,) N/mm, what bare fabric as large as the stars is pulled by."""
    value = values.value
    more = np.maximum(value["lam_n"][:-1] ** 2 - value["lam_n"][-1] ** 2, 0.0)
    return np.asarray(0.5 * (value["a11"][-1] + value["a12"][-1]) * more)
