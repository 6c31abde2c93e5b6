"""Files that a page sends, such as outlines; they are read in a process of their own, whatever they hold."""

from __future__ import annotations

import os
import time
from contextlib import suppress
from io import StringIO
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest
from starlette.testclient import TestClient

from asterism.studio import uploads
from tests.asterism.studio.conftest import Page, upload

SQUARE = [(10.0, 20.0), (110.0, 20.0), (110.0, 80.0), (10.0, 80.0)]
CENTRED = {(-50.0, -30.0), (50.0, -30.0), (50.0, 30.0), (-50.0, 30.0)}


def dxf(draw: Any, unit: int = 4) -> bytes:
    drawing = ezdxf.new(units=unit)
    draw(drawing.modelspace())
    out = StringIO()
    drawing.write(out)
    return out.getvalue().encode()


def rectangle(space: Any) -> None:
    space.add_lwpolyline(SQUARE, close=True)
    space.add_circle((60, 50), 5)


def lines_that_cross(space: Any) -> None:
    for y in (20, 80):
        space.add_line((0, y), (120, y))
    for x in (10, 110):
        space.add_line((x, 0), (x, 100))


@pytest.mark.slow
def test_an_outline_in_svg_or_dxf_is_centred(client: TestClient):
    svg = b'<svg xmlns="http://www.w3.org/2000/svg" width="200mm" height="200mm" viewBox="0 0 200 200">'
    svg += b'<rect x="10" y="20" width="100" height="60"/></svg>'
    for name, content in (("a.dxf", dxf(rectangle)), ("a.dxf", dxf(lines_that_cross)), ("a.svg", svg)):
        corners = upload(client, "outline", name, content).json()["border"]["polygon_mm"]
        assert {tuple(corner) for corner in corners} == CENTRED
    content = dxf(lambda space: space.add_circle((1, 1), 2), unit=1)  # inches
    corners = np.array(upload(client, "outline", "a.dxf", content).json()["border"]["polygon_mm"])
    np.testing.assert_allclose(np.hypot(*corners.T), 50.8, atol=0.05)
    assert 20 < len(corners) < 200


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
