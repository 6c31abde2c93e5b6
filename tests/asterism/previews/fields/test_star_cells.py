"""Shares of the stars: they add up, follow the cells, and end at the rim."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.homogenize.law.plan import law_coordinates
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.fields.star_cells import HALF_WAY, MIN_WIDTH, Shares, StarCells
from asterism.previews.model import PREVIEW_MODEL
from tests.asterism.previews.designs import edited

TUBE = gallery.load("tube")
PLAN = layout(TUBE)
COUNT = len(PLAN.centres)


def test_a_star_rules_its_own_centre() -> None:
    weights = Shares(StarCells(PLAN, TUBE.lattice), PLAN.centres).wide.toarray()
    # a Gaussian of a fifth of the spacing has 0.956 of its weight in the cell's inner circle, 0.985 in its outer one
    assert np.diag(weights)[:7] == pytest.approx(0.97, abs=0.01)
    assert (weights.argmax(axis=1) == np.arange(len(PLAN.centres))).all()


def test_a_wide_rim_is_bare() -> None:
    border = {"rectangle_mm": [140.0, 140.0], "star_margin_mm": 40.0}
    design = Design.from_dict(TUBE.to_dict() | {"border": border})
    plan = layout(design)
    cells = StarCells(plan, design.lattice)
    x = np.linspace(0.0, 70.0, 200)
    share = Shares(cells, np.column_stack([x, np.zeros(200)])).wide.toarray().sum(axis=1)
    assert (np.diff(share) < 1e-9).all()
    outermost = plan.centres[:, 0].max() + design.lattice.spacing_mm
    assert share[0] == pytest.approx(1.0)
    assert (share[x > outermost + 3 * cells.widths_mm[0]] == 0.0).all()


def test_inside_the_shares_add_up_and_have_no_jumps() -> None:
    cells = StarCells(PLAN, TUBE.lattice)
    line = np.column_stack([np.linspace(-20, 20, 2001), np.zeros(2001)])
    weights = Shares(cells, line).wide.toarray()
    assert weights.sum(axis=1) == pytest.approx(1.0)
    assert np.abs(np.diff(weights, axis=0)).max() < 0.01
    # equal neighbours have equal shares half way between them
    middle = Shares(cells, PLAN.centres[PLAN.sample_pairs].mean(axis=1)[:6]).wide.toarray()
    top = np.sort(middle, axis=1)[:, -2:]
    assert top[:, 0] == pytest.approx(top[:, 1], abs=0.03)


def test_a_removed_star_is_bare_fabric() -> None:
    design = edited("tube", stars={"override": [{"star": 0, "remove": True}]})
    plan = layout(design)
    assert len(plan.centres) == len(PLAN.centres) - 1
    assert Shares(StarCells(plan, design.lattice), np.zeros((1, 2))).wide.sum() < 0.3


def test_long_arms_reach_out_of_their_cells_and_short_ones_do_not() -> None:
    cells = StarCells(PLAN, TUBE.lattice)
    corner = PLAN.outline[np.abs(PLAN.outline).argmax(axis=0)[0]]
    line = np.linspace(0.0, 1.0, 400)[:, None] * corner
    shares = Shares(cells, line)
    spacing = TUBE.lattice.spacing_mm
    narrow = MIN_WIDTH / PREVIEW_MODEL.smoothing_per_arm
    parts = (0.9 * narrow, 0.5 * (narrow + HALF_WAY), 0.6)
    short, between, long = (shares(np.full(COUNT, part * spacing)) for part in parts)
    assert (short != shares.narrow).nnz == 0 and (long != shares.wide).nnz == 0
    half = 0.5 * (short + long).toarray()
    assert between.toarray() == pytest.approx(half)
    # the rim has bare fabric, more of it where arms are short
    rim = [float(one[-40:].sum(axis=1).mean()) for one in (short, between, long)]
    assert rim[0] < rim[1] < rim[2] < 1.0
    # where arms differ, a place goes by those around it
    mixed = np.where(np.arange(COUNT) == 0, 10.0, 3.0)
    assert shares(mixed)[0].toarray() == pytest.approx(long[0].toarray(), abs=0.1)
    assert shares(mixed)[-1].toarray() == pytest.approx(short[-1].toarray(), abs=0.01)
    assert shares(mixed).sum(axis=1).max() <= 1.0 + 1e-9


def test_a_star_is_as_thick_as_its_arms_are_on_the_mean_of_their_lengths() -> None:
    """One arm was cut to half, another one away."""
    parts = np.tile([1.0, 0.5, 0.0], COUNT)
    centre = PLAN.centres[PLAN.arm_star]
    sections = PLAN.arm_sections.copy()
    sections[..., 0] = np.tile([[0.2, 0.4], [0.4, 0.8], [9.0, 9.0]], (COUNT, 1))
    cut = replace(PLAN, arm_tip=centre + parts[:, None] * (PLAN.arm_tip - centre), arm_sections=sections)
    sizes = law_coordinates(cut, 3)
    assert sizes[:, 0] == pytest.approx(law_coordinates(PLAN, 3)[:, 0] / 2.0)
    assert sizes[:, 1] == pytest.approx((0.3 + 0.5 * 0.6) / 1.5)


def points(grid: StarCells) -> np.ndarray:
    return grid.origin + grid.step * np.moveaxis(np.indices(grid.owner.shape), 0, -1)


def test_the_nearest_star_owns_a_place() -> None:
    grid = StarCells(PLAN, TUBE.lattice)
    away = np.linalg.norm(points(grid)[:, :, None] - PLAN.centres, axis=-1)
    owned = grid.owner < COUNT
    assert owned[away.min(axis=2) < 0.49 * PLAN.spacing_mm].all()
    assert not owned[away.min(axis=2) > 0.6 * PLAN.spacing_mm].any()
    least = np.take_along_axis(away, np.where(owned, grid.owner, 0)[:, :, None], axis=2)[:, :, 0]
    assert np.allclose(least[owned], away.min(axis=2)[owned])


def test_what_is_on_the_outline_is_not_inside() -> None:
    step = StarCells(PLAN, TUBE.lattice).step
    for half, is_on_grid in ((30.0, False), (34.5 * step, True)):
        corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
        square = Design.from_dict(TUBE.to_dict() | {"border": {"polygon_mm": corners.tolist()}})
        grid = StarCells(layout(square), square.lattice)
        assert np.array_equal(grid.count, grid.count[::-1]) and np.array_equal(grid.count, grid.count[:, ::-1])
        on = np.isclose(np.abs(points(grid)).max(axis=-1), half)
        assert on.any() == is_on_grid and not (grid.count[on] == 1.0).any()
