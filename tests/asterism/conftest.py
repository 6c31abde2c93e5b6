"""Fixtures of the commands' and the pages' tests."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from asterism.shape.shape import Shape
from tests.asterism.commands import Cli, command
from tests.asterism.studio.browser import ARGUMENTS, browser_path


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """A browser for all tests of pages: two of them in one process disturb each other."""
    path = browser_path()
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        launched = driver.chromium.launch(executable_path=path, args=list(ARGUMENTS))
        yield launched
        launched.close()


@pytest.fixture
def cli(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Cli:
    """The command line within this process: starting one anew takes seconds."""
    return lambda words: command(words, capsys, monkeypatch)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The test's folder, where its commands run."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(autouse=True)
def rough_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pixels are not the mean of four: pictures take a third of the time. A file whose tests need them fine says so."""
    monkeypatch.setattr("asterism.draw.render.SUPERSAMPLING", 1)


@pytest.fixture
def blank_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures beside results, and on the page of a report, are blank: to draw one takes a second."""

    def blank(shape: Shape, title: str, path: Path) -> None:
        Image.new("RGB", (8, 8)).save(path, format="png")

    monkeypatch.setattr("asterism.reports.write_results.draw_shape", blank)
    monkeypatch.setattr("asterism.reports.design_report._picture", lambda figure, shape: None)
