"""A folder with a design, and the command line in it."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import pytest

from asterism.pattern.design.design import save_design
from tests.asterism.commands import command
from tests.asterism.print.exported import Run
from tests.asterism.print.jobs import design


@pytest.fixture
def as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """The command line in the test's folder, within this process: starting one anew takes seconds."""
    monkeypatch.chdir(tmp_path)
    return lambda *words: command(list(words), capsys, monkeypatch)


@pytest.fixture
def run(as_it_is: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """The same with letters as drawings in PDF: to take from a font what is used is most of the time of an export."""
    settings = matplotlib.rc_context
    monkeypatch.setattr(matplotlib, "rc_context", lambda given: settings({**given, "pdf.fonttype": 3}))
    return as_it_is


@pytest.fixture
def file(tmp_path: Path) -> Path:
    save_design(design(mesh={"edge_mm": 6.0}), tmp_path / "d.toml")
    return tmp_path / "d.toml"
