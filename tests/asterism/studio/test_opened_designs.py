"""Designs that do not follow from the shown one by an edit: the studio tells the engine so, with the form to go to."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.studio.engine_orders import Edit
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import Page


def last_edit(studio: Studio) -> Edit:
    edit: Edit = studio.engine.link.edits[-1]  # type: ignore[attr-defined]
    return edit


def test_only_gestures_go_on_from_the_shown_form(page: Page, studio: Studio, folder: Path) -> None:
    page.until("document")
    assert last_edit(studio).is_opened
    page.send(type="sizes", gesture=1, end=False, sites=[[0, 0]], length=[6.0])
    page.send(type="sizes", gesture=1, sites=[[0, 0]], length=[5.0])
    page.until("document", gesture=1)
    assert not any(edit.is_opened for edit in studio.engine.link.edits[1:])  # type: ignore[attr-defined]
    page.send(type="undo")
    page.until("document", can_undo=False)
    assert last_edit(studio).is_opened
    text = (folder / "dome.toml").read_text().replace("to = 4.0", "to = 5.0")
    (folder / "dome.toml").write_text(text)
    page.until("followed")
    page.until("document", can_undo=True)
    assert last_edit(studio).is_opened and last_edit(studio).snapshot is None
    page.send(type="open", gallery="cone")
    page.until("document", name="cone")
    assert last_edit(studio).is_opened and last_edit(studio).design["name"] == "cone"  # type: ignore[index]


def test_undo_and_kept_designs_go_back_to_their_form(page: Page, studio: Studio) -> None:
    page.until("document")
    studio.shown.snapshots[studio.document.revision] = b"form"  # type: ignore[union-attr]
    page.send(type="keep", slot="A")
    page.send(type="remove", sites=[[0, 0]], gesture=1)
    page.until("document", gesture=1)
    page.send(type="undo")
    page.until("document", can_undo=False)
    assert last_edit(studio).snapshot == b"form"
    page.send(type="open", gallery="cone")
    page.until("document", name="cone")
    page.send(type="show", slot="A")
    page.until("document", can_undo=True)
    assert last_edit(studio).snapshot == b"form" and last_edit(studio).is_opened


def test_a_shape_that_waits_is_not_sent_as_that_of_the_opened_design(
    page: Page, studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.until("shape")
    (tab,) = studio.tabs
    tab._in_flight = 99  # the page draws something that takes long
    tab.show(1, {"revision": 0}, {})
    monkeypatch.setattr(studio.engine.link, "ask", lambda message: None)
    page.send(type="open", gallery="cone")
    page.until("document", name="cone")
    assert tab._next() is None


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("to = 4.0", "to = -7.0", "stars.length_mm"),  # of stars, which the open design has too
        ("[stars", "[fabric]\nstretch = -1.0\n[stars", "fabric.stretch = -1.0"),
        ("rings = 3", "polygon_mm = [[0, 0], [100, 100], [100, 0], [0, 100]]", "border.polygon_mm"),  # at a place
        ("[stars", "[stars", ""),
    ],
)
def test_a_design_that_does_not_open_points_at_nothing_of_the_design_that_stays(
    page: Page, folder: Path, old: str, new: str, fault: str
) -> None:
    before = page.until("document")
    text = (folder / "dome.toml").read_text()
    assert old in text
    if fault:
        (folder / "other.toml").write_text(text.replace(old, new, 1))
    page.send(type="open", name="other.toml")
    problem = page.until("problem")
    assert problem["text"].startswith(f"other.toml: {fault}") and str(folder) not in problem["text"]
    assert (problem["field"], problem["stars"], problem["at_mm"]) == ("", [], None)
    page.send(type="hello")
    assert page.until("document")["path"] == before["path"]
