"""Holes are bare sites among stars; rims, dents and what is beyond them are none."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.rim_arms import hole_sites, in_holes
from asterism.previews.session import Preview

TUBE = gallery.load("tube")
SPACING = TUBE.lattice.spacing_mm


def without(*stars: int) -> Design:
    data = TUBE.to_dict()
    data["stars"]["override"] = [{"star": star, "remove": True} for star in stars]
    return Design.from_dict(data)


def bordered(polygon: list[list[float]]) -> Layout:
    return layout(Design.from_dict(TUBE.to_dict() | {"border": {"polygon_mm": polygon}}))


def test_a_whole_pattern_has_no_holes() -> None:
    plan = layout(TUBE)
    assert len(hole_sites(plan)) == 0
    assert not in_holes(plan, plan.outline).any()


def test_places_nearer_to_a_removed_star_than_to_others_are_in_its_hole() -> None:
    plan = layout(without(0))
    assert hole_sites(plan) == pytest.approx(np.zeros((1, 2)), abs=1e-9)
    there = np.array([[0.0, 0.0], [0.0, 0.49 * SPACING], [0.0, 0.51 * SPACING], plan.outline[0]])
    assert in_holes(plan, there).tolist() == [True, True, False, False]


def test_a_hole_may_be_wide() -> None:
    sites = hole_sites(layout(without(*range(7))))
    assert np.sort(np.linalg.norm(sites, axis=1)) == pytest.approx([0.0, *[SPACING] * 6], abs=1e-9)


def test_what_is_open_to_the_rim_is_no_hole() -> None:
    last = layout(TUBE).star_number[-1]
    assert len(hole_sites(layout(without(int(last))))) == 0
    # from the middle to the rim
    plan = layout(TUBE)
    row = plan.star_number[(np.abs(plan.centres[:, 0]) < 1.0) & (plan.centres[:, 1] > -1.0)]
    assert len(hole_sites(layout(without(*row.tolist())))) == 0


def test_dents_are_rims() -> None:
    """The tip of a narrow dent takes a site's place, with stars all around."""
    dent = bordered([[-60, -50], [60, -50], [60, 50], [1.5, 50], [0, -3], [-1.5, 50], [-60, 50]])
    assert len(hole_sites(dent)) == 0


def test_the_fabric_of_a_hole_does_not_dip() -> None:
    """In the exact model it is 0.1 mm above the stars around it; with a rim's fall it would be 1.6 mm below them."""
    data = without(0).to_dict()
    data["stars"] |= {"length_mm": 9.0, "thickness_mm": 0.5}
    preview = Preview(Design.from_dict(data | {"border": {"rings": 2}}))
    turns = np.radians(30.0 + 60.0 * np.arange(6))
    around = preview.at(SPACING * np.column_stack([np.cos(turns), np.sin(turns)])).bumpy
    middle = around.mean(axis=0)
    normal = np.linalg.svd(around - middle)[2][2]
    above = float((preview.at(np.zeros((1, 2))).bumpy[0] - middle) @ normal * np.sign(normal[2]))
    assert abs(above) < 0.4


def test_a_star_missing_from_any_side_of_a_wide_rim_is_no_hole() -> None:
    border = {"rectangle_mm": [100.0, 90.0], "star_margin_mm": 0.8 * SPACING}
    whole = layout(Design.from_dict(TUBE.to_dict() | {"border": border}))
    assert len(hole_sites(whole)) == 0
    for axis in whole.lattice_vectors @ np.array([[0.0, -1.0], [1.0, 0.0]]):
        along = whole.centres @ axis
        for star in (along.argmin(), along.argmax()):
            data = TUBE.to_dict() | {"border": border}
            data["stars"]["override"] = [{"star": int(whole.star_number[star]), "remove": True}]
            assert len(hole_sites(layout(Design.from_dict(data)))) == 0


def test_a_site_just_beyond_the_tip_of_a_dent_is_part_of_the_rim() -> None:
    """The dent runs between stars, that site alone has none."""
    polygon = [[-60, -50], [60, -50], [60, -0.5], [3, 0], [60, 0.5], [60, 50], [-60, 50]]
    data = TUBE.to_dict() | {"border": {"polygon_mm": polygon, "star_margin_mm": 6.0}}
    plan = layout(Design.from_dict(data))
    assert np.linalg.norm(plan.centres, axis=1).min() == pytest.approx(SPACING)
    assert (np.linalg.norm(plan.centres, axis=1) < 1.01 * SPACING).sum() == 6
    assert len(hole_sites(plan)) == 0
