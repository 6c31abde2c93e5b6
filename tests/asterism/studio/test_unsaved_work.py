"""Unsaved work when disks are full, files vanish, and several studios work on one file."""

from __future__ import annotations

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from asterism.results.files import OutputError
from asterism.studio import autosave, design_file
from asterism.studio.autosave import autosaves
from asterism.studio.design_file import FileWatch
from asterism.studio.document import Document
from asterism.studio.examples import design_files
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import Page


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
    document = Document.open(folder / "dome.toml")
    words = ["nested too deeply", "is a pipe or a device", "is a pipe or a device", "symbolic links"]
    assert all(any(word in problem for problem in document.autosave.problems) for word in words)
    assert len(document.autosave.problems) == 4 and document.autosave.kept == []
    document.change({"name": "new"})
    document.keep_work()
    assert document.autosave.path == folder / ".dome.autosave-5.toml"
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
