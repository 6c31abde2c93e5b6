"""The plan of a law for one design's stars: they lie between its cells, whatever their sizes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.homogenize.campaign.design_plan import plan_for_sizes
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from tests.homogenize import fake
from tests.homogenize.law.test_law import design, fitted

SPACING = 17.320508
size = st.tuples(st.floats(1.0, SPACING), st.floats(0.2, 0.6), st.floats(0.8, 1.6))


@given(st.lists(size, min_size=1, max_size=20))
@settings(max_examples=60)
def test_all_stars_lie_within_the_law(rows: list[tuple[float, float, float]]) -> None:
    sizes = np.array(rows)
    plan = plan_for_sizes(design(), sizes)
    for own, values in zip(plan.sizes, sizes.T, strict=True):
        room = 1e-9 * (1.0 + values.max())
        assert own.nodes[0] <= values.min() + room and values.max() - room <= own.nodes[-1], own.key
    lengths, thicknesses, widths = (own.nodes for own in plan.sizes)
    assert np.diff(lengths).max(initial=0.0) <= SPACING / 12 + 1e-3
    for nodes, factor in ((thicknesses, 1.2), (widths, 1.3)):
        assert (np.divide(nodes[1:], nodes[:-1]) < factor + 0.01).all()


def test_equal_stars_take_one_cell_and_the_bare_fabric() -> None:
    plan = plan_for_sizes(
        design(stars__length_mm=10.0, stars__thickness_mm=0.4), np.tile([10 + 2e-15, 0.4, 1.2], (7, 1))
    )
    assert [(t.sizes[0], t.held_out) for t in plan.tasks()] == [(0.0, False), (10.0, False)]
    assert plan.edge_mm == pytest.approx(SPACING / 17, abs=1e-4)
    law = fitted(plan, fake.solve_cell)
    assert law.at(1.35)(10 + 2e-15, 0.4, 1.2).inside.all()
    assert law.check(design(stars__thickness_mm=0.4)) is law.at(1.35)


def test_the_law_is_for_the_designs_material_and_lattice() -> None:
    own = design(
        fabric__stretch=1.5, fabric__thickness_mm=1.0, plastic__rest_curvature="none",
        lattice__spacing_mm=12.0, lattice__origin_mm=[3.0, 1.0], lattice__arms=4,
    )  # fmt: skip
    plan = plan_for_sizes(own, np.array([[4.0, 0.3, 1.2], [5.0, 0.3, 1.2]]))
    assert plan.stretches == (1.5,) and plan.edge_mm == pytest.approx(12.0 / 17, abs=1e-4)
    fitted(plan, fake.solve_cell).check(own)


@pytest.mark.parametrize("spacing", [1.0, 2.9, 500.0])
def test_every_spacing_has_a_plan(spacing: float) -> None:
    plan = plan_for_sizes(design(lattice__spacing_mm=spacing), np.array([[1.0, 0.3, 0.3]]))
    assert plan.edge_mm == pytest.approx(max(spacing / 17, 0.2), abs=1e-4)


def test_sizes_at_their_limit_but_for_rounding_are_so() -> None:
    """On the sheet, too: its law answers for them."""
    own = design(stars__width_mm=10.000005, stars__thickness_mm=5.000002)
    plan = plan_for_sizes(own, np.array([[5.0, 5.000002, 10.000005]]))
    assert [own.nodes for own in plan.sizes[1:]] == [(5.0,), (10.0,)]
    sheet = layout(own)
    assert sheet.arm_thickness.max() == 5.0 and sheet.arm_width.max() == 10.0


@pytest.mark.parametrize(
    ("changes", "sizes", "said"),
    [
        ({}, np.zeros((0, 3)), "at least one"),
        ({"fabric__bending": "none"}, np.array([[5.0, 0.3, 1.2]]), "fabric.bending"),
        ({}, np.array([[np.nan, 0.3, 1.2]]), "finite"),
    ],
)
def test_what_has_no_law(changes: dict[str, Any], sizes: np.ndarray, said: str) -> None:
    with pytest.raises(DesignError, match=said):
        plan_for_sizes(Design.from_dict(design(**changes).to_dict()), sizes)


def test_only_cells_around_the_stars_are_solved() -> None:
    """Two sorts of stars need six cells and the bare fabric; the law answers for both, and not between them."""
    sizes = np.array([[5.0, 0.3, 1.2], [5.0, 0.3, 1.2], [9.3, 0.6, 1.2], [9.6, 0.6, 1.2]])
    plan = plan_for_sizes(design(), sizes)
    tasks = plan.tasks_for_sizes(sizes)
    assert len(tasks) <= 5 < len(plan.tasks())
    table = fitted(plan, fake.solve_cell, tasks).at(1.35)
    assert table(*sizes.T).inside.all()
    assert not table(7.0, 0.45, 1.2).inside[0] and "no cell was solved" in table(7.0, 0.45, 1.2).outside[0]
    whole = fitted(plan, fake.solve_cell).at(1.35)
    for name in ("lam", "kappa", "bending"):
        assert table(*sizes.T).value[name] == pytest.approx(whole(*sizes.T).value[name], rel=0.02)


def test_after_an_edit_the_nodes_stay_and_go_on_in_whole_steps() -> None:
    first = plan_for_sizes(design(), np.array([[8.0, 0.4, 1.2]]))
    more = plan_for_sizes(design(), np.array([[8.0, 0.43, 1.2]]), first)
    assert [own.nodes for own in more.sizes[:2]] == [(8.0,), (0.4, 0.48)]
    again = plan_for_sizes(design(), np.array([[7.0, 0.47, 1.2]]), more)
    assert again.sizes[1].nodes == (0.4, 0.48) and again.sizes[0].nodes == pytest.approx((6.5566, 8.0))
