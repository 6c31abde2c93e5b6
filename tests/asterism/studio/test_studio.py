"""Documents and pages of the studio: what a page sees of edits, undo, files and slots."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.pattern.layout.build import load_design
from asterism.studio.examples import MAX_FILES
from asterism.studio.file_names import shown_path
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import Page


def test_a_page_gets_document_state_and_shape(page: Page):
    document = page.until("document")
    assert document["name"] == "dome" and document["saved"] and not document["can_undo"]
    assert len(document["plan"]["sites"]) == 37
    assert page.until("mesh")["printed"].shape == (4, 2)
    assert page.until("shape")["stage"] == "equilibrium"


def test_a_gesture_is_one_step_of_undo(page: Page, studio: Studio):
    first = page.until("document")
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
