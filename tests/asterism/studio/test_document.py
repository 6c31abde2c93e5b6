"""The document of the studio: refused changes leave it, files keep what was not edited, and no work is lost."""

from __future__ import annotations

import json
import os
import sys
import tomllib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from asterism.equilibrium.errors import Error
from asterism.pattern import gallery
from asterism.pattern.design.files import read_table
from asterism.pattern.layout.build import load_design
from asterism.results.files import OutputError
from asterism.studio import autosave, design_file
from asterism.studio.autosave import autosaves
from asterism.studio.design_file import FileWatch, edited_text
from asterism.studio.document import Document
from asterism.studio.examples import design_files, free_name
from asterism.studio.history import step_words
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import Page


def test_a_refused_change_leaves_what_can_be_redone(folder: Path):
    document = Document.open(folder / "dome.toml")
    document.change({"name": "other"})
    document.undo()
    for changes in ({"fabric.stretch": -1}, {"pins": [{"points_mm": [[900.0, 0.0]]}]}):
        with pytest.raises(Error):
            document.change(changes)
            document.end_gesture()
    assert document.history.can_redo and not document.history.can_undo
    document.redo()
    assert document.table["name"] == "other"


@pytest.mark.parametrize("ends", ["\n", "\r\n"])
def test_a_file_keeps_its_comments_where_it_was_not_edited(tmp_path: Path, ends: str):
    path = tmp_path / "dome.toml"
    text = gallery.path("dome").read_text(encoding="utf-8").replace("rings = 3", "rings = 3 # three rings")
    path.write_bytes(text.replace("\n", ends).encode())
    document = Document.open(path)
    document.paint([(0, 0)], {"length_mm": [7.0]}, None)
    document.save()
    saved = path.read_bytes().decode()
    assert saved.startswith("# Figure 8, bottom left") and "rings = 3 # three rings" in saved
    assert read_table(path) == document.table
    document.undo()
    document.save()
    assert path.read_bytes() == text.replace("\n", ends).encode()


@pytest.mark.parametrize("name", gallery.names())
def test_the_text_of_an_edited_file_holds_the_edited_table(name: str):
    text = gallery.path(name).read_text(encoding="utf-8")
    table = read_table(gallery.path(name))
    assert edited_text(text, table) == text
    for changed in (
        {**table, "name": "other"},
        {**table, "border": {"rings": 2}},
        {key: value for key, value in table.items() if key != "pins"},
        {**table, "stars": {**table["stars"], "override": [{"site": [0, 0], "length_mm": 5.0}]}},
        {"stars": {"length_mm": 9.0, "thickness_mm": 0.3}, "border": {"rings": 1}},
    ):
        assert tomllib.loads(edited_text(text, changed)) == changed


@pytest.mark.parametrize(
    "text",
    [
        'name = """a\n[border]\n"""\n[stars]\nlength_mm = 9.0\n[border]\nrings = 1\n',
        "stars = { length_mm = 9.0 }\nborder = { rings = 1 }\n",
        "stars.length_mm = 9.0\nborder.rings = 1\n",
        '[stars]\nlength_mm = { formula = "9" } # [border]\n["border"]\nrings = 1\n',
        "[border]\nrings = 1\n[[stars.override]]\nstar = 0\nlength_mm = 5.0\n[stars]\nlength_mm = 9.0\n",
        "",
    ],
)
def test_unusual_texts_are_written_anew_rather_than_wrong(text: str):
    changed = {"stars": {"length_mm": 9.0}, "border": {"rings": 2}, "name": "a"}
    assert tomllib.loads(edited_text(text, changed)) == changed


def test_json_files_are_edited_autosaved_and_saved_under_another_name(tmp_path: Path):
    path = tmp_path / "dome.json"
    path.write_text(json.dumps(read_table(gallery.path("dome"))), encoding="utf-8")
    original = path.read_bytes()
    document = Document.open(path)
    document.paint([(0, 0)], {"length_mm": [7.0]}, None)
    document.keep_work()
    again = Document.open(path)
    assert [kept.table for kept in again.autosave.kept] == [document.table]
    document.save()
    assert load_design(path).stars.override[0].length_mm == 7.0
    document.undo()
    document.save()
    assert path.read_bytes() == original
    document.change({"name": "copy"})
    document.save(tmp_path / "copy.toml")
    assert document.path.name == "copy.toml" and document.is_saved
    assert load_design(tmp_path / "copy.toml").name == "copy" and path.read_bytes() == original


def test_a_sheet_that_was_never_saved_is_offered_and_keeps_its_name(tmp_path: Path):
    path = free_name(tmp_path, "dome")
    document = Document.copy_of(gallery.path("dome"), path)
    document.keep_work()
    assert list(tmp_path.iterdir()) == []
    document.change({"name": "drawn"})
    document.keep_work()
    assert design_files(tmp_path) == ["dome.toml"]
    assert free_name(tmp_path, "dome").name == "dome-2.toml"
    again = Document.unsaved(path)
    assert again.table["name"] == "drawn" and not again.is_saved and again.autosave.kept == []
    again.keep_work()
    assert autosaves(path)
    again.save()
    assert path.exists() and not autosaves(path)


@pytest.mark.parametrize("border", ["[border]\nrings = 1", "border.rings = 1", "border = {rings = 1}"])
@pytest.mark.parametrize("pattern", ["[stars]", "stars.length_mm = 8", "[rods]", "[[rods.line]]", "rods = {}"])
def test_designs_are_listed_in_all_ways_of_writing(tmp_path: Path, border: str, pattern: str) -> None:
    keys_first = sorted([border, pattern], key=lambda part: part.startswith("["))
    (tmp_path / "design.toml").write_text("\n".join(["name = 'a'", *keys_first]))
    (tmp_path / "law.toml").write_text("border_mm = 3\nbordering = 1\nstarsize = 2\n# border = {}\n")
    assert design_files(tmp_path) == ["design.toml"]


def edited(path: Path, name: str) -> Document:
    """A session that has changed the name of a design."""
    document = Document.open(path)
    document.change({"name": name})
    document.keep_work()
    return document


@pytest.mark.slow
def test_an_autosave_that_failed_is_tried_again(
    page: Page, studio: Studio, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*words: Any) -> None:
        raise OutputError("the disk is full")

    page.until("document")
    with monkeypatch.context() as patched:
        patched.setattr(autosave, "write_file", full)
        page.send(type="remove", sites=[[0, 0]], gesture=1)
        assert page.until("problem")["text"] == "the disk is full"
        while page.until("state")["unsaved_since"] is None:
            pass
    while page.until("state")["unsaved_since"] is not None:
        pass
    assert (folder / ".dome.autosave.toml").exists()


def test_work_that_is_kept_twice_at_once_has_one_file(folder: Path) -> None:
    document = edited(folder / "dome.toml", "first")
    document.autosave.drop()
    with ThreadPoolExecutor(8) as pool:
        for done in [pool.submit(document.keep_work) for _ in range(8)]:
            done.result()
    assert [file.name for file in autosaves(folder / "dome.toml")] == [".dome.autosave.toml"]


def test_each_session_keeps_its_own_work(folder: Path) -> None:
    first = edited(folder / "dome.toml", "first")
    second = edited(folder / "dome.toml", "second")
    first.change({"name": "first again"})
    first.keep_work()
    third = Document.open(folder / "dome.toml")
    assert sorted(kept.table["name"] for kept in third.autosave.kept) == ["first again", "second"]
    second.save()
    assert [file.name for file in autosaves(folder / "dome.toml")] == [".dome.autosave.toml"]
    # the work of a session that goes on is written again if another one drops it
    third.autosave.forget(None)
    third.change({"name": "third"})
    third.keep_work()
    first.keep_work()
    assert len(autosaves(folder / "dome.toml")) == 2


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
def test_what_cannot_be_read_in_place_of_a_file_is_named(folder: Path) -> None:
    (folder / ".dome.autosave.toml").write_text(".".join(3000 * "a") + " = 1")
    os.mkfifo(folder / ".dome.autosave-2.toml")
    (folder / ".dome.autosave-3.toml").symlink_to("/dev/zero")
    (folder / ".dome.autosave-4.toml").symlink_to(".dome.autosave-4.toml")
    os.mkfifo(folder / "pipe.toml")
    for number, content in enumerate((b"\xff\xfe", b"[stars", b"name = 3\n", b""), 5):
        (folder / f".dome.autosave-{number}.toml").write_bytes(content)
    document = Document.open(folder / "dome.toml")
    for number in range(2, 9):
        assert any(f".dome.autosave-{number}.toml" in problem for problem in document.autosave.problems)
    for words in ("nested too deeply", "is a pipe or a device", "symbolic links"):
        assert any(words in problem for problem in document.autosave.problems)
    assert len(document.autosave.problems) == 8 and document.autosave.kept == []
    document.change({"name": "new"})
    document.keep_work()
    assert document.autosave.path == folder / ".dome.autosave-9.toml"
    assert design_files(folder) == ["dome.toml"]


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="there are no devices")
def test_a_followed_file_that_becomes_a_device_is_not_read(folder: Path) -> None:
    watch = FileWatch(folder / "dome.toml")
    (folder / "dome.toml").unlink()
    (folder / "dome.toml").symlink_to("/dev/zero")
    assert watch.changed_text() is None
    (folder / "dome.toml").unlink()
    (folder / "dome.toml").write_text("#" * 10_000_001)
    assert watch.changed_text() is None


def test_a_deleted_file_is_not_saved(page: Page, folder: Path) -> None:
    assert page.until("document")["saved"]
    (folder / "dome.toml").unlink()
    assert "was deleted" in page.until("note")["text"]
    assert not page.until("document", has_file=False)["saved"]
    while not (folder / ".dome.autosave.toml").exists():
        page.send(type="hello")
        page.until("state")
    page.send(type="save")
    page.until("saved")
    assert (folder / "dome.toml").exists() and not (folder / ".dome.autosave.toml").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="permissions are others")
def test_a_read_only_file_is_written_only_on_request(page: Page, folder: Path) -> None:
    (folder / "dome.toml").chmod(0o444)
    text = (folder / "dome.toml").read_bytes()
    page.until("document")
    page.send(type="remove", sites=[[0, 0]], gesture=1)
    page.until("document", can_undo=True)
    page.send(type="save", seq=7)
    assert page.until("problem", seq=7)["kind"] == "file read-only" and (folder / "dome.toml").read_bytes() == text
    page.send(type="save", over=True)
    page.until("saved")
    assert (folder / "dome.toml").read_bytes() != text


@pytest.mark.skipif(sys.platform == "win32", reason="permissions are others")
def test_a_file_that_nobody_may_read_or_write_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(path: Path) -> str:
        raise PermissionError(path)

    file = tmp_path / "dome.toml"
    file.write_text('name = "dome"\n', encoding="utf-8")
    file.chmod(0)
    monkeypatch.setattr(design_file, "file_text", refused)  # the superuser may read all files
    with pytest.raises(design_file.KeptFileError, match=r"dome\.toml is read-only"):
        design_file.check_replaceable(file, None)


AT = [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]]
POINTS = [[0.0, 0.0], [30.0, 0.0]]
NEEDLES = [{"points_mm": POINTS, "target_mm": [[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]]}]
FABRIC = {"stretch": 1.4, "e_mpa": 2.0, "nu": 0.3, "thickness_mm": 0.6}


def plan(*sizes: tuple[float, float]) -> dict[str, Any]:
    return {"at_mm": AT, "sizes_mm": [[*size, 1.2] for size in sizes]}


@pytest.mark.parametrize(
    ("sizes", "words"),
    [
        ([(7.5, 0.3), (7.5, 0.3), (8.0, 0.3)], "Star length 6 → 7.5 mm, 2 stars"),
        ([(7.0, 0.3), (6.0, 0.3), (7.0, 0.4)], "Star length 6 to 8 → 7 mm, 2 stars; Star thickness "),
        ([(6.0, 0.3), (0.0, 0.3), (0.0, 0.3)], "2 stars removed"),
    ],
)
def test_sizes_of_stars_have_values_and_a_number(sizes: list[tuple[float, float]], words: str) -> None:
    plans = plan((6.0, 0.3), (6.0, 0.3), (8.0, 0.3)), plan(*sizes)
    assert step_words({}, {"stars": {"length_mm": 3.0}}, plans).startswith(words)


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (
            {"pins": NEEDLES},
            {"pins": [{**NEEDLES[0], "target_mm": [[0, 0, 0], [20, 0, 12.5]]}]},
            "Height 0 → 12.5 mm",
        ),
        ({"pins": NEEDLES}, {"pins": [{**NEEDLES[0], "target_mm": [[0, 0, 0], [22, 0, 0]]}]}, "1 needle moved"),
        ({"pins": NEEDLES}, {"pins": [{"points_mm": POINTS[:1], "target_mm": [[0, 0, 0]]}]}, "1 needle removed"),
        ({"pins": NEEDLES}, {"pins": [*NEEDLES, {"where": "border", "scale": 0.7}]}, "Supports"),
        ({"border": {"rings": 3}}, {"border": {"circle_mm": {}}}, "Outline circle; Outline rings 3 → none"),
        (  # what is too much is counted
            {"fabric": FABRIC},
            {"fabric": {key: 2 * value for key, value in FABRIC.items()}},
            "Fabric e 2 → 4 MPa; Fabric nu 0.3 → 0.6; Fabric stretch 1.4 → 2.8 and 1 more",
        ),
    ],
)
def test_needles_and_other_values_are_told(before: dict[str, Any], after: dict[str, Any], words: str) -> None:
    assert step_words(before, after, ()).startswith(words)
