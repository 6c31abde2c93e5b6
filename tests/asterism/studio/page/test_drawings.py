"""Drawings on the page: chosen or dropped, layer by layer, with a question for the unit, undo and refusals."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.asterism.studio.browser import StudioPage
from tests.asterism.studio.test_drawings import SVG
from tests.asterism.studio.test_uploads import dxf

# the README's tests open the page in `test_page` only
pytestmark = pytest.mark.slow

DROP = """([name, text]) => {
    const data = new DataTransfer();
    data.items.add(new File([text], name));
    for (const kind of ["dragenter", "dragover", "drop"])
        document.getElementById("work").dispatchEvent(
            new DragEvent(kind, { dataTransfer: data, bubbles: true, cancelable: true }));
}"""


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    (tmp_path / "plan.svg").write_text(SVG, encoding="utf-8")
    return tmp_path / "plan.svg"


def test_layers_of_a_drawing_become_rods_and_outline_and_are_undone(shared: StudioPage, plan: Path) -> None:
    shared.open("gallery-star")
    shared.page.keyboard.press("?")
    shared.page.get_by_text("Put a drawing on the sheet", exact=True).wait_for()
    shared.page.keyboard.press("Escape")
    before = shared.get("studio.document.design")
    shared.upload("import-drawing", plan)
    shared.item("drawing-dialog").wait_for()
    assert shared.item("drawing-use-cut").input_value() == "outline"  # by its name
    assert shared.item("drawing-use-ribs").input_value() == "rods"
    assert not shared.item("drawing-sheet").is_visible()  # the drawing has an outline
    shared.item("drawing-use-cut").select_option("none")
    assert shared.item("drawing-sheet").is_visible()
    shared.item("drawing-use-cut").select_option("outline")
    for layer in ("rim", "notes", "beside"):
        shared.item(f"drawing-use-{layer}").select_option("none")
    assert shared.item("drawing-strokes").is_checked() and not shared.item("drawing-width-ribs").is_visible()
    shared.item("drawing-strokes").click()
    shared.fill("drawing-width-ribs", 30)
    shared.page.get_by_text("From 0.1 mm to 10 mm").wait_for()
    shared.fill("drawing-width-ribs", 1.5)
    shared.fill("drawing-thickness-ribs", 0.5)
    shared.item("drawing-go").click()
    shared.wait("studio.document.design.rods && studio.shownRevision === studio.revision")
    assert shared.get("studio.document.design.rods.width_mm") == 1.5
    assert shared.get("studio.document.plan.holes_mm.length") == 1
    assert shared.item("stars").inner_text() == "4 rods" and not shared.item("drawing-dialog").is_visible()
    shared.page.get_by_role("button", name="Undo", exact=True).last.click()
    shared.wait("!studio.document.design.rods")
    assert shared.get("studio.document.design") == before


def test_a_dropped_drawing_without_a_unit_is_asked_for_it(shared: StudioPage) -> None:
    shared.open("gallery-star")

    def draw(space: Any) -> None:
        space.add_lwpolyline([(-2, 0), (2, 0), (3, 2)])
        space.add_text("a")

    shared.page.evaluate(DROP, ["ribs.dxf", dxf(draw, unit=0).decode()])
    shared.item("drawing-unit").select_option("cm")
    shared.item("drawing-unit-go").click()
    shared.item("drawing-dialog").wait_for()
    assert shared.item("drawing-size").inner_text() == "50.0 × 20.0 mm, 1 layer"
    shared.page.get_by_text("Left out: 1 text.").wait_for()
    shared.item("drawing-go").click()
    shared.wait("studio.document.design.rods?.import[0].file === 'ribs.dxf'")
    shared.page.get_by_text("ribs.dxf is on the sheet; left out: 1 text.").wait_for()
    assert shared.get("studio.document.plan.rods.length") == 2  # cut at the corner
    shared.page.evaluate(DROP, ["notes.txt", "none"])
    shared.page.get_by_text("notes.txt is no drawing").wait_for()
    shared.page.evaluate(DROP, ["empty.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm'/>"])
    shared.page.get_by_text("empty.svg: holds no line with a stroke").wait_for()
    assert "422" in shared.complaints.pop()  # the browser notes the refusal


def test_a_refused_drawing_says_why_in_its_dialog(shared: StudioPage, plan: Path) -> None:
    shared.open("gallery-star")
    before = shared.get("studio.document.design")
    shared.upload("import-drawing", plan)
    shared.item("drawing-use-beside").select_option("outline")  # besides the largest closed line
    shared.item("drawing-go").click()
    shared.item("drawing-problem").wait_for()
    assert "a closed line lies beside it" in shared.item("drawing-problem").inner_text()
    assert shared.get("studio.document.design") == before and shared.item("drawing-go").is_enabled()
    shared.item("drawing-use-beside").select_option("none")
    assert not shared.item("drawing-problem").is_visible()
    shared.page.keyboard.press("Escape")
    assert not shared.item("drawing-dialog").is_visible()


def test_a_drawing_is_a_way_to_begin(new_page: Callable[[], StudioPage], plan: Path) -> None:
    page = new_page()
    page.wait("studio.document || document.querySelector('[data-testid=new]')")
    if page.get("Boolean(studio.document)"):
        page.item("open").click()
    page.upload("new-drawing", plan)
    page.item("drawing-dialog").wait_for()
    assert not page.item("start").is_visible() and page.get("Boolean(studio.document)")
