"""Documents and pages: edits, undo, files and slots, designs that open, and the shapes that are kept for pages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from asterism.pattern import gallery
from asterism.pattern.layout.build import load_design
from asterism.studio import frames, jobs
from asterism.studio.examples import MAX_FILES
from asterism.studio.file_names import shown_path
from asterism.studio.messages import Edit, Form, ShapeSummary
from asterism.studio.pages import Shown, Tab
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import Page, upload
from tests.asterism.studio.flat_frames import SQUARE, flat_frame, flat_places, unpack
from tests.asterism.studio.quick_engines import GATE
from tests.asterism.studio.test_target import ROOF
from tests.event_loop import run_coroutine


def test_a_gesture_is_one_step_of_undo(page: Page, studio: Studio):
    first = page.until("document")
    assert first["name"] == "dome" and first["saved"] and not first["can_undo"] and len(first["plan"]["sites"]) == 37
    assert page.until("mesh")["printed"].shape == (4, 2) and page.until("shape")["stage"] == "equilibrium"
    for length in (7.0, 6.5, 6.0):
        page.send(type="sizes", gesture=1, end=length == 6.0, sites=[[0, 0], [1, 0]], length=[length, length])
    painted = page.until("document", gesture=1)
    sizes = {tuple(entry["site"]): entry["sizes_mm"][0] for entry in painted["plan"]["sites"]}
    assert sizes[0, 0] == sizes[1, 0] == 6.0 and not painted["saved"]
    page.send(type="undo")
    undone = page.until("document", revision=first["revision"])
    assert undone["design"] == first["design"] and undone["saved"] and undone["can_redo"]
    page.send(type="redo")
    assert page.until("document", revision=painted["revision"])["design"] == painted["design"]


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"fabric.stretch": -1}, "fabric.stretch"),
        ({"fabric.stretchy": 1.2}, "fabric.stretchy"),
        ({"border": {"polygon_mm": [[0, 0], [100, 100], [100, 0], [0, 100]]}}, "border.polygon_mm"),
        ({"pins": [{"points_mm": [[900, 0]]}]}, "pins[0].points_mm"),
        ({"": 1}, ""),
    ],
)
def test_a_refused_change_leaves_the_document_as_it_is(page: Page, changes: dict, field: str):
    before = page.until("document")
    page.send(type="edit", gesture=1, end=True, changes=changes)
    problem = page.until("problem")
    assert problem["field"].startswith(field) and problem["text"] and "\n" not in problem["text"]
    after = page.until("document")
    assert after["design"] == before["design"] and not after["can_undo"]


def test_a_sheet_that_cannot_be_laid_out_takes_the_whole_gesture_back(page: Page):
    before = page.until("document")
    page.send(type="edit", gesture=1, end=False, changes={"pins": [{"points_mm": [[10, 0]]}]})
    page.send(type="edit", gesture=1, end=True, changes={"pins": [{"points_mm": [[900, 0]]}]})
    page.until("problem")
    assert page.until("document")["design"] == before["design"]


def test_stars_given_by_number_and_place_can_be_painted(folder: Path):
    path = folder / "dome.toml"
    path.write_text(path.read_text() + "\n[[stars.override]]\nstar = 1\nlength_mm = 5.0\n")
    document = Studio(folder, path).document
    site = tuple(document.layout.sheet_sites[1].tolist())
    document.paint([site], {"thickness_mm": [0.4]}, None)
    assert document.table["stars"]["override"] == [{"site": list(site), "length_mm": 5.0, "thickness_mm": 0.4}]


def test_a_file_that_was_changed_on_the_disk_is_written_over_only_on_request(page: Page, folder: Path):
    file = folder / "dome.toml"
    page.until("document")
    page.send(type="remove", sites=[[0, 0]], gesture=1)
    page.until("document", can_undo=True)
    file.write_text("[stars]\nlength_mm = -1\n", encoding="utf-8")
    page.send(type="save", seq=7)
    refused = page.until("problem", seq=7)
    assert refused["kind"] == "file changed" and "has a mistake: border: is missing" in refused["text"]
    assert file.read_text(encoding="utf-8") == "[stars]\nlength_mm = -1\n"
    page.send(type="reread", seq=8)
    assert page.until("problem", seq=8)["field"] == "border"
    page.send(type="save", over=True)
    page.until("saved")
    assert len(load_design(file).stars.override) == 1


def test_the_last_star_stays_and_the_page_says_why(page: Page):
    before = page.until("document")
    page.send(type="remove", sites=[entry["site"] for entry in before["plan"]["sites"]], gesture=1)
    problem = page.until("problem")
    assert problem["kind"] == "no star" and problem["text"].startswith("A sheet needs at least one star")
    after = page.until("document")
    assert after["design"] == before["design"] and not after["can_undo"]


def test_paths_are_shown_from_the_home_folder_on(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("HOME", str(folder.parent))
    assert shown_path(folder / "dome.toml") == f"~/{folder.name}/dome.toml"
    monkeypatch.setenv("HOME", str(folder))
    assert shown_path(folder.parent / "dome.toml") == str(folder.parent / "dome.toml")


@pytest.mark.slow
def test_the_first_page_says_how_many_designs_of_a_full_folder_it_leaves_out(page: Page, folder: Path):
    text = (folder / "dome.toml").read_text(encoding="utf-8")
    for number in range(MAX_FILES + 1):
        (folder / f"dome-{number}.toml").write_text(text, encoding="utf-8")
    page.send(type="gallery")
    message = page.until("gallery")
    assert len(message["files"]) == MAX_FILES and message["files_left_out"] == 2
    (folder / "dome-0.toml").write_text("name = 'no design'", encoding="utf-8")
    page.send(type="gallery")
    assert page.until("gallery")["files_left_out"] == 1


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


def test_a_page_gets_a_mesh_before_the_first_shape_on_it_and_again_when_it_may_have_forgotten_it() -> None:
    sent: list[int] = []

    class Socket:
        async def send_bytes(self, frame: bytes) -> None:
            kind, header, _ = unpack(frame)
            number = numbers[header["mesh"]]
            sent.append(-number if kind == frames.MESH else number)

    async def draw(*which: int) -> None:
        for number in which:
            await tab._draw(Socket(), meshes[number - 1], 0)  # type: ignore[arg-type]

    tab, meshes = Tab(1), [flat_frame(1, printed=number * SQUARE) for number in range(1, 8)]
    numbers = {frame.mesh: number for number, frame in enumerate(meshes, 1)}
    run_coroutine(draw(1, 2, 1, *range(3, 8), 1, 2))
    assert sent == [-1, 1, -2, 2, 1, *(sign * number for number in range(3, 8) for sign in (-1, 1)), 1, -2, 2]


def test_a_kept_shape_is_complete_and_is_there_as_long_as_it_is_held() -> None:
    shown = Shown()
    assert shown.keep_shown() is None
    shown.add_frame(flat_frame(1, height=2.0, beside={"before": flat_places(3.0)}), 0, ())
    kept = shown.keep_shown()
    assert kept is not None and shown.kept[kept.number] is kept
    shown.add_frame(flat_frame(1, height=5.0), 1, ())
    _, header, arrays = unpack(kept.packed())
    assert header["stage"] == "equilibrium" and arrays["positions"][:, 2].tolist() == 4 * [2.0]
    assert {"printed", "triangles", "outline", "arm_site"} < arrays.keys() and "before" not in arrays
    del kept
    assert len(shown.kept) == 0


def test_a_form_has_its_shape_until_the_next_summary() -> None:
    shown = Shown()
    summary = ShapeSummary(1, {}, (), (Form(-1, "up", 0.0, True), Form(0, "down", 2.0, False)))
    shown.add_summary(summary, 0)
    shown.add_form(flat_frame(1, height=3.0, form=0))
    here, other = shown.state()["forms"]
    assert here["shape"] is None and shown.kept[other["shape"]].frame.stage == "equilibrium"
    shown.add_summary(summary, 1)
    assert [form["shape"] for form in shown.state()["forms"]] == [None, None]
