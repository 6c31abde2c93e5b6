"""Bumps stand as high as the pull and the rim let them; arms share the fabric beside them, also over edits."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.previews.fields.star_cells import CELL_RADIUS
from asterism.previews.fields.star_values import star_values
from asterism.previews.sheet import (
    Arms,
    Sheet,
    arm_shares,
    corrugation_heights,
)
from tests.asterism.previews.laws import SPACING, plain_law


def of_stars(length: float):
    design = Design.from_dict(gallery.load("tube").to_dict() | {"stars": {"length_mm": length, "thickness_mm": 0.4}})
    return design, star_values(design, layout(design), plain_law())


@pytest.mark.parametrize("length", [6.0, 12.0])
def test_tips_are_looked_for_within_the_cell(length: float) -> None:
    """Longer arms leave it, and the waves repeat."""
    design, values = of_stars(length)
    law, reach = plain_law(), min(length, CELL_RADIUS * SPACING)
    waves = law.waves(reach * np.asarray(design.lattice.arm_directions)).mean(axis=0)
    np.testing.assert_allclose(values.tip_heights[:-1], values.corrugation[:-1] @ waves, rtol=1e-9)


def test_the_bare_rim_lies_as_low_as_the_tips() -> None:
    _, values = of_stars(8.0)
    weights = sp.csr_matrix(np.array([[0.2], [1e-9]]) * np.eye(1, len(values.sizes)))
    kappa = values.value["kappa"][0]
    waves, curvature = np.zeros((2, len(plain_law().waves))), np.full(2, kappa)
    nearest = np.zeros(2, dtype=np.int64)
    heights = corrugation_heights(waves, values, weights, curvature, nearest, SPACING)
    tip = values.tip_heights[0] @ np.array([1.0, kappa])
    assert tip < 0.0
    assert heights == pytest.approx([0.8 * tip, tip])  # far from all stars too


DESIGN = Design.from_dict(
    {
        "stars": {"length_mm": 9.0},
        "border": {"rings": 2},
        "pins": [{"points_mm": [[0.0, 25.0], [20.0, -15.0], [-20.0, -15.0]], "scale": 0.8}],
    }
)
PLAN = layout(DESIGN)
SHEET = Sheet.of(DESIGN, PLAN, plain_law())
POINTS = np.random.default_rng(0).uniform(-30.0, 30.0, (400, 2))


def arms_with(lengths: dict[int, float]) -> Arms:
    """Arms of the design with other lengths (mm) of some stars, by their numbers."""
    sites = PLAN.sheet_sites[list(lengths)]
    sizes = [[length, np.nan, np.nan] for length in lengths.values()]
    return Arms(layout(with_painted_stars(DESIGN, sites, sizes)), SHEET.space)


LENGTHS = st.dictionaries(st.integers(0, len(PLAN.sheet_sites) - 1), st.floats(0.0, 11.0), min_size=1, max_size=6)


@pytest.mark.slow
@settings(max_examples=4)
@given(st.lists(LENGTHS, min_size=1, max_size=3))
def test_shares_that_follow_edits_are_those_computed_anew(edits: list[dict[int, float]]) -> None:
    """Also if stars or arms disappear and come back, and if the longest arm changes."""
    followed = arm_shares(SHEET.arms, POINTS)
    for lengths in edits:
        arms = arms_with(lengths)
        assume(np.array_equal(arms.layout.pin_points, PLAN.pin_points))  # a support beside an arm is moved onto it
        followed, anew = arm_shares(arms, POINTS, followed), arm_shares(arms, POINTS)
        assert followed.along.toarray() == pytest.approx(anew.along.toarray(), abs=1e-12)
