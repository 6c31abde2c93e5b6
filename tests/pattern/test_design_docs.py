"""The reference of the design file is complete, and its examples work."""

import re
import tomllib
from pathlib import Path
from typing import get_args

import pytest
from pydantic import BaseModel

from asterism.pattern.design.design import Design
from asterism.pattern.design.sizing.profiles import MARKED_PROFILES, NAMED_PROFILES
from asterism.pattern.design.stars import Override
from asterism.pattern.layout.build import layout

TEXT = (Path(__file__).parents[2] / "docs" / "reference" / "design-file.md").read_text(encoding="utf-8")
WHOLE, OVERRIDE, RODS, FIELDS = re.findall(r"```toml\n(.*?)```", TEXT, re.DOTALL)


def test_example():
    assert len(layout(Design.from_dict(tomllib.loads(WHOLE))).centres) == 37
    changed = layout(Design.from_dict(tomllib.loads(WHOLE.replace("[border]", OVERRIDE + "[border]"))))
    assert changed.arm_length.min() == pytest.approx(4, abs=1e-3)


def test_example_of_rods():
    sheet = layout(Design.from_dict(tomllib.loads(RODS)))
    assert len(sheet.rim) == 2 and {rod.name for rod in sheet.graph.rods} == {"rim", "rib"}


@pytest.mark.parametrize("line", [line for line in FIELDS.splitlines() if "image" not in line])
def test_field_examples(line):
    layout(Design.from_dict({"stars": tomllib.loads(line), "border": {"rings": 2}}))


def _sections(model: type[BaseModel]) -> list[type[BaseModel]]:
    inner = [t for f in model.model_fields.values() for t in (f.annotation, *get_args(f.annotation))]
    return [model] + [s for t in inner if isinstance(t, type) and issubclass(t, BaseModel) for s in _sections(t)]


def test_every_key_is_documented():
    sections = [*_sections(Design), Override, *MARKED_PROFILES.values(), *NAMED_PROFILES.values()]
    assert len(sections) >= 17
    keys = {field.alias or key for model in sections for key, field in model.model_fields.items()}
    assert {key for key in keys if not re.search(rf"\b{key}\b", TEXT)} == set()
