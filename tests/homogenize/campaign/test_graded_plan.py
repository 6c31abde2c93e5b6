"""Graded cells: which plans may have them, and what their samples are named by."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asterism.homogenize.campaign.design_plan import plan_for_sizes
from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from tests.homogenize.fake import sample_name

PLATE = {"bending": "consistent", "modulus_mpa": 7.0}
SIZES = np.array([[8.0, 0.4, 1.2]])


def design(**more: Any) -> Design:
    """Equal stars on the plate, with graded meshes of 1.5 mm."""
    sheet = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "fabric": PLATE}
    return Design.from_dict(sheet | {"mesh": {"graded": True, "edge_mm": 1.5}} | more)


def test_cells_of_plates_are_graded_where_their_arms_lie_on_lattice_lines() -> None:
    for sheet, graded in (
        (design(), True),
        (design(mesh={"graded": False}), True),
        (design(lattice={"orientation_deg": 10.0}), False),
        (design(fabric={"bending": "paper"}, mesh={}), False),
    ):
        plan = plan_for_sizes(sheet, SIZES)
        assert plan.design.mesh.graded == graded and plan.edge_mm == pytest.approx(17.3205 / 17, abs=1e-4)


def test_the_design_of_a_cell_is_graded_and_its_sample_has_a_name_of_its_own() -> None:
    plan = plan_for_sizes(design(), SIZES)
    even = replace(plan, design=Design.from_dict(plan.design.to_dict() | {"mesh": {"graded": False}}))
    task = plan.tasks()[-1]
    assert plan.cell_design(task).mesh.graded and not even.cell_design(task).mesh.graded
    assert sample_name(plan, task) != sample_name(even, task)


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


@pytest.mark.parametrize(
    ("fabric", "field"),
    [
        ({"bending": "paper", "bending_stiffness_n_mm": 0.02}, "fabric.bending_stiffness_n_mm"),
        ({"bending": "consistent", "bending_stiffness_n_mm": 0.02}, "fabric.modulus_mpa"),
    ],
)
def test_a_material_with_a_measured_stiffness_needs_what_a_design_needs(fabric: dict[str, Any], field: str) -> None:
    with pytest.raises(DesignError) as refused:
        Material.from_dict({"fabric": fabric})
    assert refused.value.field == field


def test_plate_and_hinges_refuse_the_law_of_each_other() -> None:
    hinges = design(fabric={"bending": "paper"}, mesh={})
    paper, plate = (StarLaw(plan_for_sizes(each, SIZES), load_law().tables, [], {}) for each in (hinges, design()))
    for law, other, names in ((paper, design(), ("consistent", "paper")), (plate, hinges, ("paper", "consistent"))):
        with pytest.raises(ForeignLaw) as refused:
            law.check(other)
        line = str(refused.value)
        assert "fabric.bending" in line and all(name in line for name in names) and "\n" not in line
