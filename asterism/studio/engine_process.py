"""The process of an engine."""

from __future__ import annotations

import threading
import time
from multiprocessing.connection import Connection
from typing import Any

from asterism.pattern import gallery
from asterism.previews.default_law import paper_law
from asterism.previews.session import Preview
from asterism.process.compiling import clock_without_compiling, signs_while_compiling
from asterism.studio.engine import Engine
from asterism.studio.inbox import Inbox
from asterism.studio.messages import Busy, Ready
from asterism.studio.search_bounds import SIGN_EVERY_S

WARM_UP_DESIGN = "star"


def run_engine(connection: Connection) -> None:
    """The body of an engine's process: load everything, and serve until the pipe ends.

    Parameters
    ----------
    connection : this process's end of a pipe, with the messages of `asterism.studio.engine_orders` and
        `asterism.studio.messages`.
    """
    begun, lock = time.monotonic(), threading.Lock()

    def send(message: Any) -> None:
        with lock:
            connection.send(message)

    def compiling(text: str) -> None:
        send(Busy(0, text))

    inbox, law = Inbox(connection.recv), paper_law()
    with signs_while_compiling(compiling, SIGN_EVERY_S), clock_without_compiling() as clock:
        if not inbox.has_waiting:
            list(Preview(gallery.load(WARM_UP_DESIGN), law).edit(gallery.load(WARM_UP_DESIGN)))
        send(Ready(time.monotonic() - begun))
        Engine(inbox, send, clock).serve()
