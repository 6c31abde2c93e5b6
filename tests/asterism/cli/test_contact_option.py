"""`--contact` as a user meets it: what is said without it, and without the package it needs."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from tests.asterism.commands import Cli

pytestmark = pytest.mark.usefixtures("blank_pictures")
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
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(ROLLED)
    return tmp_path


@pytest.mark.slow
def test_a_sheet_that_passes_through_itself_is_told(folder: Path, cli: Cli) -> None:
    result = cli(["simulate", "d.toml", "--starts", "1"])
    assert result.status == 0, result.err
    assert "passes through itself" in result.err and "--contact" in result.err
    summary = json.loads((folder / "d" / "summary.json").read_text())
    assert summary["self_intersections"] > 0 and summary["self_contact"] is None


@pytest.mark.slow
def test_contact_keeps_it_apart(folder: Path, cli: Cli) -> None:
    pytest.importorskip("ipctk")
    result = cli(["simulate", "d.toml", "--contact"])
    assert result.status == 0, result.err
    assert "passes through itself" not in result.err
    summary = json.loads((folder / "d" / "summary.json").read_text())
    assert summary["self_intersections"] == 0 and summary["is_minimum"] and summary["design"]["solver"]["contact"]
    contact = summary["self_contact"]
    assert contact["closest_possible_mm"] < contact["least_distance_mm"] < contact["begins_at_mm"]
    assert contact["pairs"] > 0 and summary["energy_parts_n_mm"]["contact"] > 0.0


def test_without_the_package_a_design_with_contact_is_one_line(folder: Path, monkeypatch, cli: Cli) -> None:
    monkeypatch.setitem(sys.modules, "ipctk", None)
    (folder / "d.toml").write_text(ROLLED + "[solver]\ncontact = true\n")
    refused = cli(["simulate", "d.toml"])
    assert refused.status == 2
    assert refused.err == "asterism: d.toml: solver.contact: needs the package ipctk: pip install ipctk\n"
    assert [file.name for file in folder.iterdir()] == ["d.toml"]


@pytest.mark.slow
def test_no_contact_overrides_the_design(folder: Path, monkeypatch, cli: Cli) -> None:
    monkeypatch.setitem(sys.modules, "ipctk", None)
    (folder / "d.toml").write_text(ROLLED.replace("rings = 2", "rings = 0") + "[solver]\ncontact = true\n")
    result = cli(["simulate", "d.toml", "--no-contact"])
    assert result.status == 0, result.err
