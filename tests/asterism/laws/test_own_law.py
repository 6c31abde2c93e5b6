"""A design of another material: its preview learns the fabric, and a calibration writes its law."""

from __future__ import annotations

import json
import shlex
import shutil
from pathlib import Path

import pytest

from asterism.homogenize.law.law_file import law_bytes, load_law
from tests.asterism.laws.conftest import Asterism
from tests.asterism.previews.laws import plain_law

DESIGN = """
name = "thick"
[fabric]
thickness_mm = {thickness}
bending = "{bending}"
[lattice]
spacing_mm = 17.320508
[stars]
length_mm = 6.0
thickness_mm = 0.5
[border]
rings = 1
"""


def write(path: Path, thickness: float = 2.0, bending: str = "paper") -> None:
    path.write_text(DESIGN.format(thickness=thickness, bending=bending))


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_a_preview_learns_its_fabric_and_a_calibration_finds_the_cells(folder: Path, asterism: Asterism) -> None:
    write(folder / "my sheet.toml")
    first = asterism(["preview", "my sheet.toml"])
    assert first.status == 0 and "learning this fabric: cell 1 of 2" in first.err
    summary = json.loads((folder / "my sheet" / "summary.json").read_text())
    assert summary["law_in_range"] and summary["law"]["material"] == "thick" and summary["is_minimum"]
    made = asterism(["calibrate", "my sheet.toml"])
    assert made.status == 0 and made.err.splitlines() == ["  2 of 2 cells"]
    then = shlex.split(made.out.splitlines()[-1].removeprefix("now run  asterism "))
    assert asterism(then).status == 0
    again = json.loads((folder / "my sheet" / "summary.json").read_text())
    assert again["height_mm"] == pytest.approx(summary["height_mm"], rel=1e-9)
    # the law's own files are beside the results, not among them
    assert asterism(["law", "show", "my sheet-law.npz"]).status == 0
    shutil.copy(folder / "my sheet-law.npz", folder / "my sheet.npz")
    assert asterism(["law", "show", "my sheet.npz"]).status == 0
    assert (folder / "my sheet" / "shape.vtu").exists()
    (folder / "mine").mkdir()
    (folder / "mine" / "summary.json").write_text('{"mine": 1}')
    refused = asterism(["law", "show", "my sheet.npz", "-o", "mine"])
    assert refused.status == 2 and "was not written by asterism" in refused.line
    assert (folder / "my sheet-law" / "law.png").exists() and not (folder / "my sheet" / "law.png").exists()
    assert load_law(folder / "my sheet-law.npz").made["command"] == "asterism calibrate my sheet.toml"
    gone = asterism(["law", "forget"])
    assert gone.out.strip() == f"2 cells removed from {folder / 'cells'}" and not list((folder / "cells").iterdir())


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_another_material_has_a_law_of_its_own(folder: Path, asterism: Asterism) -> None:
    write(folder / "d.toml", thickness=0.8)
    (folder / "my m.toml").write_text("[plastic]\nmodulus_ratio = 100000\n")
    (folder / "d-law.npz").write_text("the law of the design's own material")
    made = asterism(["calibrate", "d.toml", "--material", "my m.toml", "--jobs", "1"])
    then = made.out.splitlines()[-1].removeprefix("now run  asterism ")
    assert then == "preview d.toml --material 'my m.toml' --law 'd-law-my m.npz'"
    assert asterism(shlex.split(then)).status == 0
    assert (folder / "d-law.npz").read_text() == "the law of the design's own material"


def test_a_law_for_something_else_is_named(folder: Path, asterism: Asterism) -> None:
    (folder / "foreign.npz").write_bytes(law_bytes(plain_law(1.2)))
    write(folder / "d.toml", 2.0)
    refused = asterism(["preview", "d.toml", "--law", "foreign.npz"])
    assert refused.status == 2 and "asterism: d.toml: fabric." in refused.line
    assert refused.line.endswith("(foreign.npz); without it the preview makes its own law")


@pytest.mark.parametrize("word", ["preview", "verify", "calibrate"])
def test_a_fabric_that_does_not_bend_has_no_law(word: str, folder: Path, asterism: Asterism) -> None:
    write(folder / "d.toml", thickness=0.8, bending="none")
    refused = asterism([word, "d.toml"])
    line = refused.err.splitlines()[-1]
    assert refused.status == 2 and line.startswith("asterism: d.toml: fabric.bending = ") and "has no law" in line
    assert "calibrate" not in line and "asterism simulate" in line
    assert not list(folder.glob("*.npz"))


def test_mistakes(folder: Path, asterism: Asterism) -> None:
    write(folder / "d.toml")
    (folder / "m.toml").write_text('[fabric]\nbending = "none"\n')
    (folder / "both.toml").write_text(DESIGN.format(thickness=2.0, bending="paper") + "[plan]\nheld_out = 0\n")
    for words, said in (
        (["calibrate", "m.toml"], "fabric.bending"),
        (["calibrate", "m.toml", "--material", "m.toml"], "--material = 'm.toml': goes with a design"),
        (["calibrate", "d.toml", "--material", "m.toml"], "fabric.bending"),
        (["calibrate", "both.toml"], "both.toml: plan"),
    ):
        refused = asterism(words)
        assert refused.status == 2 and said in refused.line, refused.line
    assert not (folder / "cells").exists() or not list((folder / "cells").iterdir())
