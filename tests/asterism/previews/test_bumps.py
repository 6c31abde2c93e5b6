"""How high bumps stand where a sheet is pulled, and how far along an arm they are looked for."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.fields.star_cells import CELL_RADIUS
from asterism.previews.fields.star_values import star_values
from asterism.previews.star_lens import BUMP_STRAIN, flattening
from tests.asterism.previews.laws import SPACING, plain_law


def of_stars(length: float):
    design = Design.from_dict(gallery.load("tube").to_dict() | {"stars": {"length_mm": length, "thickness_mm": 0.4}})
    return design, star_values(design, layout(design), plain_law())


def test_bumps_go_as_the_sheet_is_stretched_in_length() -> None:
    """Half of them are left at the strain of the model, and all where the sheet is shorter than its flat cells."""
    _, values = of_stars(8.0)
    weights, lam = sp.eye_array(len(values.sizes), format="csr"), values.value["lam"][:-1]
    for part, left in ((-0.5, 1.0), (0.0, 1.0), (1.0, 0.5), (3.0, 0.25)):
        found = flattening(values, weights, (lam * (1.0 + part * BUMP_STRAIN)) ** 2)
        np.testing.assert_allclose(found, left)


@pytest.mark.parametrize("length", [6.0, 12.0])
def test_tips_are_looked_for_within_the_cell(length: float) -> None:
    """Longer arms leave it, and the waves repeat."""
    design, values = of_stars(length)
    law, reach = plain_law(), min(length, CELL_RADIUS * SPACING)
    waves = law.waves(reach * np.asarray(design.lattice.arm_directions)).mean(axis=0)
    np.testing.assert_allclose(values.tip_heights[:-1], values.corrugation[:-1] @ waves, rtol=1e-9)
