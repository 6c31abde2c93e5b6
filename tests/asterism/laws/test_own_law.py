"""A design of another material: its preview learns the fabric, and a calibration writes its law."""

from __future__ import annotations

import json
import shlex
import shutil
from pathlib import Path

import pytest

from asterism.homogenize.law.law_file import law_bytes, load_law
from tests.asterism.commands import Cli
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
def test_a_preview_learns_its_fabric_and_a_calibration_finds_the_cells(here: Path, cli: Cli) -> None:
    write(here / "my sheet.toml")
    first = cli(["preview", "my sheet.toml"])
    assert first.status == 0 and "learning this fabric: cell 1 of 2" in first.err
    summary = json.loads((here / "my sheet" / "summary.json").read_text())
    assert summary["law_in_range"] and summary["law"]["material"] == "thick" and summary["is_minimum"]
    made = cli(["calibrate", "my sheet.toml"])
    assert made.status == 0 and made.err.splitlines() == ["  2 of 2 cells"]
    then = shlex.split(made.out.splitlines()[-1].removeprefix("now run  asterism "))
    assert cli(then).status == 0
    again = json.loads((here / "my sheet" / "summary.json").read_text())
    assert again["height_mm"] == pytest.approx(summary["height_mm"], rel=1e-9)
    # the law's own files are beside the results, not among them
    assert cli(["law", "show", "my sheet-law.npz"]).status == 0
    shutil.copy(here / "my sheet-law.npz", here / "my sheet.npz")
    assert cli(["law", "show", "my sheet.npz"]).status == 0
    assert (here / "my sheet" / "shape.vtu").exists()
    (here / "mine").mkdir()
    (here / "mine" / "summary.json").write_text('{"mine": 1}')
    refused = cli(["law", "show", "my sheet.npz", "-o", "mine"])
    assert refused.status == 2 and "was not written by asterism" in refused.line
    assert (here / "my sheet-law" / "law.png").exists() and not (here / "my sheet" / "law.png").exists()
    assert load_law(here / "my sheet-law.npz").made["command"] == "asterism calibrate my sheet.toml"
    gone = cli(["law", "forget"])
    assert gone.out.strip() == f"2 cells removed from {here / 'cells'}" and not list((here / "cells").iterdir())


def test_a_law_for_something_else_is_named(here: Path, cli: Cli) -> None:
    (here / "foreign.npz").write_bytes(law_bytes(plain_law(1.2)))
    write(here / "d.toml", 2.0)
    refused = cli(["preview", "d.toml", "--law", "foreign.npz"])
    assert refused.status == 2 and "asterism: d.toml: fabric." in refused.line
    assert refused.line.endswith("(foreign.npz); without it the preview makes its own law")


@pytest.mark.parametrize("word", ["preview", "verify", "calibrate"])
def test_a_fabric_that_does_not_bend_has_no_law(word: str, here: Path, cli: Cli) -> None:
    write(here / "d.toml", thickness=0.8, bending="none")
    refused = cli([word, "d.toml"])
    line = refused.err.splitlines()[-1]
    assert refused.status == 2 and line.startswith("asterism: d.toml: fabric.bending = ") and "has no law" in line
    assert "calibrate" not in line and "asterism simulate" in line
    assert not list(here.glob("*.npz"))


def test_mistakes(here: Path, cli: Cli) -> None:
    write(here / "d.toml")
    (here / "m.toml").write_text('[fabric]\nbending = "none"\n')
    (here / "both.toml").write_text(DESIGN.format(thickness=2.0, bending="paper") + "[plan]\nheld_out = 0\n")
    for words, said in (
        (["calibrate", "m.toml"], "fabric.bending"),
        (["calibrate", "m.toml", "--material", "m.toml"], "--material = 'm.toml': goes with a design"),
        (["calibrate", "d.toml", "--material", "m.toml"], "fabric.bending"),
        (["calibrate", "both.toml"], "both.toml: plan"),
    ):
        refused = cli(words)
        assert refused.status == 2 and said in refused.line, refused.line
    assert not (here / "cells").exists() or not list((here / "cells").iterdir())
