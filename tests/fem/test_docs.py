"""The programs of the page on shells run and find minima; the tests that the page on validation names exist."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
FREE, SUPPORTED = re.findall(
    r"```python\n(.*?)```", (ROOT / "docs" / "how-to" / "shell.md").read_text(encoding="utf-8"), re.DOTALL
)


def names_after(program: str) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(program, names)
    return names


def test_the_free_sheet_finds_a_minimum() -> None:
    names = names_after(FREE)
    assert names["found"].is_minimum
    assert names["places"].shape == (2, 3)
    assert np.linalg.norm(names["places"][1] - names["places"][0]) < 0.8 * 50.0 * np.sqrt(2.0)


def test_the_sheet_on_its_corners_rises_in_the_middle() -> None:
    names = names_after(SUPPORTED)
    assert names["found"].is_minimum
    assert abs(names["middle"][0, 2]) > 1.0


def test_the_page_on_validation_names_every_file() -> None:
    page = (ROOT / "docs" / "validation" / "index.md").read_text(encoding="utf-8")
    files = {path.name for path in (ROOT / "tests" / "validation").glob("test_*.py")}
    assert {name for name in re.findall(r"`(test_\w+\.py)`", page)} == files
