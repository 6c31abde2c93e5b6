"""Drawn rods on the command line: simulated to a certified shape, and refused by commands that need stars."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import asterism
from asterism.shape.vtu import read_shape
from tests.asterism.commands import Cli

pytestmark = pytest.mark.slow

RING = """
[rods]
thickness_mm = 0.8
[[rods.draw]]
name = "rim"
circle_mm = { radius = 20 }
[[rods.draw]]
name = "rib"
line_mm = [[-25, 0], [25, 0]]
[border]
rods = "rim"
[mesh]
edge_mm = 5.0
"""


@pytest.fixture
def design(tmp_path: Path) -> Path:
    path = tmp_path / "ring.toml"
    path.write_text(RING, encoding="utf-8")
    return path


def test_simulate_writes_a_certified_shape(design: Path, cli: Cli) -> None:
    done = cli(["simulate", str(design), "--quiet"]).done
    assert "3, 2 joints" in done.out and "stars" not in done.out
    summary = json.loads((design.parent / "ring" / "summary.json").read_text(encoding="utf-8"))
    assert summary["is_minimum"] and summary["rods_total"] == 3 and summary["rod_joints"] > 0.0
    shape = read_shape(design.parent / "ring")
    assert len(shape.rods) == 3 and (shape.rod_fields["star"] == -1).all()
    assert shape.layout is not None and len(shape.layout.rim) == 2


def test_parallel_lines_roll_contract_and_count_their_mirror_images_once() -> None:
    lines = [{"line_mm": [(-20, y), (20, y)]} for y in range(-20, 21, 4)]
    data = {"rods": {"draw": lines}, "border": {"rectangle_mm": (42.0, 42.0)}, "mesh": {"edge_mm": 4.0}}
    summary = asterism.simulate(asterism.Design.from_dict(data), starts=2).summary
    assert summary.is_minimum and summary.symmetries == 4 and summary.starts_lost == 0
    assert summary.minima_seen == 1 and summary.minima[0].starts == 2
    assert summary.roll_axis_deg == pytest.approx(90.0, abs=6.0) and 20.0 < summary.roll_radius_mm < 80.0
    assert 0.75 < summary.contraction < 0.9  # across the lines about 0.67, along them 1


def test_a_sheet_with_a_hole_is_certified_and_softer(design: Path) -> None:
    text = RING + "[[border.holes]]\ncircle_mm = { centre = [0, 9], radius = 5 }\n"
    whole = asterism.simulate(asterism.load_design(design))
    design.write_text(text, encoding="utf-8")
    shape = asterism.simulate(asterism.load_design(design))
    assert shape.summary.is_minimum and shape.summary.energy_n_mm < 0.98 * whole.summary.energy_n_mm
    with pytest.raises(ValueError, match="sheet"):
        shape.at([[0.0, 9.0]])


BESIDE = """
[stars]
length_mm = 7.0
thickness_mm = 0.4
[rods]
[[rods.draw]]
name = "rim"
circle_mm = { radius = 40 }
thickness_mm = 0.6
[border]
rods = "rim"
[mesh]
edge_mm = 4.0
[fabric]
bending = "paper"
"""


def test_stars_within_a_rim_are_certified_up_and_exported(here: Path, cli: Cli) -> None:
    path = here / "beside.toml"
    path.write_text(BESIDE, encoding="utf-8")
    shape = asterism.simulate(asterism.load_design(path))
    summary = shape.summary
    assert summary.is_minimum and summary.stars_up == summary.stars_total == 13 and summary.rods_total == 40
    assert sorted(set(shape.rod_fields["star"].tolist())) == [-1, *range(13)] and summary.contraction < 1.0
    assert cli(["export", "beside.toml"]).done
    files = {file.name for file in (here / "beside-print").iterdir()}
    assert {"stars.stl", "stars.scad", "middle-lines.svg"} <= files and "rods.stl" not in files
    text = (here / "beside-print" / "stars.scad").read_text()
    assert "stars and rods for the" in text and text.count("\n  [") == 13 + len(shape.layout.drawn_rods)
    for name in ("preview", "verify"):
        assert "do not repeat have no law" in cli([name, "beside.toml", "--quiet"]).line
