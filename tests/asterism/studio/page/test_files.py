"""Files that other programs change while a page shows them."""

from __future__ import annotations

from pathlib import Path

from tests.asterism.studio.browser import StudioPage

BROKEN = "[stars]\nlength_mm = -1\n"


def test_saving_asks_before_it_replaces_a_file_with_a_mistake(page: StudioPage, folder: Path) -> None:
    text = (folder / "canopy.toml").read_text(encoding="utf-8")
    file = folder / "roof.toml"
    file.write_text(text, encoding="utf-8")
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
