"""A studio with an engine that answers at once, for tests of everything but the computation."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio
import numpy as np
import pytest
from starlette.testclient import TestClient

from asterism.pattern import gallery
from asterism.studio import frames
from asterism.studio.messages import Edit, Limits, ShapeSummary
from asterism.studio.server import application
from asterism.studio.studio import Studio
from tests.asterism.studio.flat_frames import flat_frame, unpack

if TYPE_CHECKING:
    from tests.asterism.studio.engine_pipe import EnginePipe

HOST = "127.0.0.1:7000"
TOKEN = "a-token-of-the-tests"
LIVE, ORIGIN = f"ws://{HOST}/{TOKEN}/live", {"origin": f"http://{HOST}"}
# Seconds after which a message that does not come fails the test.
PATIENCE_S = 300.0


class QuickEngine:
    """Stands for the link to the engine: every edit is answered with a flat square, as high as its number."""

    def __init__(self, receive: Callable[[Any], None], changed: Callable[[], None]) -> None:
        self.receive, self.status, self.searching = receive, "ready", None
        self.edits: list[Any] = []

    def edit(self, edit: Edit) -> None:
        self.ask(edit)

    def ask(self, message: Any) -> None:
        self.edits.append(message)
        seq = message.seq
        self.receive(flat_frame(seq, height=float(seq)))
        self.receive(ShapeSummary(seq, {"expected_rms_percent": 0.5, "height_mm": float(seq)}))
        if seq == 1:
            self.receive(Limits(seq, {"length_mm": (3.0, 11.0)}, (1.35, 1.75)))

    def request_parts(self, parts: Any) -> None:
        self.edits.append(parts)

    def stop(self) -> None: ...
    def watch(self) -> None: ...
    def close(self) -> None: ...


class Page:
    """A page as the server sees it; `problems` are all that came before the messages it waited for."""

    def __init__(self, socket: Any) -> None:
        self._socket = socket
        self.problems: list[dict[str, Any]] = []
        self.send(type="hello")

    def send(self, **message: Any) -> None:
        self._socket.send_text(json.dumps(message))

    def send_text(self, text: str) -> None:
        self._socket.send_text(text)

    async def _receive(self) -> Any:
        with anyio.fail_after(PATIENCE_S):
            return await self._socket._send_rx.receive()

    def until(self, kind: str, **values: Any) -> dict[str, Any]:
        """The next message of a type that has these values; frames on the way are acknowledged."""
        for _ in range(500):
            message = self._socket.portal.call(self._receive)
            assert message["type"] != "websocket.close", message
            if message.get("bytes"):
                frame_kind, header, arrays = unpack(message["bytes"])
                if frame_kind != frames.MESH:
                    assert all(np.isfinite(array).all() for array in arrays.values())
                    self.send(type="ack", frame=header["frame"])
                data = {"type": {1: "mesh", 2: "shape", 3: "comparison"}[frame_kind], **header, **arrays}
            else:
                data = json.loads(message["text"])
            if data["type"] == "problem":
                self.problems.append(data)
            if data["type"] == kind and all(data[key] == value for key, value in values.items()):
                return data
        raise AssertionError(f"no message {kind} with {values}")


def upload(client: TestClient, kind: str, name: str, content: bytes) -> Any:
    """The answer to a file of a page."""
    return client.post(f"/{TOKEN}/upload?kind={kind}", content=content, headers={**ORIGIN, "x-name": name})


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    text = gallery.path("dome").read_text(encoding="utf-8")
    (tmp_path / "dome.toml").write_text(text, encoding="utf-8")
    return tmp_path


@pytest.fixture
def studio(folder: Path) -> Studio:
    return Studio(folder, folder / "dome.toml", QuickEngine)  # type: ignore[arg-type]


@pytest.fixture
def client(studio: Studio) -> Iterator[TestClient]:
    with TestClient(application(studio, TOKEN, frozenset({HOST})), base_url=f"http://{HOST}") as client:
        yield client


@pytest.fixture
def page(client: TestClient) -> Iterator[Page]:
    with client.websocket_connect(LIVE, headers=ORIGIN) as socket:
        yield Page(socket)


@pytest.fixture
def engine() -> Iterator[EnginePipe]:
    from tests.asterism.studio.engine_pipe import EnginePipe  # the solvers take most of a second

    pipe = EnginePipe()
    yield pipe
    pipe.close()
