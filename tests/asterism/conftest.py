"""Fixtures of the commands' tests."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from asterism.shape.shape import Shape


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
    monkeypatch.setattr("asterism.reports.design_page._picture", lambda figure, shape: None)
