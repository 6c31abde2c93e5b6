"""The form of the cantilever test, filled in and read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pypdfium2
import pytest

from asterism.measure.overhang import read_overhangs
from asterism.measure.overhang_form import write_overhang_form
from asterism.results.csv_cells import TableError
from asterism.results.files import OutputError
from tests.asterism.commands import command


def filled(folder: Path, overhangs: list[float]) -> Path:
    """The form with these overhangs, row by row; the rest stays empty."""
    write_overhang_form(folder)
    table = folder / "overhangs.csv"
    head, *rows = table.read_text().splitlines()
    texts = [f"{value:g}" for value in overhangs] + [""] * (len(rows) - len(overhangs))
    table.write_text("\n".join([head, *(row + text for row, text in zip(rows, texts, strict=True))]) + "\n")
    return table


def test_readings_of_one_strip_count_as_one(tmp_path: Path) -> None:
    means = read_overhangs(filled(tmp_path, [50.0, 52.0, 54.0, 56.0, 60.0]))
    assert means == pytest.approx([float(np.prod([50.0, 52.0, 54.0, 56.0])) ** 0.25, 60.0])


def test_the_printed_page_holds_the_slope_and_the_last_step(tmp_path: Path) -> None:
    write_overhang_form(tmp_path)
    text = pypdfium2.PdfDocument(tmp_path / "overhangs.pdf")[0].get_textpage().get_text_bounded()
    assert "41.5 degrees at 1:1" in text and "asterism strips overhang overhangs.csv" in text


def test_a_table_that_was_filled_in_stays(tmp_path: Path) -> None:
    table = filled(tmp_path, [50.0])
    before = table.read_bytes()
    with pytest.raises(OutputError, match="may have been filled in"):
        write_overhang_form(tmp_path)
    assert table.read_bytes() == before


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("strip,overhang_mm\n1,\n", "no overhang has been measured"),
        ("strip,overhang_mm\n1,5\n", "row 2, column overhang_mm: 5 must be from 10 to 500 mm"),
        ("strip,overhang_mm\n,50\n", "needs a name"),
        ("strip,end,face,overhang_mm\n1,1,face,50\n1,1,face,51\n", "already in row 2"),
        ("strip\n1\n", "overhang_mm is missing"),
    ],
)
def test_wrong_tables_are_named(text: str, said: str, tmp_path: Path) -> None:
    table = tmp_path / "overhangs.csv"
    table.write_text(text)
    with pytest.raises(TableError, match=said):
        read_overhangs(table)


def test_the_command_writes_the_form_and_reads_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = command(["strips", "overhang", "--form", str(tmp_path / "hung")], capsys, monkeypatch)
    assert done.status == 0 and "overhangs.csv, overhangs.pdf" in done.out
    table = filled(tmp_path, [52.0] * 4 + [50.0] * 4 + [55.0] * 4 + [51.0] * 4)
    done = command(["strips", "overhang", str(table), "--mass", "250"], capsys, monkeypatch)
    assert done.status == 0 and "0.043 N mm (0.0354 to 0.0523 at 95 %)" in done.out
    for typed, said in (
        (["--form", "x", "--mass", "250"], "--form: writes an empty table"),
        (["--mass", "250"], "MM: give overhangs in mm or their table"),
        (["52"], "--mass: is missing"),
        (["5l", "--mass", "250"], "not '5l'"),
    ):
        refused = command(["strips", "overhang", *typed], capsys, monkeypatch)
        assert refused.status == 2 and said in refused.err
