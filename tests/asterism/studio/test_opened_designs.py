"""Designs that do not follow from the shown one by an edit: the studio tells the engine so, with the form to go to."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from asterism.pattern import gallery
from asterism.studio import jobs
from asterism.studio.messages import Edit
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import Page, upload
from tests.asterism.studio.flat_frames import flat_frame
from tests.asterism.studio.quick_engines import GATE
from tests.asterism.studio.test_target import ROOF


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
    page.send(type="remove", sites=[[1, 0]], gesture=2)
    page.until("document", gesture=2)
    page.send(type="show", slot="A")
    page.until("document", position=2)
    page.send(type="history")
    words = [state["words"] for state in page.until("history")["states"]]
    assert words == ["Opened", "1 star removed", "Design A"]
    assert last_edit(studio).snapshot == b"form" and last_edit(studio).is_opened


@pytest.mark.slow
def test_what_a_page_asks_for_a_design_is_refused_when_another_one_is_open(
    client: TestClient, page: Page, studio: Studio, folder: Path
) -> None:
    other = folder / "star.toml"
    text = gallery.path("star").read_text(encoding="utf-8")
    other.write_text(text, encoding="utf-8")
    dome = page.until("document")
    page.send(type="save", name="star", seq=1, document=dome["number"])
    assert page.until("problem", seq=1)["kind"] == "file exists"
    page.send(type="open", gallery="cone", document=dome["number"])  # about no document: another tab may open one, too
    cone = page.until("document", name="cone")
    requests: list[dict[str, Any]] = [
        {"type": "save", "name": "star", "over": True},
        {"type": "sizes", "gesture": 1, "sites": [[0, 0]], "length": [5.0]},
        {"type": "show", "slot": "A"},
        {"type": "target", "do": "fit"},
        {"type": "recover"},
    ]
    for seq, request in enumerate(requests, 2):
        page.send(**request, seq=seq, document=dome["number"])
        assert "another design is open now" in page.until("problem", seq=seq)["text"]
    assert other.read_text(encoding="utf-8") == text
    assert studio.document is not None and studio.document.number == cone["number"] != dome["number"]
    assert not studio.document.history.can_undo
    answer = upload(client, f"target&document={dome['number']}", "roof.obj", ROOF.encode())
    assert "another design is open now" in answer.json()["problem"]["text"] and studio.parts.target is None
    page.send(type="save", name="star", over=True, document=cone["number"])
    page.until("saved")
    assert other.read_bytes() == gallery.path("cone").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("is_good", [True, False])
def test_a_verification_of_another_design_is_told_and_not_shown(
    is_good: bool, page: Page, studio: Studio, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(jobs.PROCESSES, "verify", "tests.asterism.studio.quick_engines:verify")
    monkeypatch.setenv(GATE, str(tmp_path / "gate"))
    page.until("shape")
    if not is_good:
        page.send(type="edit", gesture=1, changes={"name": "die"})
    page.send(type="verify")
    page.until("progress", stage="exact model")
    page.send(type="open", gallery="cone")
    page.until("document", name="cone")
    (tmp_path / "gate").touch()
    if is_good:
        assert page.until("note")["text"].startswith("The verification of dome is done")
    else:
        assert page.until("problem")["text"] == "dome: the verify ended unexpectedly"
    assert page.until("result", job="verify")["failed"]
    assert studio.badge()["kind"] != "exact"


def test_a_shape_that_waits_is_not_sent_as_that_of_the_opened_design(
    page: Page, studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    page.until("shape")
    (tab,) = studio.tabs
    tab._in_flight = 99  # the page draws something that takes long
    tab.show(flat_frame(1), 0)
    monkeypatch.setattr(studio.engine.link, "ask", lambda message: None)
    page.send(type="open", gallery="cone")
    page.until("document", name="cone")
    assert tab._shape is None


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
