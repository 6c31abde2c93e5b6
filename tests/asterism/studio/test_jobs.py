"""Jobs of the studio: progress, results, cancelling, processes that end without one; a fit is one step of undo."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from asterism.studio import jobs
from asterism.studio.messages import FitTarget
from asterism.studio.page_data import SERVER_MISTAKE
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import HOST, TOKEN, Page
from tests.asterism.studio.quick_engines import GATE
from tests.asterism.studio.test_target import send_roof

pytestmark = pytest.mark.slow

ROOM = "tests.asterism.studio.quick_engines"


@pytest.fixture(autouse=True)
def quick_jobs(monkeypatch: pytest.MonkeyPatch) -> None:
    for job in ("verify", "export", "fit"):
        monkeypatch.setitem(jobs.PROCESSES, job, f"{ROOM}:{job}")


def name_it(page: Page, name: str) -> None:
    page.until("document")
    page.send(type="edit", gesture=1, changes={"name": name})
    page.until("document", gesture=1)


def test_a_verification_ends_with_the_exact_shape_and_numbers(page: Page, studio: Studio):
    name_it(page, "quick")
    page.send(type="verify")
    progress = page.until("progress", stage="exact model")
    assert (progress["job"], progress["done"], progress["of"]) == ("verify", 30, 100)
    result = page.until("result", job="verify")
    assert result["summary"] == {"rms_percent": None} and result["revision"] == 1
    assert page.until("shape", stage="exact")["positions"].shape == (3, 3)
    assert studio.jobs.data() == {} and studio.badge()["words"] == "Exact, mesh error 0.7 %"


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


def test_files_of_an_export_can_be_downloaded_if_below_the_folder(page: Page, client: TestClient, folder: Path):
    (folder.parent / "outside.txt").write_text("secret", encoding="utf-8")
    page.until("document")
    page.send(type="export", printer="prusa-mk4", preview=False)
    result = page.until("result")
    assert result["files"] == [{"name": "dome-print/a.stl", "size": 5}]
    assert result["summary"]["printer"] == "prusa-mk4" and result["warnings"] == ["thin arms"]
    assert client.get(f"http://{HOST}/{TOKEN}/file/dome-print/a.stl").content == b"solid"


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


@pytest.mark.skipif(os.name == "nt", reason="Windows has no fork")
def test_a_job_counts_as_ended_although_a_process_of_its_own_goes_on(
    page: Page, studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(jobs.PROCESSES, "verify", f"{ROOM}:leave_a_process")
    page.until("document")
    page.send(type="verify")
    assert "verify ended unexpectedly" in page.until("problem")["text"]
    assert page.until("result")["failed"]


@pytest.fixture
def gate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A fit ends when this file is there."""
    monkeypatch.setenv(GATE, str(tmp_path / "gate"))
    return tmp_path / "gate"


def shown(page: Page, studio: Studio) -> dict[str, Any]:
    """Wait for the first shape; the design of then."""
    page.until("shape")
    assert studio.document is not None
    return studio.document.table


def test_a_fitted_design_keeps_its_name_and_the_target_is_laid_on_a_free_sheet(
    client: TestClient, page: Page, studio: Studio
) -> None:
    name = shown(page, studio)["name"]
    send_roof(client)
    page.send(type="fit", hold="nothing")
    assert page.until("result", job="fit")["summary"] == {"needles": 0, "size_mm": 11.0}
    assert studio.document is not None and studio.document.table["name"] == name
    assert isinstance(studio.engine.link.edits[-1], FitTarget)  # type: ignore[attr-defined]


def test_a_target_that_is_moved_meanwhile_gets_the_pose_of_the_fit_unless_it_has_another_size(
    client: TestClient, page: Page, studio: Studio, gate: Path
) -> None:
    shown(page, studio)
    send_roof(client)
    for change in ({"do": "file"}, {"unit": "cm"}):
        gate.unlink(missing_ok=True)
        page.send(type="fit")
        page.until("progress")
        version = studio.parts.version
        page.send(type="target", **change)
        while page.until("state")["target"]["version"] == version:
            pass
        before = studio.parts.target
        gate.touch()
        page.until("result", job="fit")
        target = studio.parts.target
        assert before is not None and target is not None
        if "do" in change:
            assert target.is_fitted and target.shift.tolist() == [0.0, 0.0, 5.0]
        else:
            assert target.unit == "cm" and (target.rotation == before.rotation).all()


def test_a_fit_for_another_design_is_left_out(client: TestClient, page: Page, studio: Studio, gate: Path) -> None:
    shown(page, studio)
    send_roof(client)
    page.send(type="fit")
    page.until("progress")
    page.send(type="open", gallery="tube")
    page.until("document", name="tube")
    gate.touch()
    assert "another design was opened" in page.until("note")["text"]
    assert page.until("result", job="fit")["failed"]
    assert studio.document is not None and studio.document.table["border"] != {"rings": 1}


@pytest.mark.parametrize("error", [TypeError("of two\nlines"), OSError("of two\nlines")])
def test_whatever_goes_wrong_with_a_result_is_one_line_of_the_page(
    error: Exception, client: TestClient, page: Page, studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = shown(page, studio)
    send_roof(client)

    async def fails(snapshot: bytes | None = None) -> None:
        raise error

    monkeypatch.setattr(studio, "accept", fails)
    page.send(type="fit")
    text = page.until("problem", job="fit")["text"]
    assert text == "of two lines" or text == f"{SERVER_MISTAKE}: TypeError"
    assert page.until("result", job="fit")["failed"]
    assert studio.document is not None and studio.document.table == before


def test_a_fit_can_be_cancelled_and_may_have_no_answer(client: TestClient, page: Page, studio: Studio) -> None:
    before = shown(page, studio)
    page.send(type="fit", seq=3)
    assert "send a file first" in page.until("problem", seq=3)["text"]
    page.send(type="fit", hold="glue")
    assert "hold" in page.until("problem")["text"]
    send_roof(client, "wait.obj")
    page.send(type="fit")
    page.until("progress", job="fit")
    page.send(type="cancel")
    assert page.until("result", job="fit")["cancelled"]
    send_roof(client, "wide.obj")
    page.send(type="fit")
    assert page.until("problem", job="fit")["text"] == "wide: is out of reach"
    assert page.until("result", job="fit")["failed"]
    assert studio.document is not None and studio.document.table == before
