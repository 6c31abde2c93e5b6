"""Measured materials by name or file, and the section `[material]` of a design."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from asterism.pattern.design import files as user_files
from asterism.pattern.design.design import Design, save_design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.material_files import material_files, material_path, own_material_path
from asterism.pattern.design.spread import Spread
from asterism.pattern.layout.build import load_design

MATERIAL = """
name = "soft"
[measured]
source = "strips.csv"
date = "2026-11-25"
[fabric]
thickness_mm = 0.5
stretch = 1.5
[plastic]
modulus_ratio = 900.0
"""
SHEET: dict[str, Any] = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}}


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The list of materials of a user who has one."""
    monkeypatch.delenv(user_files.PROFILES_VARIABLE, raising=False)
    monkeypatch.setattr(user_files, "user_folder", lambda: tmp_path / "home")
    (tmp_path / "home" / "materials").mkdir(parents=True)
    (tmp_path / "home" / "materials" / "soft.toml").write_text(MATERIAL)
    (tmp_path / "near.toml").write_text(MATERIAL.replace("900", "800"))
    return tmp_path


def test_the_list_has_the_materials_of_the_user_and_of_the_package(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(material_files()) == ["paper", "soft"]
    lab = home / "lab" / "materials"
    lab.mkdir(parents=True)
    (lab / "soft.toml").write_text(MATERIAL)
    monkeypatch.setenv(user_files.PROFILES_VARIABLE, str(home / "lab"))
    assert material_files()["soft"] == lab / "soft.toml"
    assert own_material_path("new", "--save") == lab / "new.toml"
    assert material_path("near.toml", "--material", home) == home / "near.toml"
    with pytest.raises(DesignError, match=r"--material = 'wool': must be a file \(.toml\) or a name: paper, soft"):
        material_path("wool", "--material")
    for name in ("", "a/b", "../x", "paper"):
        with pytest.raises(DesignError, match="--save"):
            own_material_path(name, "--save")


@pytest.mark.parametrize(("file", "ratio"), [("soft", 900.0), ("near.toml", 800.0)])
def test_a_design_takes_the_values_of_its_material(home: Path, file: str, ratio: float) -> None:
    design = Design.from_dict(SHEET | {"material": {"file": file}}, home)
    assert (design.plastic.modulus_ratio, design.fabric.thickness_mm, design.fabric.stretch) == (ratio, 0.5, 1.5)
    assert "thickness_mm" in design.fabric.model_fields_set and design.material is None
    # its own stretch stays
    own = SHEET | {"material": {"file": file}, "fabric": {"stretch": 1.35}}
    assert Design.from_dict(own, home).fabric.stretch == 1.35
    # the design is complete without the file
    assert Design.from_dict(design.to_dict(), "elsewhere") == design
    save_design(design, home / "whole.toml")
    assert load_design(home / "whole.toml") == design


def test_a_design_takes_the_intervals_of_its_material(home: Path) -> None:
    assert "spread" not in Design.from_dict(SHEET).to_dict()
    (home / "near.toml").write_text(f"{MATERIAL}[spread]\nmodulus_ratio_factor = 1.05\n")
    design = Design.from_dict(SHEET | {"material": {"file": "near.toml"}, "spread": {"stretch_percent": 3.0}}, home)
    assert design.spread == Spread(modulus_ratio_factor=1.05, stretch_percent=3.0)
    assert Design.from_dict(design.to_dict()) == design


def test_a_law_lies_beside_the_design(home: Path) -> None:
    design = Design.from_dict(SHEET | {"material": {"law": "soft.npz"}}, home)
    assert design.material is not None and design.material.law == str(home / "soft.npz")
    assert Design.from_dict(design.to_dict(), "elsewhere") == design


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"material": {"file": "wool"}}, r"material.file = 'wool': must be a file"),
        ({"material": {"file": "none.toml"}}, r"none.toml: cannot be read"),
        ({"material": {"file": "empty.toml"}}, r"material.file = 'empty.toml': must have values in \[fabric\]"),
        ({"material": {"file": "wrong.toml"}}, r"wrong.toml: plastic.modulus_ratio = -1.*: must be at least 1"),
        ({"material": {"file": ""}}, r"material.file = ''"),
        ({"material": {"fil": "soft"}}, r"material.fil = 'soft': unknown key, did you mean file"),
        ({"material": "soft"}, r"material"),
        (
            {"material": {"file": "soft"}, "plastic": {"modulus_ratio": 3200.0}},
            r"plastic.modulus_ratio = 3200.0: is given by material.file = 'soft' too: remove one",
        ),
    ],
)
def test_mistakes_are_named(home: Path, more: dict[str, Any], said: str) -> None:
    (home / "empty.toml").write_text("name = 'empty'\n")
    (home / "wrong.toml").write_text("[plastic]\nmodulus_ratio = -1.0\n")
    with pytest.raises(DesignError, match=said):
        Design.from_dict(SHEET | more, home)
