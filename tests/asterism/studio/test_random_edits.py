"""The whole studio, with a real engine, under random edits: it answers each, and everything can be undone."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from starlette.testclient import TestClient

from asterism.pattern import gallery
from asterism.studio.page_data import SERVER_MISTAKE
from asterism.studio.server import application
from asterism.studio.studio import Studio
from tests.asterism.studio.conftest import HOST, LIVE, ORIGIN, TOKEN, Page

EDITS = int(os.environ.get("ASTERISM_RANDOM_EDITS", "120"))
# Seconds for one answer of the server, and for the engine to come to rest, on a machine with other work.
ANSWER_S = 3.0
REST_S = 60.0
# largest ratio of the memory after all gestures to that after half of them
MAX_GROWTH = 1.3
CHANGES: list[dict[str, Any]] = [
    {"border": {"rings": 2}},
    {"border": {"rectangle_mm": [90.0, 70.0]}},
    {"border": {"polygon_mm": [[0.0, 0.0], [9.0, 9.0], [9.0, 0.0], [0.0, 9.0]]}},
    {"pins": []},
    {"pins": [{"where": "border", "scale": 0.72}]},
    {"pins": [{"where": "border", "scale": 0.78}]},
    {"pins": [{"where": "corners", "scale": 0.8}]},
    {"pins": [{"points_mm": [[30, 0], [-30, 9], [0, -30]], "target_mm": [[24, 0, 9], [-24, 7, -5], [0, -24, 0]]}]},
    {"border": {"polygon_mm": [[-50, -40], [45, -40], [52, 30], [0, 44], [-50, 40]]}},
    {"fabric.stretch": 1.75},
    {"stars.length_mm": {"formula": "9 - abs(x)/15"}},
    {"stars.length_mm": {"formula": "9 - "}},
    {"stars.thickness_mm": 0.4},
    {"stars.thickness_mm": 40.0},
    {"stars.override": [{"star": 3, "length_mm": 6.0}]},
    {"stars": None},
    {"lattice.spacing_mm": 1e6},
    {"name": "another"},
    {"name": None},
]


def random_messages(random: np.random.Generator, gesture: int) -> list[dict[str, Any]]:
    """One gesture or command of a page."""
    sites = random.integers(-3, 4, size=(int(random.integers(1, 6)), 2)).tolist()
    match int(random.integers(10)):
        case 0 | 1 | 2 | 3:
            steps = int(random.integers(1, 5))
            lengths = [np.round(random.uniform(3.0, 11.5, len(sites)), 2).tolist() for _ in range(steps)]
            return [
                {"type": "sizes", "gesture": gesture, "end": k == steps - 1, "sites": sites, "length": sizes}
                for k, sizes in enumerate(lengths)
            ]
        case 4:
            kind = str(random.choice(["remove", "restore", "reset"]))
            return [{"type": kind, "gesture": gesture, "end": True, "sites": sites}]
        case 5 | 6:
            changes = CHANGES[int(random.integers(len(CHANGES)))]
            return [{"type": "edit", "gesture": gesture, "end": True, "changes": changes}]
        case 7:
            return [{"type": "undo"}]
        case 8:
            return [{"type": "redo"}]
        case _:
            command = str(random.choice(["flip", "form", "cancel", "stop"]))
            return [{"type": command, "index": int(random.integers(2))} if command == "form" else {"type": command}]


@pytest.mark.slow
def test_random_edits_are_answered_and_undone(tmp_path: Path):
    path = tmp_path / "dome.toml"
    original = gallery.path("dome").read_bytes()
    path.write_bytes(original)
    studio = Studio(tmp_path, path)
    random = np.random.default_rng(3)
    slowest = 0.0
    app = application(studio, TOKEN, frozenset({HOST}))
    with TestClient(app, base_url=f"http://{HOST}") as client, client.websocket_connect(LIVE, headers=ORIGIN) as socket:
        page = Page(socket)
        first = page.until("document")
        page.until("shape")
        memory_mb = []
        for gesture in range(1, EDITS + 1):
            if gesture in (EDITS // 2, EDITS):
                memory_mb.append(memory_of(studio))
            for message in random_messages(random, gesture):
                page.send(**message)
            begun = time.monotonic()
            page.send(type="printer", name="ultimaker2")  # answered by a document after all that came before
            page.until("document")
            slowest = max(slowest, time.monotonic() - begun)
            if random.random() < 0.2:
                at_rest(page)
        at_rest(page)
        assert studio.engine.link.status == "ready"
        for _ in range(studio.document.history.position + 1):  # type: ignore[union-attr]
            page.send(type="undo")
            page.until("document")
        page.send(type="history")
        page.until("history")  # documents that were sent for other reasons have been read
        page.send(type="printer", name="ultimaker2")
        assert not page.until("document")["can_undo"]
        page.send(type="keep", slot="B")
        last = page.until("state", engine="ready", summary_revision=first["revision"])
        page.send(type="save")
        page.until("saved")
    assert not [one for one in page.problems if one["kind"] == "error" or SERVER_MISTAKE in one["text"]]
    assert json.dumps(studio.document.table) == json.dumps(first["design"])  # type: ignore[union-attr]
    assert path.read_bytes() == original
    assert last["numbers"]["is_minimum"], last["problem"]
    print(
        f"{EDITS} gestures: slowest answer {slowest:.2f} s; server and engine {memory_mb} MB after half and all of them"
    )
    assert slowest < ANSWER_S
    assert (np.array(memory_mb[-1]) <= MAX_GROWTH * np.array(memory_mb[0])).all()


def memory_of(studio: Studio) -> list[float]:
    """Resident memory (MB) of the server and the engine; nothing where the system does not tell."""
    processes = (os.getpid(), studio.engine.link._child.process.pid)
    files = [Path(f"/proc/{process}/status") for process in processes]
    texts = [file.read_text() for file in files if file.exists()]
    return [round(int(text.split("VmRSS:")[1].split()[0]) / 1024) for text in texts]


def at_rest(page: Page) -> dict[str, Any]:
    """The state when the engine has nothing to do."""
    begun = time.monotonic()
    while time.monotonic() - begun < REST_S:
        page.send(type="history")
        page.until("history")  # whatever was sent before has been read
        page.send(type="keep", slot="B")
        if (state := page.until("state"))["engine"] == "ready":
            return state
        time.sleep(0.02)
    raise AssertionError("the engine does not come to rest")
