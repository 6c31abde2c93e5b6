"""`asterism printers`: the list, with a broken file of one's own."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.asterism.print.exported import Run


def test_printers_are_listed(tmp_path: Path, run: Run) -> None:
    result = run("printers")
    assert result.status == 0
    assert "ultimaker2" in result.out and "tpu95a" in result.out and "ASTERISM_PROFILES" in result.out


def test_a_broken_file_of_ones_own_does_not_hide_the_others(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ASTERISM_PROFILES", str(tmp_path))
    for kind in ("printers", "plastics"):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / "broken.toml").write_text('name = "x"\nwrong = 1\n')
    result = run("printers")
    assert result.status == 2
    assert all(name in result.out for name in ("ender-3", "ultimaker2", "tpu95a", "ASTERISM_PROFILES"))
    assert "  broken" not in result.out
    lines = result.err.splitlines()
    assert len(lines) == 2
    for kind, line in zip(("printers", "plastics"), lines, strict=True):
        assert line.startswith(f"asterism: {tmp_path / kind / 'broken.toml'}: wrong = 1: unknown key")
