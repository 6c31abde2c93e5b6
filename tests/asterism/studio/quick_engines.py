"""Bodies of engine processes that compute nothing: the table of an edit says how they fail."""

from __future__ import annotations

import os
import time
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np

from asterism.studio.messages import Edit, Frame, Ready, ShownMesh


def serve(connection: Connection) -> None:
    """Answer each edit with a flat square; `die`, `die_once` and `hang_once` in its table are done first."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    connection.send(Ready(0.0))
    while True:
        message = connection.recv()
        if not isinstance(message, Edit):
            continue
        table = message.design or {}
        if table.get("die"):
            os._exit(3)
        for failure in ("die_once", "hang_once"):
            mark = Path(table.get(failure, "/"))
            if mark.is_file():
                mark.unlink()
                if failure == "die_once":
                    os._exit(3)
                time.sleep(60)
        none = np.zeros((0, 2, 2, 3))
        connection.send(ShownMesh(1, square, np.array([[0, 1, 2], [0, 2, 3]]), np.arange(4), none[:, 0, 0, 0]))
        positions = np.column_stack([square, np.zeros(4)])
        normals = np.tile([0.0, 0.0, 1.0], (4, 1))
        args = (positions, normals, np.zeros(4), np.zeros(4), none, none[:, 0], none[:, 0])
        connection.send(Frame(message.seq, 1, "equilibrium", *args))
