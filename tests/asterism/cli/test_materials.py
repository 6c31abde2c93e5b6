"""`asterism materials`, materials by name in other commands, and `asterism strips fit --save`."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

from asterism import load_design, preview
from asterism.homogenize.law.law_file import law_bytes
from asterism.pattern.design import files as user_files
from tests.asterism.commands import Cli
from tests.asterism.previews.laws import plain_law

DESIGN = "[stars]\nlength_mm = 8.0\n[border]\nrings = 1\n"


@pytest.fixture(autouse=True)
def home(here: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv(user_files.PROFILES_VARIABLE, raising=False)
    monkeypatch.setattr(user_files, "user_folder", lambda: here / "home")
    (here / "d.toml").write_text(DESIGN)
    return here


@pytest.mark.slow
def test_strips_fit_keeps_a_material_that_commands_take_by_name(home: Path, cli: Cli) -> None:
    rows = ["strip,thickness_mm,length_mm,curvature_per_mm,peeled_curvature_per_mm"]
    rows += ["1,0.3,60,0.0302,0.003", "2,0.3,60,0.0298,0.0031", "3,0.4,60,0.0170,0.0029", "4,0.4,60,0.0174,0.003"]
    (home / "strips.csv").write_text("\n".join(rows))
    words = ["strips", "fit", "strips.csv", "--stretch", "1.35", "--fabric-thickness", "0.8", "--save"]
    assert cli([*words, "jersey"]).done
    file = home / "home" / "materials" / "jersey.toml"
    table = tomllib.loads(file.read_text(encoding="utf-8"))
    assert table["measured"]["source"] == "strips.csv: 8 readings of strips" and len(table["measured"]["date"]) == 10
    listed = {line.split()[0]: line for line in cli(["materials"]).done.out.splitlines()}
    line = listed["jersey"]
    assert "strips.csv" in line and table["measured"]["date"] in line and "fabric 0.8 mm, at stretch 1.35" in line
    assert "paper" in listed
    # by the option, and in the design
    ratio = table["plastic"]["modulus_ratio"]
    assert cli(["export", "d.toml", "-o", "out", "--material", "jersey"]).done
    assert json.loads((home / "out" / "export.json").read_text())["design"]["plastic"]["modulus_ratio"] == ratio
    (home / "own.toml").write_text(f'{DESIGN}[material]\nfile = "jersey"\n')
    assert load_design(home / "own.toml").plastic.modulus_ratio == ratio
    # the file of a user is not written over
    file.write_text(file.read_text(encoding="utf-8").split("\n", 1)[1], encoding="utf-8")
    for name, said in (("jersey", "was not written by asterism strips fit"), ("a b", "--save"), ("paper", "--save")):
        assert said in cli([*words, name]).refusal


def test_a_wrong_file_is_named_and_does_not_hide_the_others(home: Path, cli: Cli) -> None:
    (home / "home" / "materials").mkdir(parents=True)
    (home / "home" / "materials" / "wrong.toml").write_text("[plastic]\nmodulus_ratio = -1.0\n")
    done = cli(["materials"])
    assert done.status == 2 and "wrong.toml: plastic.modulus_ratio" in done.err and "paper" in done.out
    refusal = cli(["preview", "d.toml", "--material", "wool"]).refusal
    assert "--material = 'wool'" in refusal and "paper" in refusal


@pytest.mark.usefixtures("blank_pictures")
def test_the_law_of_a_design_is_used_by_commands_and_in_python(home: Path, cli: Cli) -> None:
    (home / "plain.npz").write_bytes(law_bytes(plain_law()))
    (home / "own.toml").write_text(f'{DESIGN}[material]\nlaw = "plain.npz"\n')
    assert cli(["preview", str(home / "own.toml")]).done
    assert json.loads((home / "own" / "summary.json").read_text())["law"]["material"] == "plain"
    assert preview(load_design(home / "own.toml")).summary.law.material == "plain"
    (home / "own.toml").write_text(f'{DESIGN}[material]\nlaw = "none.npz"\n')
    assert "none.npz" in cli(["preview", str(home / "own.toml")]).refusal
