"""`asterism preview`: files, table, exit status, and one line for every mistake."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import asterism
from asterism.homogenize.law.law_file import law_bytes
from asterism.results.records.shape import PreviewRecord
from tests.asterism.commands import Cli
from tests.asterism.previews.laws import plain_law

DESIGN = """
name = "small"
[stars]
length_mm = 8.0
thickness_mm = 0.3
[border]
rings = 1
[mesh]
edge_mm = 5.0
"""


@pytest.fixture
def folder(here: Path) -> Path:
    (here / "small.toml").write_text(DESIGN)
    (here / "plain.npz").write_bytes(law_bytes(plain_law()))
    return here


@pytest.mark.usefixtures("blank_pictures")
def test_writes_the_files_of_a_simulation(folder: Path, cli: Cli) -> None:
    done = cli(["preview", "small.toml", "-o", "out", "--law", "plain.npz"])
    assert done.status == 0
    names = {"summary.json", "shape.vtu", "rods.vtu", "shape.obj", "shape.png"}
    assert {file.name for file in (folder / "out").iterdir()} == names
    summary = json.loads((folder / "out" / "summary.json").read_text())
    assert summary["is_minimum"] and summary["law"]["material"] == "plain"
    assert "equilibrium          stable" in done.out
    across, percent = summary["diameter_mm"], summary["expected_rms_percent"]
    off = 0.01 * percent * across
    expected = f"estimated error      {percent:.1f} % of the diameter of {across:.1f} mm: {off:.1f} mm"
    assert expected in done.out
    record = PreviewRecord.from_json(summary)
    assert (record | {"expected_rms_percent": None}).table()["estimated error"] == "not known"
    height, percent = summary["height_mm"], summary["expected_height_percent"]
    off = 0.01 * percent * height
    assert f"  height               {height:.2f} mm, give or take {off:.1f} mm ({percent:.0f} %)\n" in done.out
    assert (record | {"expected_height_percent": None}).table()["height"] == f"{height:.2f} mm"


@pytest.mark.usefixtures("blank_pictures")
def test_a_preview_settles_to_the_exact_shape_of_its_form(folder: Path, cli: Cli) -> None:
    words = ["preview", "small.toml", "-o", "out", "--law", "plain.npz", "--side", "up", "--settle"]
    done = cli(words)
    assert done.status == 0
    shape = asterism.read_shape(folder / "out")
    assert shape.summary["model"] == "exact" and shape.summary["is_minimum"]
    assert "estimated error" not in done.out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["preview", "none.toml"], "none.toml"),
        (["preview", "small.toml", "--law", "none.npz"], "none.npz"),
        (["preview", "small.toml", "--law", "small.toml"], "is not a law"),
        (["preview", "small.toml", "--side", "left"], "--side"),
        (["preview", "small.toml", "-o", "small.toml"], "a file is in the way"),
    ],
)
def test_mistakes_are_one_line(folder: Path, cli: Cli, words: list[str], said: str) -> None:
    done = cli(words)
    assert done.status == 2
    assert said in done.line
    assert not (folder / "small").exists()


@pytest.mark.usefixtures("blank_pictures")
def test_stars_outside_the_law_are_named(folder: Path, cli: Cli) -> None:
    (folder / "small.toml").write_text(DESIGN.replace("0.3", "0.9"))
    done = cli(["preview", "small.toml", "--law", "plain.npz"])
    assert done.status == 0
    assert "star 0 at [0.0, 0.0]: thickness_mm = 0.9 is outside" in done.err
    assert done.err.endswith("go on to the exact shape with --settle\n")
    summary = json.loads((folder / "small" / "summary.json").read_text())
    assert not any("--settle" in line for line in summary["warnings"])
    # nothing is known of the error there
    assert summary["expected_rms_percent"] is None and summary["expected_height_percent"] is None
    assert "estimated error      not known" in done.out and "give or take" not in done.out
