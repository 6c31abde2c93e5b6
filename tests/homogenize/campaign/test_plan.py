"""Material files: what they hold, and one line for whatever is wrong with them."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.homogenize.campaign.design_plan import plan_for_sizes
from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.material import PAPER_MATERIAL, Material, load_material
from asterism.homogenize.law.plan import LawPlan
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from tests.homogenize import fake
from tests.homogenize.fake import sample_name
from tests.homogenize.law.test_law import design, fitted


def test_the_papers_plan_covers_its_range() -> None:
    plan = load_material(PAPER_MATERIAL).law_plan()
    assert plan.stretches == (1.35, 1.75)
    np.testing.assert_array_equal(plan.limits, [[0.0, 0.2, 0.8], [13.0, 0.6, 1.6]])
    tasks = plan.tasks()
    assert len(tasks) == len(set(tasks)) and tasks == sorted(tasks)
    assert sum(task.is_bare for task in tasks) == 2
    held = [task for task in tasks if task.held_out]
    assert len(held) == 2 * plan.held_out
    assert not {task.sizes for task in held} & {task.sizes for task in tasks if not task.held_out}


def test_held_out_cells_are_as_long_as_those_the_law_answers_for() -> None:
    plan = Material.from_dict({"plan": {"lengths_mm": [9.0, 12.0]}}).law_plan()
    held = [task.sizes[0] for task in plan.tasks() if task.held_out]
    assert len(held) == 12 and 9.0 <= min(held) < 10.0


@pytest.mark.parametrize(
    "data",
    [{}, {"fabric": {"stretch": 1.5}}, tomllib.loads(PAPER_MATERIAL.read_text())],
)
def test_plain_data_makes_the_same_material(data: dict) -> None:
    material = Material.from_dict(data)
    again = Material.from_dict(material.to_dict())
    plan = material.law_plan()
    assert again.law_plan() == plan == LawPlan.from_dict(plan.to_dict()) and again.to_dict() == material.to_dict()


BAD = [
    ({"fabrik": {}}, "fabrik", "did you mean fabric?"),
    ({"plan": {"lengths_mm": [4, 2]}}, "plan.lengths_mm", "increase"),
    ({"plan": {"lengths_mm": [0.5, 2]}}, "plan.lengths_mm", "at least 1"),
    ({"plan": {"lengths_mm": []}}, "plan.lengths_mm", "at least 1"),
    ({"plan": {"lengths_mm": [0]}}, "plan.lengths_mm", "a length above 0"),
    ({"plan": {"lengths_mm": [4, 30]}}, "plan.lengths_mm", "at most the spacing 17.3205"),
    ({"plan": {"thicknesses_mm": [0.01]}}, "plan.thicknesses_mm", "from 0.05 to 5"),
    ({"plan": {"widths_mm": [11]}}, "plan.widths_mm", "from 0.1 to 10"),
    ({"plan": {"stretches": [0.9]}}, "plan.stretches", "from 1 to 3"),
    ({"plan": {"stretches": [1.35, 1.35001]}}, "plan.stretches", "at least 0.0001 apart"),
    ({"plan": {"edge_mm": 9}}, "plan.edge_mm", "third of the spacing"),
    ({"plan": {"held_out": -1}}, "plan.held_out", "at least 0"),
    ({"fabric": {"stretch": [1.3, 1.4]}}, "fabric.stretch", "one number"),
    ({"fabric": {"stretch": 1.3}, "plan": {"stretches": [1.3]}}, "fabric.stretch", "plan.stretches"),
    ({"name": "two\nlines"}, "name", "one line"),
]


@pytest.mark.parametrize(("data", "field", "words"), BAD, ids=[f"{b[1]}-{n}" for n, b in enumerate(BAD)])
def test_mistakes_name_the_field(data: dict, field: str, words: str) -> None:
    with pytest.raises(DesignError) as caught:
        Material.from_dict(data, "m.toml")
    assert str(caught.value).startswith(f"m.toml: {field}") and words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_files_that_are_none(tmp_path: Path) -> None:
    for name, content in (("m.toml", "a = ["), ("m.json", "[1]"), ("m.txt", "")):
        (tmp_path / name).write_text(content)
        with pytest.raises(DesignError, match=name):
            load_material(tmp_path / name)


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
    assert "no cell was solved" in table(7.0, 0.45, 1.2).outside[0]
    whole = fitted(plan, fake.solve_cell).at(1.35)
    for name in ("lam", "kappa", "bending"):
        assert table(*sizes.T).value[name] == pytest.approx(whole(*sizes.T).value[name], rel=0.02)


def test_after_an_edit_the_nodes_stay_and_go_on_in_whole_steps() -> None:
    first = plan_for_sizes(design(), np.array([[8.0, 0.4, 1.2]]))
    more = plan_for_sizes(design(), np.array([[8.0, 0.43, 1.2]]), first)
    assert [own.nodes for own in more.sizes[:2]] == [(8.0,), (0.4, 0.48)]
    again = plan_for_sizes(design(), np.array([[7.0, 0.47, 1.2]]), more)
    assert again.sizes[1].nodes == (0.4, 0.48) and again.sizes[0].nodes == pytest.approx((6.5566, 8.0))


PLATE = {"bending": "consistent", "modulus_mpa": 7.0}
SIZES = np.array([[8.0, 0.4, 1.2]])


def plates(**more: Any) -> Design:
    """Equal stars on the plate, with graded meshes of 1.5 mm."""
    sheet = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "fabric": PLATE}
    return Design.from_dict(sheet | {"mesh": {"graded": True, "edge_mm": 1.5}} | more)


def test_cells_of_plates_are_graded_where_their_arms_lie_on_lattice_lines() -> None:
    for sheet, graded in (
        (plates(), True),
        (plates(mesh={"graded": False}), True),
        (plates(lattice={"orientation_deg": 10.0}), False),
        (plates(fabric={"bending": "paper"}, mesh={}), False),
    ):
        plan = plan_for_sizes(sheet, SIZES)
        assert plan.design.mesh.graded == graded and plan.edge_mm == pytest.approx(17.3205 / 17, abs=1e-4)
        assert plan.cell_design(plan.tasks()[-1]).mesh.graded == graded


def test_samples_of_graded_cells_have_names_of_their_own() -> None:
    plan = plan_for_sizes(plates(), SIZES)
    even = replace(plan, design=Design.from_dict(plan.design.to_dict() | {"mesh": {"graded": False}}))
    assert sample_name(plan, plan.tasks()[-1]) != sample_name(even, plan.tasks()[-1])


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"fabric": {"bending": "paper"}}, "consistent"),
        ({"fabric": PLATE, "lattice": {"orientation_deg": 10.0}}, "lattice lines"),
    ],
)
def test_plans_without_graded_cells_are_refused(data: dict[str, Any], words: str) -> None:
    with pytest.raises(DesignError, match=words) as refused:
        Material.from_dict(data | {"plan": {"graded": True}})
    assert refused.value.field == "plan.graded"


def test_plate_and_hinges_refuse_the_law_of_each_other() -> None:
    hinges = plates(fabric={"bending": "paper"}, mesh={})
    paper, plate = (StarLaw(plan_for_sizes(each, SIZES), load_law().tables, [], {}) for each in (hinges, plates()))
    for law, other, names in ((paper, plates(), ("consistent", "paper")), (plate, hinges, ("paper", "consistent"))):
        with pytest.raises(ForeignLaw) as refused:
            law.check(other)
        line = str(refused.value)
        assert "fabric.bending" in line and all(name in line for name in names) and "\n" not in line
