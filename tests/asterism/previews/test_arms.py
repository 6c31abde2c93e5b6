"""Arms keep their length and share the fabric beside them; bumps stand as high as the pull and the rim let them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from asterism.fem.search.simple_shapes import SimpleShape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import distance_to_outline
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.fields.star_cells import CELL_RADIUS
from asterism.previews.fields.star_values import star_values
from asterism.previews.session import Preview
from asterism.previews.sheet import Arms, Sheet, arm_shares, corrugation_heights
from tests.asterism.previews.designs import edited
from tests.asterism.previews.laws import SPACING, plain_law
from tests.homogenize.cells import design as cell_design
from tests.homogenize.cells import relaxed

EDGE = 1.15


def free_sheet(**sections: Any) -> Preview:
    return Preview(edited("tube", border={"rings": 2}, **sections), plain_law())


@pytest.mark.slow
def test_arms_keep_their_length_where_the_sheet_shrinks() -> None:
    preview = free_sheet()
    plan = preview.sheet.layout
    one, other = preview.at(plan.centres).bumpy[plan.arm_star], preview.at(plan.arm_tip).bumpy
    smooth = preview.at(plan.arm_tip).smooth - preview.at(plan.centres).smooth[plan.arm_star]
    assert np.median(np.linalg.norm(smooth, axis=1) / plan.arm_length) < 0.9
    assert np.median(np.linalg.norm(other - one, axis=1) / plan.arm_length) == pytest.approx(1.0, abs=0.04)


@pytest.mark.slow
@pytest.mark.parametrize(("length", "off"), [(10.0, 0.28), (5.0, 0.26)])
def test_fabric_beside_arms_follows_them_as_in_a_flat_cell(length: float, off: float) -> None:
    cell, flat = relaxed(length, 0.4, EDGE)
    count, lattice = cell.mesh.n_base, cell.design.lattice
    from_first = cell.printed[:count] - cell.printed[cell.mesh.star_vertices[0]]
    nearest = lattice.sites.nearest(from_first + np.asarray(lattice.origin_mm))
    offset = from_first - nearest @ np.asarray(lattice.vectors)
    right = flat.state.positions[:count, :2] - cell.printed[:count] @ flat.deformation.T
    weights = cell.weights / cell.weights.sum()
    preview = Preview(cell_design(length, 0.4, border={"rings": 3}, fabric={}), plain_law())
    arms = Arms(preview.sheet.layout, preview.sheet.space)
    moved = arm_shares(arms, cKDTree(offset)) @ ((1.0 - flat.stretch) * length * arms.direction)
    right, moved = right - weights @ right, moved - weights @ moved
    assert np.sqrt(weights @ ((moved - right) ** 2).sum(axis=1)) < off * np.sqrt(weights @ (right**2).sum(axis=1))


def test_what_ends_at_a_held_side_and_what_is_pinned_stay() -> None:
    """Arms that the border cuts, and a pin in the middle of an arm."""
    cut = {"border": {"rectangle_mm": [80.0, 60.0], "star_margin_mm": 2.0}, "stars": {"length_mm": 12.0}}
    held = {"pins": [{"where": "border", "scale": 0.8}]}
    preview = Preview(Design.from_dict(gallery.load("dome").to_dict() | cut | held), plain_law())
    mesh = mesh_layout(preview.sheet.layout, 2.5)
    places = preview.at(mesh.points)
    corners = places.smooth[mesh.triangles], places.bumpy[mesh.triangles]
    smooth, bumpy = (np.linalg.norm(np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]), axis=1) for c in corners)
    assert distance_to_outline(preview.sheet.layout.arm_tip, preview.sheet.layout.outline).min() < 1.0
    assert (bumpy / smooth).max() < 2.0
    pinned = free_sheet(pins=[{"points_mm": [[0.0, -4.0], [20.0, 20.0], [-20.0, 20.0]], "scale": 0.8}])
    shares = arm_shares(pinned.sheet.arms, cKDTree(np.array([[0.0, -4.0]])))
    assert shares.max() < 1e-9


def test_tips_lie_further_out_by_what_the_sheet_shrinks_and_no_further_where_it_is_wider() -> None:
    """Along the print they move by more: that shrinks too."""
    preview = free_sheet()
    plan, arms, space = preview.sheet.layout, preview.sheet.arms, preview.sheet.space
    narrow, wide = (SimpleShape("flat").positions(space, np.zeros(2), stretch) for stretch in (0.8, 1.1))
    assert arms.moves(narrow) == pytest.approx(0.25 * plan.arm_length[:, None] * arms.direction)
    assert not arms.moves(wide).any()


def of_stars(length: float):
    design = edited("tube", stars={"length_mm": length, "thickness_mm": 0.4})
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
TREE = cKDTree(np.random.default_rng(0).uniform(-30.0, 30.0, (400, 2)))


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
    last, followed = SHEET.arms, arm_shares(SHEET.arms, TREE)
    for lengths in edits:
        arms = arms_with(lengths)
        assume(np.array_equal(arms.layout.pin_points, PLAN.pin_points))  # a support beside an arm is moved onto it
        followed, anew = arm_shares(arms, TREE, (last, followed)), arm_shares(arms, TREE)
        assert followed.toarray() == pytest.approx(anew.toarray(), abs=1e-12)
        last = arms
