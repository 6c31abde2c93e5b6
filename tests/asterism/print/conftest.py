"""A folder with a design, and the command line in it."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import pytest

from asterism.pattern.design import files
from asterism.pattern.design.design import save_design
from tests.asterism.commands import Cli
from tests.asterism.print.jobs import Run, design


@pytest.fixture(autouse=True)
def no_profiles_of_the_user(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The person who runs the tests may have profiles."""
    monkeypatch.delenv(files.PROFILES_VARIABLE, raising=False)
    monkeypatch.setattr(files, "user_folder", lambda: tmp_path / "home")


@pytest.fixture
def run(here: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> Run:
    """The command line in the test's folder, with letters as drawings in PDF.

    To take from a font what is used is most of the time of an export.
    """
    settings = matplotlib.rc_context
    monkeypatch.setattr(matplotlib, "rc_context", lambda given: settings({**given, "pdf.fonttype": 3}))
    return lambda *words: cli(list(words))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """On the paper's fabric, whose law need not be learned."""
    save_design(design(fabric={}, mesh={"edge_mm": 6.0}), tmp_path / "d.toml")
    return tmp_path / "d.toml"
