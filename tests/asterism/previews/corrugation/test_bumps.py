"""How far along an arm the tips of bumps are looked for."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.previews.fields.star_values import star_values
from asterism.previews.model import PREVIEW_MODEL
from pattern import gallery
from pattern.design.design import Design
from pattern.layout.build import layout
from tests.asterism.previews.laws import SPACING, plain_law

REACH = PREVIEW_MODEL.cell_radius


def of_stars(length: float):
    design = Design.from_dict(gallery.load("tube").to_dict() | {"stars": {"length_mm": length, "thickness_mm": 0.4}})
    return design, star_values(design, layout(design), plain_law())


@pytest.mark.parametrize("length", [6.0, 12.0])
def test_tips_are_looked_for_within_the_cell(length: float) -> None:
    """Longer arms leave it, and the waves repeat."""
    design, values = of_stars(length)
    law, reach = plain_law(), min(length, REACH * SPACING)
    waves = law.waves(reach * np.asarray(design.lattice.arm_directions)).mean(axis=0)
    np.testing.assert_allclose(values.tip_heights[:-1], values.corrugation[:-1] @ waves, rtol=1e-9)
