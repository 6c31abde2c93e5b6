"""Files that other programs change while a page shows them."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.asterism.studio.browser import StudioPage

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow

BROKEN = "[stars]\nlength_mm = -1\n"


def test_another_stretch_is_learned(flat: StudioPage) -> None:
    flat.open_again("file-plain.toml")
    flat.item("tab-sheet").click()
    flat.fill("stretch", 1.5)
    flat.rest()
    flat.page.get_by_text("It learns other stretches when they are first used").wait_for()
    assert flat.page.evaluate("studio.state.problem") is None


def test_saving_asks_before_it_replaces_a_file_with_a_mistake(flat: StudioPage, folder: Path) -> None:
    file = folder / "roof.toml"
    file.write_text((folder / "canopy.toml").read_text(encoding="utf-8"), encoding="utf-8")
    flat.open("file-roof.toml")
    flat.item("tool-brush").click()
    flat.changed(lambda: flat.drag((0, 0), (5, 5)))
    file.write_text(BROKEN, encoding="utf-8")
    flat.item("save").click()
    flat.page.get_by_text("Nothing is written yet").wait_for()
    assert file.read_text(encoding="utf-8") == BROKEN
    flat.page.get_by_role("button", name="Keep mine").click()
    flat.wait("studio.document.saved")
    assert "override" in file.read_text(encoding="utf-8")


def test_the_first_page_lists_a_design_that_is_put_into_the_folder_while_it_is_shown(
    flat: StudioPage, folder: Path
) -> None:
    flat.open_again("file-even.toml")
    flat.item("open").click()
    (folder / "late.toml").write_text((folder / "canopy.toml").read_text(encoding="utf-8"), encoding="utf-8")
    flat.item("file-late.toml").wait_for(timeout=20_000)
    flat.item("new").focus()
    (folder / "late.toml").unlink()
    flat.item("file-late.toml").wait_for(state="detached", timeout=20_000)
    assert flat.get("document.activeElement.dataset.testid") == "new"
    flat.page.keyboard.press("Escape")
