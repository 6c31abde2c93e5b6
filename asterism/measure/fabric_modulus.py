"""Young's modulus of a fabric from a strip with a weight."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.optimize import brentq

from asterism.pattern.design.design import GRAVITY_M_S2
from asterism.pattern.design.errors import DesignError


def fabric_modulus_mpa(
    mass_g: float,
    width_mm: float,
    thickness_mm: float,
    stretch: float,
    poisson: float = 0.3,
    model: Literal["neo-hookean", "incompressible"] = "neo-hookean",
) -> float:
    """The modulus `fabric.modulus_mpa` with which a hanging strip has the measured stretch.

    Of fabric with two moduli a strip gives one of them at small stretches only.

    Parameters
    ----------
    mass_g : of the weight with its clamp; a strip that is long against its width contracts freely between the clamps.
    width_mm, thickness_mm : of the released strip.
    stretch : length between two marks under the weight over their distance without it; 1.02 to 3.
    poisson, model : as in the section `[fabric]` of the design that uses the modulus.

    Raises
    ------
    DesignError
        A value is out of range.

    Notes
    -----
    The energy is that of `discrete.energies.membrane`, with unit modulus; the strip is free of stress across. The
    force is proportional to the modulus.

    Examples
    --------
    >>> round(fabric_modulus_mpa(100.0, 40.0, 0.8, 1.2), 3)
    0.175
    """
    limits = (
        ("mass_g", mass_g, 0.1, 1e5),
        ("width_mm", width_mm, 1.0, 1e4),
        ("thickness_mm", thickness_mm, 0.01, 10.0),
        ("stretch", stretch, 1.02, 3.0),
        ("poisson", poisson, 0.0, 0.49),
    )
    for name, value, low, high in limits:
        if not low <= value <= high:
            raise DesignError(name, f"must be from {low:g} to {high:g}", value)
    stress = 1e-3 * mass_g * GRAVITY_M_S2 / (width_mm * thickness_mm)
    return stress / nominal_stress(stretch, poisson, model)


def nominal_stress(stretch: float, poisson: float, model: Literal["neo-hookean", "incompressible"]) -> float:
    """Force over the released cross-section of a stretched strip, over its modulus.

    Examples
    --------
    >>> round(nominal_stress(1.001, 0.3, "neo-hookean"), 5)  # small strains follow Hooke's law
    0.001
    """
    if model == "incompressible":
        return (stretch - stretch**-2) / 3.0
    mu, lame = 0.5 / (1.0 + poisson), poisson / (1.0 - poisson**2)

    def across(width: float) -> float:
        return mu * (width**2 - 1.0) + lame * np.log(stretch * width)

    width = float(brentq(across, 1e-3, 1.0))
    return float(mu * (stretch - 1.0 / stretch) + lame * np.log(stretch * width) / stretch)
