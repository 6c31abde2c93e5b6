"""What belongs to a design goes when another one opens: messages, target, symmetry, kept designs, drawings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.asterism.studio.browser import StudioPage
from tests.asterism.studio.page.conftest import FINE
from tests.asterism.studio.page.test_view import cap
from tests.asterism.studio.test_drawings import SVG

NAMES = ("first", "second", "third")


@pytest.fixture
def designs(folder: Path) -> dict[str, Path]:
    """Three design files without unsaved work."""
    for name, length in zip(NAMES, (8.0, 7.0, 6.0), strict=True):
        text = f'name = "{name}"\n[stars]\nlength_mm = {length}\n[border]\nrings = 1\n'
        (folder / f"{name}.toml").write_text(text + FINE, encoding="utf-8")
        for file in folder.glob(f".{name}.autosave*"):
            file.unlink()
    return {name: folder / f"{name}.toml" for name in NAMES}


def test_a_message_goes_with_its_design_and_its_button_replaces_no_file_by_another_one(
    flat: StudioPage, designs: dict[str, Path]
) -> None:
    page = flat
    page.open("file-first.toml")
    before = designs["third"].read_text(encoding="utf-8")
    replace = page.page.get_by_role("button", name="Replace it")
    page.fill("name", "third")
    replace.wait_for()
    assert page.item("name").input_value() == "first"
    page.open("file-second.toml")
    assert replace.count() == 0 and designs["third"].read_text(encoding="utf-8") == before

    page.fill("name", "third")
    replace.wait_for()
    page.open("file-first.toml")
    assert replace.count() == 0 and page.item("toast").count() == page.item("problem").count() == 0
    page.fill("name", "third")
    replace.click()
    page.wait("studio.document.name === 'third' && studio.document.saved")
    assert designs["third"].read_bytes() == designs["first"].read_bytes()
    assert "second" in designs["second"].read_text(encoding="utf-8")


def test_a_drawing_on_the_first_page_is_a_new_design_if_it_can_be_read_and_the_open_one_stays(
    flat: StudioPage, designs: dict[str, Path], tmp_path: Path
) -> None:
    page, drawing = flat, tmp_path / "plan.svg"
    drawing.write_text("no drawing", encoding="utf-8")
    page.open("file-first.toml", "brush")
    page.changed(lambda: page.drag((0, 0), (5, 5)))
    text, edited = designs["first"].read_text(encoding="utf-8"), page.get("studio.document.design")
    page.item("open").click()
    page.upload("new-drawing", drawing)
    page.item("problem").wait_for()
    assert page.item("start").is_visible() and page.get("studio.document.name") == "first"
    assert "422" in page.complaints.pop()  # the browser notes the refusal
    drawing.write_text(SVG, encoding="utf-8")
    page.upload("new-drawing", drawing)
    page.item("drawing-use-beside").select_option("none")
    assert page.get("studio.document.name").startswith("sheet") and not page.item("start").is_visible()
    page.item("drawing-go").click()
    page.wait("studio.document.design.rods")
    assert page.get("studio.document.name").startswith("sheet") and not page.get("studio.document.has_file")
    assert designs["first"].read_text(encoding="utf-8") == text
    page.open("file-first.toml")
    assert page.get("studio.document.design.stars") == {"length_mm": 8.0}
    page.page.get_by_role("button", name="Bring them back").click()
    page.wait("studio.document.design.stars.override")
    assert page.get("studio.document.design") == edited


def test_target_symmetry_kept_designs_and_a_drawing_go_when_any_page_opens_another_design(
    new_flat: Callable[[], StudioPage], designs: dict[str, Path], tmp_path: Path
) -> None:
    (tmp_path / "plan.svg").write_text(SVG, encoding="utf-8")
    page = new_flat()
    page.open("file-first.toml", "brush")
    page.item("mirrorX").check()
    page.item("tool-ruler").click()
    page.drag((0, 0), (5, 5))
    assert page.get("studio.measured") is not None
    page.load_target(cap(tmp_path / "cap.stl"))
    page.item("keep-A").click()
    page.wait("studio.state.slots.A")
    page.page.keyboard.press("Control+a")
    page.upload("import-drawing", tmp_path / "plan.svg")
    page.item("drawing-dialog").wait_for()
    assert page.get("studio.selection.length") > 0

    other = new_flat()
    other.open("file-second.toml")
    page.wait("studio.document.name === 'second'")
    page.rest()
    page.wait("!studio.target && !studio.state.slots.A")
    assert not page.item("drawing-dialog").is_visible() and not page.item("show-A").count()
    assert page.get("studio.selection") == [] and page.get("studio.measured") is None
    for one in (page, other):
        one.item("tool-brush").click()
        assert not one.item("mirrorX").is_checked()
    page.changed(lambda: page.drag((15, 0), (16, 0)))
    assert page.get("studio.document.design.stars.override.length") == 2  # four with a mirror
    assert page.get("studio.state.slots.A") is None
