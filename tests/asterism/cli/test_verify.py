"""asterism verify as a user meets it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from asterism.homogenize.law.law_file import law_bytes
from tests.asterism.cli.test_main import run
from tests.asterism.commands import command
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
def test_verify_writes_a_report_and_a_table(tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(SEVEN)
    (tmp_path / "law.npz").write_bytes(law_bytes(plain_law()))
    (tmp_path / "d-verified").mkdir()
    for earlier in ("summary.json", "shape.vtu", "rods.vtu", "shape.png"):
        (tmp_path / "d-verified" / earlier).write_text('{"version": "of simulate"}')
    result = run("verify", "d.toml", "--law", "law.npz", cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "% of the diameter rms" in result.stdout and "same form" in result.stdout
    # what is seen while waiting
    said = ("preview done in", "released from the flat print", "started from the preview", "comparing", "report")
    assert [result.stderr.index(text) for text in said] == sorted(result.stderr.index(text) for text in said)
    assert sorted(file.name for file in (tmp_path / "d-verified").iterdir()) == [
        "exact.obj", "exact.vtu", "preview.obj", "preview.vtu", "report.html", "summary.json",
    ]  # fmt: skip
    summary = json.loads((tmp_path / "d-verified" / "summary.json").read_text())
    assert summary["preview"]["model"] == "preview" and summary["exact"]["is_minimum"]
    assert 0.0 < summary["rms_percent"] < 30.0
    expected, height = (summary[f"expected_{what}_percent"] for what in ("rms", "height"))
    line = next(line for line in result.stdout.splitlines() if line.startswith("  estimated error      "))
    assert f" {expected:.1f} % of the diameter of " in line and line.endswith(f" ({height:.0f} %)")


def test_mistakes_are_one_line_and_leave_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SEVEN)
    (tmp_path / "not.npz").write_text("a law?")
    (tmp_path / "other.toml").write_text(SEVEN + '[fabric]\nbending = "none"\n')
    (tmp_path / "hinges.toml").write_text(SEVEN + '[fabric]\nbending = "paper"\n')
    for words, said in (
        (["d.toml", "--law", "not.npz"], "not.npz"),
        (["no.toml"], "no.toml"),
        (["d.toml", "--backend", "none"], "backend: 'none'"),
        (["d.toml", "--edge", "1000"], "--edge"),
        (["d.toml", "--tolerance", "1", "--edge", "3"], "--tolerance: goes without --edge"),
        (["hinges.toml", "--tolerance", "1"], "--tolerance: not for fabric.bending = 'paper'"),
        (["d.toml", "--tolerance", "0"], "--tolerance = 0.0"),
        (["other.toml"], "fabric.bending"),
    ):
        refused = command(["verify", *words], capsys, monkeypatch)
        assert refused.status == 2 and said in refused.err.splitlines()[-1]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["d.toml", "hinges.toml", "not.npz", "other.toml"]
