"""asterism verify as a user meets it."""

from __future__ import annotations

import json
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
    result = cli(["verify", "d.toml", "--law", "law.npz"])
    assert result.status == 0, result.err
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


def test_mistakes_are_one_line_and_leave_nothing(here: Path, cli: Cli) -> None:
    (here / "d.toml").write_text(SEVEN)
    (here / "not.npz").write_text("a law?")
    (here / "other.toml").write_text(SEVEN + '[fabric]\nbending = "none"\n')
    (here / "hinges.toml").write_text(SEVEN + '[fabric]\nbending = "paper"\n')
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
        refused = cli(["verify", *words])
        assert refused.status == 2 and said in refused.err.splitlines()[-1]
    assert sorted(file.name for file in here.iterdir()) == ["d.toml", "hinges.toml", "not.npz", "other.toml"]
