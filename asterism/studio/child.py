"""A process of the studio that computes, and the pipe to it."""

from __future__ import annotations

import asyncio
import gc
import multiprocessing
import os
import queue
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any, Self

_END = object()  # the last in an outbox
# The body of an engine's process.
ENGINE = "asterism.studio.engine:run_engine"


def run_child(target: str, niceness: int, connection: Connection, *arguments: Any) -> None:
    """The body of every child: Ctrl-C and hang-up are for the server, which ends its children.

    What the modules hold stays until the end. The search for garbage leaves it out: it would take a seventh of the
    start, and would later stop the engine for some 50 ms now and then.
    """
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    if niceness and hasattr(os, "nice"):
        os.nice(niceness)
    with suppress(EOFError, OSError, BrokenPipeError):
        module, name = target.split(":")
        gc.disable()
        body = getattr(import_module(module), name)
        gc.freeze()
        gc.enable()
        body(connection, *arguments)


class Child:
    """A process of the studio that computes, and this side's end of the pipe to it.

    The event loop talks to it from `listen` on. Sending never blocks the caller: a thread writes and another one reads.

    Parameters
    ----------
    target : `module:function`, called in the new process with its end of the pipe, and `arguments`. The server itself
        does not import it: the solvers take most of a second.
    niceness : lowers the priority, where the system can do that.
    """

    def __init__(self, target: str, arguments: tuple[Any, ...] = (), niceness: int = 0) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(
            target=run_child, args=(target, niceness, theirs, *arguments), daemon=True, name=target
        )
        self.process.start()
        theirs.close()
        self._outbox: queue.SimpleQueue[Any] = queue.SimpleQueue()

    def listen(self, receive: Callable[[Child, Any], None], ended: Callable[[Child], None]) -> Self:
        """Begin to send and to receive.

        Parameters
        ----------
        receive : called in the event loop with this child and each message.
        ended : called in the event loop with this child when the process has ended or closed the pipe.
        """
        self._receive, self._ended = receive, ended
        self._loop = asyncio.get_running_loop()
        self.last_sign = time.monotonic()
        for work in (self._read, self._write):
            threading.Thread(target=work, daemon=True).start()
        return self

    def send(self, message: Any) -> None:
        """Send a message, which may be None; does nothing if the process has ended."""
        self._outbox.put(message)

    def kill(self) -> None:
        """End the process at once. Its `ended` is not called."""
        self._ended = lambda child: None
        self._receive = lambda child, message: None
        self._outbox.put(_END)
        self.process.kill()

    def close(self) -> None:
        """End the process and wait for it."""
        self.kill()
        self.process.join(0.5)

    def _read(self) -> None:
        with suppress(EOFError, OSError):
            while True:
                # a process that has ended counts as such also if one of its own keeps the pipe open
                while not self.connection.poll(0.5):
                    if not self.process.is_alive() and not self.connection.poll():
                        raise EOFError
                message = self.connection.recv()
                self.last_sign = time.monotonic()
                self._in_loop(lambda message=message: self._receive(self, message))  # type: ignore[misc]
        self._in_loop(lambda: self._ended(self))

    def _write(self) -> None:
        with suppress(EOFError, OSError):
            while (message := self._outbox.get()) is not _END:
                self.connection.send(message)

    def _in_loop(self, call: Callable[[], None]) -> None:
        with suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(call)
