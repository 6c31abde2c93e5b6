"""Bodies of processes that compute nothing: the table of a design says how they fail."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import asdict, replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from asterism.results.files import staged
from asterism.studio.messages import (
    Edit,
    Fitted,
    JobProgress,
    Ready,
    Settled,
    ShapeSummary,
    Sign,
    StudioProblem,
    Surface,
    Written,
)
from tests.asterism.studio.flat_frames import SQUARE, flat_frame

# variable of the environment with the file that a fit, or a verification, waits for
GATE = "ASTERISM_TEST_GATE"


def serve(connection: Connection) -> None:
    """Answer each edit with a flat square; `die`, `die_once`, `hang_once` and `loop_once` in its table are done first.

    The snapshot is that of the edit and its number.
    """
    connection.send(Ready())
    while True:
        message = connection.recv()
        if not isinstance(message, Edit):
            continue
        table = message.design
        if table.get("die"):
            os._exit(3)
        for failure in ("die_once", "hang_once", "loop_once"):
            mark = Path(table.get(failure, "/"))
            if mark.is_file():
                mark.unlink()
                if failure == "die_once":
                    os._exit(3)
                if failure == "loop_once":
                    connection.send(Sign(is_stuck=True))
                time.sleep(60)
        connection.send(flat_frame(message.seq, snapshot=(message.snapshot or b"") + b"%d" % message.seq))


def wait_for_gate() -> None:
    """Wait until the file of `GATE` is there, if the test names one."""
    while (gate := os.environ.get(GATE)) and not Path(gate).exists():
        time.sleep(0.01)


def verify(connection: Connection, job: int, table: dict[str, Any], folder: str, out: str, pose: Any) -> None:
    """A verification that waits for its end, unless the design's name says otherwise."""
    connection.send(JobProgress(job, "exact model", 30, 100, 0.1))
    if table["name"] == "wait":
        time.sleep(600)
    wait_for_gate()
    if table["name"] == "die":
        os._exit(3)
    connection.send(replace(exact(job), summary={"rms_percent": float("nan")}))


def exact(job: int, is_minimum: bool = True) -> Settled:
    """A flat triangle as an exact shape."""
    frame = flat_frame(0, "exact", printed=SQUARE[:3], is_minimum=is_minimum)
    return Settled(job, frame, ShapeSummary(0, {"mesh_error_percent": 0.7, "is_minimum": is_minimum}), b"exact")


def fit(connection: Connection, job: int, target: Surface, name: str, hold: str, printer: str, weights: Any) -> None:
    """A fit that gives a sheet of one ring as soon as the file of `GATE` is there.

    The targets `wait.obj` and `wide.obj` have none.
    """
    connection.send(JobProgress(job, "step 1, each star: 0.40 % of the diameter", 0, 0, 0.1))
    if name == "wait.obj":
        time.sleep(600)
    wait_for_gate()
    if name == "wide.obj":
        connection.send(StudioProblem(job, "error", "wide: is out of reach"))
        return
    table: dict[str, Any] = {"name": name, "border": {"rings": 1}, "stars": {"length_mm": 6.0}}
    if hold != "nothing":
        table["pins"] = [{"corners": [0, 1, 2, 3, 4, 5]}]
    if weights is not None:
        table["fit"] = {"weights": [{"site": [0, 0], "weight": float(weights.weight.max())}]}
    summary = {"needles": 0 if hold == "nothing" else 6, "size_mm": float(np.ptp(target.vertices[:, 0]))}
    connection.send(Fitted(job, summary, table, np.diag([1.0, -1.0, -1.0]), np.array([0.0, 0.0, 5.0])))


def export(connection: Connection, job: int, table: Any, folder: str, out: str, settings: Any, shape: Any) -> None:
    """An export of two files, one of which is elsewhere."""
    place = Path(out)
    place.mkdir()
    (place / "a.stl").write_bytes(b"solid")
    connection.send(Written(job, asdict(settings), out, ("a.stl", "../../outside.txt", "missing.stl"), ("thin arms",)))


def write_for_ever(connection: Connection, job: int, table: dict[str, Any], folder: str, out: str, pose: Any) -> None:
    """A verification that is ended while it writes."""
    with staged(out) as unfinished:
        (unfinished / "half.vtu").write_text("half")
        connection.send(JobProgress(job, "written", 0, 0, 0.1))
        time.sleep(600)


def leave_a_process(connection: Connection, job: int, table: dict[str, Any], folder: str, out: str, pose: Any) -> None:
    """A verification that is killed while another process of its own holds its pipe."""
    if os.fork() == 0:
        time.sleep(20)
        os._exit(0)
    os.kill(os.getpid(), signal.SIGKILL)
