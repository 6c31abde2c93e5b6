"""Files of a page are read in a process of their own, whatever they hold."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from asterism.studio import uploads
from tests.asterism.studio.conftest import Page, upload


def read_for_ever(connection: Connection, kind: str, path: Path, name: str, units: str | None) -> None:
    (Path(os.environ["ASTERISM_TEST_GATE"]) / str(os.getpid())).touch()
    time.sleep(600)


def need_memory(connection: Connection, kind: str, path: Path, name: str, units: str | None) -> None:
    os._exit(9)


@pytest.mark.slow
def test_a_file_that_takes_too_long_is_left_and_its_process_ends(
    client: TestClient, page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "started").mkdir()
    monkeypatch.setenv("ASTERISM_TEST_GATE", str(tmp_path / "started"))
    monkeypatch.setattr(uploads, "_READER", f"{__name__}:read_for_ever")
    monkeypatch.setattr(uploads, "MAX_READ_S", 10.0)
    answer = upload(client, "drawing", "heavy.svg", b"<svg/>")
    assert answer.status_code == 422 and "heavy.svg: is not read after 10 s" in answer.json()["problem"]["text"]
    (started,) = (tmp_path / "started").iterdir()
    time.sleep(0.5)
    with suppress(ChildProcessError):  # it may have been waited for
        os.waitpid(int(started.name), os.WNOHANG)
    with pytest.raises(ProcessLookupError):
        os.kill(int(started.name), 0)


@pytest.mark.slow
def test_a_process_that_is_ended_for_its_memory_is_named(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(uploads, "_READER", f"{__name__}:need_memory")
    answer = upload(client, "drawing", "heavy.svg", b"<svg/>")
    assert answer.json()["problem"]["text"] == "heavy.svg: needs too much memory: simplify it"
