"""Material files: what they hold, and one line for whatever is wrong with them."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

from asterism.homogenize.law.material import PAPER_MATERIAL, Material, load_material
from asterism.homogenize.law.plan import LawPlan
from asterism.pattern.design.errors import DesignError


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
    [
        {},
        {"fabric": {"stretch": 1.5}},
        tomllib.loads(PAPER_MATERIAL.read_text()),
    ],
    ids=["default", "own stretch", "paper"],
)
def test_plain_data_makes_the_same_material(data: dict) -> None:
    material = Material.from_dict(data)
    again = Material.from_dict(material.to_dict())
    plan = material.law_plan()
    assert again.law_plan() == plan == LawPlan.from_dict(plan.to_dict()) and again.to_dict() == material.to_dict()


BAD = [
    ({"fabrik": {}}, "fabrik", "did you mean fabric?"),
    ({"plan": {"lengths": [1, 2]}}, "plan.lengths", "did you mean lengths_mm?"),
    ({"plan": {"lengths_mm": [4, 2]}}, "plan.lengths_mm", "increase"),
    ({"plan": {"lengths_mm": [0.5, 2]}}, "plan.lengths_mm", "at least 1"),
    ({"plan": {"lengths_mm": [-1, 2]}}, "plan.lengths_mm", "at least 1"),
    ({"plan": {"lengths_mm": []}}, "plan.lengths_mm", "at least 1"),
    ({"plan": {"lengths_mm": [0]}}, "plan.lengths_mm", "a length above 0"),
    ({"plan": {"lengths_mm": [4, 30]}}, "plan.lengths_mm", "at most the spacing 17.3205"),
    ({"plan": {"lengths_mm": ["4", 5]}}, "plan.lengths_mm[0]", "number"),
    ({"plan": {"thicknesses_mm": []}}, "plan.thicknesses_mm", "at least 1"),
    ({"plan": {"thicknesses_mm": [0.01]}}, "plan.thicknesses_mm", "from 0.05 to 5"),
    ({"plan": {"widths_mm": [11]}}, "plan.widths_mm", "from 0.1 to 10"),
    ({"plan": {"stretches": [0.9]}}, "plan.stretches", "from 1 to 3"),
    ({"plan": {"stretches": [1.35, 1.35001]}}, "plan.stretches", "at least 0.0001 apart"),
    ({"plan": {"stretches": []}}, "plan.stretches", "at least 1"),
    ({"plan": {"edge_mm": 9}}, "plan.edge_mm", "third of the spacing"),
    ({"plan": {"held_out": -1}}, "plan.held_out", "at least 0"),
    ({"plan": {"held_out": True}}, "plan.held_out", "whole number"),
    ({"plan": {"edge_mm": float("nan")}}, "plan.edge_mm", "finite"),
    ({"plan": 3}, "plan", "table"),
    ({"fabric": {"stretch": [1.3, 1.4]}}, "fabric.stretch", "one number"),
    ({"fabric": {"stretch": 1.3}, "plan": {"stretches": [1.3]}}, "fabric.stretch", "plan.stretches"),
    ({"plastic": {"modulus_ratio": 0}}, "plastic.modulus_ratio", "at least 1"),
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
