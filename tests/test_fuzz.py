"""Mutated inputs over all commands, and what counts as a failure of one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from asterism.shape.vtu import write_shape_vtu
from benchmarks.fuzz.cases import Case
from benchmarks.fuzz.run import failures
from tests.asterism.sheets import sheet

CASE = Case(0, "design", ("preview", "design.toml"))
TRACEBACK = "Traceback (most recent call last):\n  File\nKeyError: 'stars'\n"


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="the cases are copies of a running process")
def test_mutated_inputs_end_as_they_should() -> None:
    words = [sys.executable, "-m", "benchmarks.fuzz", "40"]
    done = subprocess.run(words, cwd=Path(__file__).parents[1], capture_output=True, text=True, timeout=900)
    assert done.returncode == 0 and ": 0 failures." in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("status", "errors", "new", "expected"),
    [
        (2, "asterism: d.toml: is empty", {}, None),
        (99, TRACEBACK, {}, "traceback: KeyError: 'stars'"),
        (-signal.SIGSEGV, "", {}, "ended by SIGSEGV"),
        (2, "", {}, "exit status 2 without a line"),
        (1, "", {}, "exit status 1 without a reason"),
        (2, "asterism: no", {"out.txt": "half"}, "exit status 2, and left ['out.txt']"),
        (0, "", {".asterism-12ab": ""}, "left ['.asterism-12ab']"),
        (0, "", {"summary.json": '{"height_mm": NaN}'}, "summary.json holds NaN"),
    ],
)
def test_failures_are_named(
    status: int, errors: str, new: dict[str, str], expected: str | None, tmp_path: Path
) -> None:
    for name, text in new.items():
        (tmp_path / name).write_text(text)
    lines = list(failures(CASE, status, errors, tmp_path, set()))
    assert lines == [] if expected is None else lines[0].startswith(expected) and len(lines) == 1


@pytest.mark.parametrize(("factor", "expected"), [(1.2, False), (1.3, True), (np.nan, True)])
def test_a_sheet_much_larger_than_its_print_is_a_failure(factor: float, expected: bool, tmp_path: Path) -> None:
    write_shape_vtu(sheet(lambda p: factor * np.column_stack([p, 0 * p[:, 0]])), tmp_path / "shape.vtu")
    assert bool(list(failures(CASE, 0, "", tmp_path, set()))) is expected
