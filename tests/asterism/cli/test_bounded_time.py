"""Every command says what it costs, asks before large computations, and ends within a budget."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.asterism.commands import command

SMALL = "[stars]\nlength_mm = 10.0\nthickness_mm = 0.4\n[border]\nrings = 0\n[mesh]\nedge_mm = 4.0\n"
LARGE = SMALL.replace("rings = 0", "rings = 8").replace("4.0", "0.5")


@pytest.mark.parametrize("words", [["simulate", "d.toml"], ["verify", "d.toml"], ["export", "d.toml", "--simulate"]])
def test_a_large_computation_needs_consent(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(LARGE)
    refused = command(words, capsys, monkeypatch)
    assert refused.status == 2
    assert "takes about 2829" in refused.line and "use --yes to compute it, or a larger mesh.edge_mm" in refused.line
    assert [file.name for file in tmp_path.iterdir()] == ["d.toml"]


@pytest.mark.usefixtures("blank_pictures")
def test_a_search_beyond_its_budget_ends_with_its_state_and_status_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("asterism.discrete.release.continuation.MAX_RELEASE_ITERATIONS", 12)
    (tmp_path / "d.toml").write_text(SMALL)
    done = command(["simulate", "d.toml", "--starts", "1"], capsys, monkeypatch)
    assert done.status == 1 and "not an equilibrium: gradient" in done.err
    assert "about 42 vertices, 0.2 GB, 2 s" in done.err
    summary = json.loads((tmp_path / "d" / "summary.json").read_text())
    assert summary["iterations"] == 12 and not summary["is_minimum"] and summary["gradient_norm"] > 0
