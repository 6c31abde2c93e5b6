"""Names and units of the dimensionless responses of one unit cell; needs no cells."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.pattern.design.lattice import Lattice

# powers of the spacing and of `E2 h2` that each quantity is divided by
LENGTH_POWERS = {"kappa": -1, "bending": 2, "c3": 3, "offset_mm": 1}
FORCE_POWERS = {"bending": 1, "a11": 1, "a12": 1, "c3": 1}
WAVE_COUNT = len(CorrugationWaves.of(Lattice()))
# distance of the flat cell's stiffness from isotropy, see `cell.isotropy`
ANISOTROPY = "anisotropy"
# smallest eigenvalues on 2 x 2 stars over `E2 h2`, of the flat cell and of its natural tubes
EIGENVALUES = ("flat_eigenvalue", "rolled_eigenvalue")
WAVE_NAMES = (*(f"flat_{n}" for n in range(WAVE_COUNT)), *(f"rolled_{n}" for n in range(WAVE_COUNT)))
ROW_NAMES = (*QUANTITY_NAMES, *WAVE_NAMES, *EIGENVALUES, ANISOTROPY)


def quantity_scales(spacing_mm: float, force: float) -> Floats:
    """(Q,) units of `law_table.QUANTITY_NAMES`: a quantity is its dimensionless value times its unit.

    Parameters
    ----------
    force : N/mm, modulus times thickness of the fabric.
    """
    return np.array(
        [spacing_mm ** LENGTH_POWERS.get(name, 0) * force ** FORCE_POWERS.get(name, 0) for name in QUANTITY_NAMES]
    )
