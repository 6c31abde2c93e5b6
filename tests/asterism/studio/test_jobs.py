"""Jobs of the studio: progress, results, cancelling, and processes that end without one."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from asterism.studio import jobs
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import HOST, TOKEN, Page

ROOM = "tests.asterism.studio.quick_engines"


@pytest.fixture(autouse=True)
def quick_jobs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(jobs.PROCESSES, "verify", f"{ROOM}:verify")
    monkeypatch.setitem(jobs.PROCESSES, "export", f"{ROOM}:export")


def name_it(page: Page, name: str) -> None:
    page.until("document")
    page.send(type="edit", gesture=1, changes={"name": name})
    page.until("document", gesture=1)


@pytest.mark.slow
def test_a_verification_ends_with_the_exact_shape_and_numbers(page: Page, studio: Studio):
    name_it(page, "quick")
    page.send(type="verify")
    progress = page.until("progress", stage="exact model")
    assert (progress["job"], progress["done"], progress["of"]) == ("verify", 30, 100)
    result = page.until("result", job="verify")
    assert result["summary"] == {"rms_percent": None} and result["revision"] == 1
    assert page.until("shape", stage="exact")["positions"].shape == (3, 3)
    assert studio.jobs.data() == {} and studio.badge()["words"] == "Exact, mesh error 0.7 %"


@pytest.mark.slow
def test_one_job_runs_at_a_time_and_can_be_cancelled(page: Page, studio: Studio):
    name_it(page, "wait")
    page.send(type="verify")
    page.until("progress", stage="exact model")
    page.send(type="export", seq=7)
    assert "running job" in page.until("problem", seq=7)["text"]
    page.send(type="cancel")
    assert page.until("result")["cancelled"]
    assert page.until("state")["jobs"] == {}
    page.send(type="cancel")  # nothing to cancel: nothing happens
    page.send(type="export")
    assert page.until("result")["job"] == "export"


@pytest.mark.slow
def test_files_of_an_export_can_be_downloaded_if_they_are_below_the_folder(
    page: Page, client: TestClient, folder: Path
):
    (folder.parent / "outside.txt").write_text("secret", encoding="utf-8")
    page.until("document")
    page.send(type="export", printer="prusa-mk4", preview=False)
    result = page.until("result")
    assert result["files"] == [{"name": "dome-print/a.stl", "size": 5}]
    assert result["summary"]["printer"] == "prusa-mk4" and result["warnings"] == ["thin arms"]
    assert client.get(f"http://{HOST}/{TOKEN}/file/dome-print/a.stl").content == b"solid"


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows keeps files in use")
@pytest.mark.parametrize("how", ["cancel", "kill"])
def test_a_job_that_is_ended_leaves_no_hidden_folder(
    how: str, page: Page, studio: Studio, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(jobs.PROCESSES, "verify", f"{ROOM}:write_for_ever")
    page.until("document")
    page.send(type="verify")
    page.until("progress", stage="written")
    assert list(folder.rglob(".asterism-*/half.vtu"))
    if how == "cancel":
        page.send(type="cancel")
    else:
        os.kill(studio.jobs._running.child.process.pid, signal.SIGKILL)  # type: ignore[union-attr]
    assert page.until("result")["job"] == "verify"
    assert page.until("state")["jobs"] == {} and [file.name for file in folder.iterdir()] == ["dome.toml"]


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows has no fork")
def test_a_job_counts_as_ended_although_a_process_of_its_own_goes_on(
    page: Page, studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(jobs.PROCESSES, "verify", f"{ROOM}:leave_a_process")
    page.until("document")
    page.send(type="verify")
    assert "verify ended unexpectedly" in page.until("problem")["text"]
    assert page.until("result")["failed"]
