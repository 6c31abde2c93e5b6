"""Files that other programs change while a page shows them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.asterism.studio.browser import StudioPage, running_studio
from tests.asterism.studio.page.conftest import pages_of

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow

BROKEN = "[stars]\nlength_mm = -1\n"


def test_another_stretch_is_learned(new_page: Callable[[], StudioPage]) -> None:
    page = new_page()
    page.open("gallery-dome")
    page.item("tab-sheet").click()
    field = page.item("stretch")
    field.fill("1.5")
    field.press("Enter")
    page.rest()
    page.page.get_by_text("It learns other stretches when they are first used").wait_for()
    assert page.page.evaluate("studio.state.problem") is None


def test_saving_asks_before_it_replaces_a_file_with_a_mistake(new_page: Callable[[], StudioPage], folder: Path) -> None:
    text = (folder / "canopy.toml").read_text(encoding="utf-8")
    file = folder / "roof.toml"
    file.write_text(text, encoding="utf-8")
    page = new_page()
    page.open("file-roof.toml")
    page.drag((0, 0), (5, 5))
    page.rest()
    file.write_text(BROKEN, encoding="utf-8")
    page.item("save").click()
    page.page.get_by_text("Nothing is written yet").wait_for()
    assert file.read_text(encoding="utf-8") == BROKEN
    page.page.get_by_role("button", name="Keep mine").click()
    page.wait("studio.document.saved")
    assert "override" in file.read_text(encoding="utf-8")


def test_the_first_page_lists_a_design_that_is_put_into_the_folder_while_it_is_shown(
    browser: Any, tmp_path: Path, folder: Path
) -> None:
    with running_studio(tmp_path) as url, pages_of(browser, url) as make:
        page = make()
        page.item("new").wait_for()
        (tmp_path / "late.toml").write_text((folder / "canopy.toml").read_text(encoding="utf-8"), encoding="utf-8")
        page.item("file-late.toml").wait_for(timeout=20_000)
        page.item("new").focus()
        (tmp_path / "late.toml").unlink()
        page.item("file-late.toml").wait_for(state="detached", timeout=20_000)
        assert page.get("document.activeElement.dataset.testid") == "new"
