"""`--contact` as a user meets it: what is said without it, and without the package it needs."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROLLED = """
[stars]
length_mm = 10.0
thickness_mm = 0.2
[border]
rings = 2
[mesh]
edge_mm = 4.3
"""
# the command line as it is where ipctk is not installed
WITHOUT = "import sys; sys.modules['ipctk'] = None; from asterism.cli import main; main()"


def run(start: list[str], *words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *start, "simulate", "d.toml", *words]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300)


def test_a_sheet_that_passes_through_itself_is_told(tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(ROLLED)
    result = run(["-m", "asterism"], cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "passes through itself" in result.stderr and "--contact" in result.stderr
    summary = json.loads((tmp_path / "d" / "summary.json").read_text())
    assert summary["self_intersections"] > 0 and summary["self_contact"] is None


def test_contact_keeps_it_apart(tmp_path: Path) -> None:
    pytest.importorskip("ipctk")
    (tmp_path / "d.toml").write_text(ROLLED)
    result = run(["-m", "asterism"], "--contact", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "passes through itself" not in result.stderr
    summary = json.loads((tmp_path / "d" / "summary.json").read_text())
    assert summary["self_intersections"] == 0 and summary["is_minimum"] and summary["design"]["solver"]["contact"]
    contact = summary["self_contact"]
    assert contact["closest_possible_mm"] < contact["least_distance_mm"] < contact["begins_at_mm"]
    assert contact["pairs"] > 0 and summary["energy_parts_n_mm"]["contact"] > 0.0


@pytest.mark.parametrize("words", [["--contact"], []], ids=["option", "design"])
def test_without_the_package_it_is_one_line(words: list[str], tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(ROLLED + ("" if words else "[solver]\ncontact = true\n"))
    result = run(["-c", WITHOUT], *words, cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr == "asterism: solver.contact: needs the package ipctk: pip install ipctk\n"
    assert [file.name for file in tmp_path.iterdir()] == ["d.toml"]


def test_no_contact_overrides_the_design(tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(ROLLED.replace("rings = 2", "rings = 0") + "[solver]\ncontact = true\n")
    result = run(["-c", WITHOUT], "--no-contact", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
