"""Drawings on the page: chosen or dropped, layer by layer, with a question for the unit, undo and refusals."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.asterism.studio.browser import StudioPage
from tests.asterism.studio.test_drawings import SVG
from tests.asterism.studio.test_uploads import dxf

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


def test_layers_of_a_drawing_become_rods_and_outline_and_are_undone(flat: StudioPage, plan: Path) -> None:
    flat.open("gallery-star")
    flat.page.keyboard.press("?")
    flat.page.get_by_text("Put a drawing on the sheet", exact=True).wait_for()
    flat.page.keyboard.press("Escape")
    before = flat.get("studio.document.design")
    flat.upload("import-drawing", plan)
    flat.item("drawing-dialog").wait_for()
    assert flat.item("drawing-use-cut").input_value() == "outline"  # by its name
    assert flat.item("drawing-use-ribs").input_value() == "rods"
    assert not flat.item("drawing-sheet").is_visible()  # the drawing has an outline
    flat.item("drawing-use-cut").select_option("none")
    assert flat.item("drawing-sheet").is_visible()
    flat.item("drawing-use-cut").select_option("outline")
    for layer in ("rim", "notes", "beside"):
        flat.item(f"drawing-use-{layer}").select_option("none")
    assert flat.item("drawing-strokes").is_checked() and not flat.item("drawing-width-ribs").is_visible()
    flat.item("drawing-strokes").click()
    flat.fill("drawing-width-ribs", 30)
    flat.page.get_by_text("From 0.1 mm to 10 mm").wait_for()
    flat.fill("drawing-width-ribs", 1.5)
    flat.fill("drawing-thickness-ribs", 0.5)
    flat.item("drawing-go").click()
    flat.wait("studio.document.design.rods && studio.shownRevision === studio.revision")
    assert flat.get("studio.document.design.rods.width_mm") == 1.5
    assert flat.get("studio.document.plan.holes_mm.length") == 1
    assert flat.item("stars").inner_text() == "4 rods" and not flat.item("drawing-dialog").is_visible()
    flat.page.get_by_role("button", name="Undo", exact=True).last.click()
    flat.wait("!studio.document.design.rods")
    assert flat.get("studio.document.design") == before


def test_a_dropped_drawing_without_a_unit_is_asked_for_it(flat: StudioPage) -> None:
    flat.open("gallery-star")

    def draw(space: Any) -> None:
        space.add_lwpolyline([(-2, 0), (2, 0), (3, 2)])
        space.add_text("a")

    flat.page.evaluate(DROP, ["ribs.dxf", dxf(draw, unit=0).decode()])
    flat.item("drawing-unit").select_option("cm")
    flat.item("drawing-unit-go").click()
    flat.item("drawing-dialog").wait_for()
    assert flat.item("drawing-size").inner_text() == "50.0 × 20.0 mm, 1 layer"
    flat.page.get_by_text("Left out: 1 text.").wait_for()
    flat.item("drawing-go").click()
    flat.wait("studio.document.design.rods?.import[0].file === 'ribs.dxf'")
    flat.page.get_by_text("ribs.dxf is on the sheet; left out: 1 text.").wait_for()
    assert flat.get("studio.document.plan.rods.length") == 2  # cut at the corner
    flat.page.evaluate(DROP, ["notes.txt", "none"])
    flat.page.get_by_text("notes.txt is no drawing").wait_for()
    flat.page.evaluate(DROP, ["empty.svg", "<svg xmlns='http://www.w3.org/2000/svg' width='9mm' height='9mm'/>"])
    flat.page.get_by_text("empty.svg: holds no line with a stroke").wait_for()
    assert "422" in flat.complaints.pop()  # the browser notes the refusal


def test_a_refused_drawing_says_why_in_its_dialog(flat: StudioPage, plan: Path) -> None:
    flat.open("gallery-star")
    before = flat.get("studio.document.design")
    flat.upload("import-drawing", plan)
    flat.item("drawing-use-beside").select_option("outline")  # besides the largest closed line
    flat.item("drawing-go").click()
    flat.item("drawing-problem").wait_for()
    assert "a closed line lies beside it" in flat.item("drawing-problem").inner_text()
    assert flat.get("studio.document.design") == before
    flat.item("drawing-go").click(trial=True)  # it can be pressed again
    flat.item("drawing-use-beside").select_option("none")
    assert not flat.item("drawing-problem").is_visible()
    flat.page.keyboard.press("Escape")
    assert not flat.item("drawing-dialog").is_visible()
