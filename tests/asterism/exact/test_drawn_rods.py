"""Drawn rods on the command line: simulated to a certified shape, and refused by commands that need stars."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import asterism
from asterism.shape.read_shape import read_shape
from tests.asterism.commands import command

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


def test_simulate_writes_a_certified_shape(design: Path, capsys, monkeypatch) -> None:
    done = command(["simulate", str(design), "--quiet"], capsys, monkeypatch)
    assert done.status == 0, done.err
    assert "3, 2 joints" in done.out and "stars" not in done.out
    summary = json.loads((design.parent / "ring" / "summary.json").read_text(encoding="utf-8"))
    assert summary["is_minimum"] and summary["rods_total"] == 3 and summary["rod_joints"] > 0.0
    shape = read_shape(design.parent / "ring")
    assert len(shape.rods) == 3 and (shape.rod_fields["star"] == -1).all()
    assert shape.layout is not None and len(shape.layout.rim) == 2


@pytest.mark.parametrize("name", ["preview", "verify", "export", "calibrate", "report"])
def test_commands_that_need_stars_say_so_in_one_line(name: str, design: Path, capsys, monkeypatch) -> None:
    done = command([name, str(design), "--quiet"], capsys, monkeypatch)
    assert done.status == 2
    assert "only asterism simulate computes drawn rods; this needs [stars]" in done.line


@pytest.mark.slow
def test_several_starts_are_compared_along_the_rods(design: Path) -> None:
    shape = asterism.simulate(asterism.load_design(design), starts=3)
    assert shape.summary["is_minimum"] and shape.summary["minima_seen"] >= 1
    assert shape.summary["minima"][0]["distance_percent"] == pytest.approx(0.0, abs=1e-9)
