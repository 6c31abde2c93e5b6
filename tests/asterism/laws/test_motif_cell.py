"""`asterism law cell`: the cell of a motif, or why there is none."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.asterism.commands import Outcome, command

HEAD = "[border]\nrectangle_mm = [60, 60]\n[mesh]\nedge_mm = 2.5\n[rods]\nthickness_mm = 0.4\n"
LINE = HEAD + '[[rods.motif]]\nline_mm = [[0, 0], [5, 0]]\n[lattice]\nkind = "square"\nspacing_mm = 5\n'
ENDS = ("[5, 8.66025403784]", "[5, -8.66025403784]", "[-10, 0]")
HONEYCOMB = (
    HEAD
    + "".join(f"[[rods.motif]]\nline_mm = [[0, 0], {end}]\n" for end in ENDS)
    + '[lattice]\nkind = "custom"\nvectors_mm = [[15, 8.66025403784], [15, -8.66025403784]]\n'
)


def run(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Outcome:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(text)
    return command(["law", "cell", "d.toml"], capsys, monkeypatch)


@pytest.mark.slow
def test_lines_roll_along_and_not_across(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = run(LINE.replace("2.5", "1.6"), tmp_path, capsys, monkeypatch)
    assert done.status == 0, done.err
    rows = {line[:22].strip(): line[22:].strip() for line in done.out.splitlines()}
    assert rows["flat stretches"] == "0.6730 along 90 deg, 0.9995 across"
    assert rows["2 x 2 cells"] == "0.00 % less energy than one cell"
    assert rows["around 0 deg"].startswith("curvature 0.0123/mm, stretches 0.999 around and 0.673 along")
    assert rows["around 90 deg"].startswith("curvature 0.0000/mm")


@pytest.mark.slow
def test_a_honeycomb_ends_with_status_1_and_the_reason(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = run(HONEYCOMB, tmp_path, capsys, monkeypatch)
    assert done.status == 1
    assert "not reliable         the motif has no law of one cell: 2 x 2 cells relax to" in done.out


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[stars]\nlength_mm = 8\n[border]\nrings = 1\n", "rods: is missing: the cell of stars has a law"),
        (LINE.replace("= 0.4", '= { formula = "0.3+0.001*r" }'), "rods.thickness_mm: must be a number"),
        (LINE + "[gravity]\non = true\n[fabric]\nmodulus_mpa = 7.0\n", "gravity.on: a cell has no weight"),
        (LINE.replace("[5, 0]]", "[7, 0]]"), "rods: two lines named motif[0] lie on each other"),
    ],
)
def test_designs_without_a_cell_are_refused(
    text: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = run(text, tmp_path, capsys, monkeypatch)
    assert done.status == 2 and done.err.count("asterism: ") == 1
    assert f"asterism: d.toml: {message}" in done.err
