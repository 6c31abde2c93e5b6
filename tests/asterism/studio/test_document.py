"""The document of the studio: refused changes leave it as it is, and files keep what was not edited."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

from asterism.equilibrium.errors import Error
from asterism.pattern import gallery
from asterism.pattern.design.files import read_table
from asterism.pattern.layout.build import load_design
from asterism.studio.autosave import autosaves
from asterism.studio.design_file import edited_text
from asterism.studio.document import Document
from asterism.studio.examples import design_files, free_name


def test_a_refused_change_leaves_what_can_be_redone(tmp_path: Path):
    path = tmp_path / "dome.toml"
    path.write_bytes(gallery.path("dome").read_bytes())
    document = Document.open(path)
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


def test_an_autosave_that_cannot_be_read_is_not_offered(tmp_path: Path):
    path = tmp_path / "dome.toml"
    path.write_bytes(gallery.path("dome").read_bytes())
    for text in (b"\xff\xfe", b"[stars", b"name = 3\n", b""):
        (tmp_path / ".dome.autosave.toml").write_bytes(text)
        autosave = Document.open(path).autosave
        assert autosave.kept == [] and ".dome.autosave.toml" in autosave.problems[0]
