"""Results of one kind replace those of another in the same folder, and nothing else."""

from __future__ import annotations

import errno
import os
from dataclasses import replace
from pathlib import Path

import pytest

from asterism.reports.write_results import write_results
from asterism.results.files import OutputError, staged_result
from asterism.shape.shape import Shape
from tests.asterism.sheets import dome, sheet

KINDS = {
    "simulate": {"summary.json", "shape.vtu", "rods.vtu", "shape.obj", "shape.png", "minimum-2.vtu", "minimum-2.png"},
    "verify": {"summary.json", "report.html", "exact.vtu", "preview.vtu", "exact.obj", "preview.obj"},
    "compare": {"summary.json", "compare.png"},
    "law show": {"summary.json", "law.png"},
}
MINE = {"notes.txt", "my shape.vtu", "shape.vtu.bak", "shape.stl", "export.json", "minimum-2.txt"}


def fill(folder: Path, names: set[str]) -> None:
    folder.mkdir(exist_ok=True)
    for name in names:
        (folder / name).write_text("old")


def names(folder: Path) -> set[str]:
    return {file.name for file in folder.iterdir()}


@pytest.fixture(scope="module")
def shape() -> Shape:
    made = sheet(dome)
    made = replace(made, summary=made.summary | {"design": {"name": "dome"}})
    return made


@pytest.mark.parametrize("after", KINDS)
def test_one_kind_is_left(after: str, tmp_path: Path) -> None:
    fill(tmp_path, set().union(*KINDS.values()) | MINE)
    with staged_result(tmp_path) as folder:
        fill(folder, KINDS[after])
    assert names(tmp_path) == KINDS[after] | MINE


@pytest.mark.usefixtures("blank_pictures")
def test_a_failure_leaves_the_other_kind_whole(shape: Shape, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fill(tmp_path, KINDS["verify"])
    move = os.replace

    def full(source: Path, target: Path) -> None:
        if target == tmp_path / "rods.vtu":
            raise OSError(errno.ENOSPC, "No space left on device")
        move(source, target)

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OutputError, match="the disk is full"):
        write_results(shape, tmp_path)
    assert names(tmp_path) == KINDS["verify"]


@pytest.mark.usefixtures("blank_pictures")
def test_a_folder_that_holds_no_result_keeps_its_files(shape: Shape, tmp_path: Path) -> None:
    """A report of something else, in the folder where results are now written."""
    fill(tmp_path, {"report.html", "cells.csv"})
    written = write_results(shape, tmp_path)
    assert names(tmp_path) == set(written) | {"report.html", "cells.csv"}
