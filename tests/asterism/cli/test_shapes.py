"""`asterism verify`, and `--contact` of `simulate`: what is said without it, and without the package it needs."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from asterism.homogenize.law.law_file import law_bytes
from tests.asterism.commands import Cli
from tests.asterism.previews.laws import plain_law

SEVEN = """
[stars]
length_mm = 8.0
[border]
rings = 1
[mesh]
edge_mm = 3.5
"""


@pytest.mark.slow
def test_verify_writes_a_report_and_a_table(here: Path, cli: Cli) -> None:
    (here / "d.toml").write_text(SEVEN)
    (here / "law.npz").write_bytes(law_bytes(plain_law()))
    (here / "d-verified").mkdir()
    for earlier in ("summary.json", "shape.vtu", "rods.vtu", "shape.png"):
        (here / "d-verified" / earlier).write_text('{"version": "of simulate"}')
    result = cli(["verify", "d.toml", "--law", "law.npz"]).done
    assert "% of the diameter rms" in result.out and "same form" in result.out
    # what is seen while waiting
    said = ("preview done in", "released from the flat print", "started from the preview", "comparing", "report")
    assert [result.err.index(text) for text in said] == sorted(result.err.index(text) for text in said)
    assert sorted(file.name for file in (here / "d-verified").iterdir()) == [
        "exact.obj", "exact.vtu", "preview.obj", "preview.vtu", "report.html", "summary.json",
    ]  # fmt: skip
    summary = json.loads((here / "d-verified" / "summary.json").read_text())
    assert summary["preview"]["model"] == "preview" and summary["exact"]["is_minimum"]
    assert 0.0 < summary["rms_percent"] < 30.0
    expected, height = (summary[f"expected_{what}_percent"] for what in ("rms", "height"))
    line = next(line for line in result.out.splitlines() if line.startswith("  estimated error      "))
    assert f" {expected:.1f} % of the diameter of " in line and line.endswith(f" ({height:.0f} %)")


ROLLED = """
[stars]
length_mm = 10.0
thickness_mm = 0.2
[border]
rings = 2
[mesh]
edge_mm = 4.3
[fabric]
bending = "paper"
"""


@pytest.fixture
def rolled(here: Path, blank_pictures: None) -> Path:
    """The folder with a design that passes through itself."""
    (here / "d.toml").write_text(ROLLED)
    return here


@pytest.mark.slow
def test_a_sheet_that_passes_through_itself_is_told(rolled: Path, cli: Cli) -> None:
    result = cli(["simulate", "d.toml", "--starts", "1"]).done
    assert "passes through itself" in result.err and "--contact" in result.err
    summary = json.loads((rolled / "d" / "summary.json").read_text())
    assert summary["self_intersections"] > 0 and summary["self_contact"] is None


@pytest.mark.slow
def test_contact_keeps_it_apart(rolled: Path, cli: Cli) -> None:
    pytest.importorskip("ipctk")
    result = cli(["simulate", "d.toml", "--contact"]).done
    assert "passes through itself" not in result.err
    summary = json.loads((rolled / "d" / "summary.json").read_text())
    assert summary["self_intersections"] == 0 and summary["is_minimum"] and summary["design"]["solver"]["contact"]
    contact = summary["self_contact"]
    assert contact["closest_possible_mm"] < contact["least_distance_mm"] < contact["begins_at_mm"]
    assert contact["pairs"] > 0 and summary["energy_parts_n_mm"]["contact"] > 0.0


def test_without_the_package_a_design_with_contact_is_one_line(rolled: Path, monkeypatch, cli: Cli) -> None:
    monkeypatch.setitem(sys.modules, "ipctk", None)
    (rolled / "d.toml").write_text(ROLLED + "[solver]\ncontact = true\n")
    needed = "asterism: d.toml: solver.contact: needs the package ipctk: pip install ipctk"
    assert cli(["simulate", "d.toml"]).refusal == needed
    assert [file.name for file in rolled.iterdir()] == ["d.toml"]
    # the option overrides the design
    (rolled / "d.toml").write_text(ROLLED.replace("rings = 2", "rings = 0") + "[solver]\ncontact = true\n")
    assert cli(["simulate", "d.toml", "--no-contact"]).done
