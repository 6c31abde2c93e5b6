"""The dimensionless responses of one unit cell, as a row of numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.sample_rows import sample_quantities
from asterism.homogenize.universal.groups import GROUP_KEYS, REFERENCE_MODULUS_MPA, REFERENCE_SPACING_MM
from asterism.homogenize.universal.row_names import ANISOTROPY, ROW_NAMES, quantity_scales

# cells of stars that keep their symmetry are isotropic up to rounding; those whose fabric buckles between stars are not
MAX_ANISOTROPY = 0.02
# natural curvature times spacing, above which stars wrap and a law has no use
MAX_USEFUL_CURL = 3.0


def cell_row(sample: Mapping[str, Any], groups: Floats) -> Floats:
    """(R,) the dimensionless values of `ROW_NAMES`, from the sample of a reference cell with these groups (G,)."""
    stretch, plate = (float(groups[GROUP_KEYS.index(key)]) for key in ("stretch", "fabric"))
    force, d = REFERENCE_MODULUS_MPA * plate * REFERENCE_SPACING_MM, REFERENCE_SPACING_MM
    quantities = sample_quantities(dict(sample), stretch) / quantity_scales(d, force)
    waves = np.array(sample["relief"], dtype=float) / np.array([[d], [d**2]])
    eigenvalues = [sample["supercell_eigenvalue"] / force, min(sample["natural_supercell_eigenvalue"]) / force]
    return np.concatenate([quantities, waves.ravel(), eigenvalues, [sample["anisotropy"]]])


def row_problem(row: Floats, bump: float) -> str | None:
    """Why a cell cannot make the law, in one line; None if it can.

    Parameters
    ----------
    bump : smallest height of the star's centre over its tips on the natural tubes, over the spacing.
    """
    values = dict(zip(ROW_NAMES, row, strict=True))
    if not np.isfinite(row).all() or not all(values[name] > 0.0 for name in ("lam", "lam_n", "bending", "a11")):
        return "a response is no answer"
    if values[ANISOTROPY] > MAX_ANISOTROPY:
        return "the fabric buckles between the stars"
    if not bump > 0.0:
        return "the star is not up"
    if abs(values["kappa"]) > MAX_USEFUL_CURL:
        return "the star wraps"
    return None
