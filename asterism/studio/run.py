"""Runs the studio until Ctrl-C."""

from __future__ import annotations

import ipaddress
import secrets
import signal
import socket
import threading
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import uvicorn

from asterism.equilibrium.errors import Error
from asterism.studio.child import StartedProcess
from asterism.studio.engine_link import EngineLink
from asterism.studio.requests import MAX_REQUEST_BYTES
from asterism.studio.server import application
from asterism.studio.studio import Studio

LOOPBACK = "127.0.0.1"
# Seconds that open connections have to end after Ctrl-C.
SHUTDOWN_GRACE_S = 2


class ListenError(Error, ValueError):
    """An address or a port that the studio cannot use; the message is one line."""


class _Server(uvicorn.Server):
    """Ends on Ctrl-C without raising it again: that is how a studio ends."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {number: signal.signal(number, self.handle_exit) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def run_studio(
    path: Path | None,
    *,
    port: int = 0,
    listen: str = LOOPBACK,
    opens_browser: bool = True,
    say: Callable[[str], None] = print,
    engine: StartedProcess | None = None,
) -> None:
    """Serve the studio, and return when it has been stopped.

    Parameters
    ----------
    path : a design file; None shows the gallery.
    port : 0 takes a free one.
    listen : address of this machine that the page is reached at.
    opens_browser : open the page in the default browser.
    engine : the first engine's process, if it has been started already.
    say : called with the page's address, and at the end with the place of unsaved work.

    Raises
    ------
    DesignError
        The design file cannot be used.
    ListenError
        The address is not one of this machine, or the port is in use.
    """
    folder = Path.cwd() if path is None else path.absolute().parent
    studio = Studio(folder, path, partial(EngineLink, first=engine))
    token = secrets.token_urlsafe(24)
    with _bound(listen, port) as listening:
        port = listening.getsockname()[1]
        names = {listen, "localhost", LOOPBACK} if listen == LOOPBACK else {listen}
        hosts = frozenset(f"[{name}]:{port}" if ":" in name else f"{name}:{port}" for name in names)
        server = _Server(
            uvicorn.Config(
                application(studio, token, hosts),
                log_level="warning",
                access_log=False,
                ws="websockets-sansio",
                ws_max_size=MAX_REQUEST_BYTES,
                ws_per_message_deflate=False,
                timeout_graceful_shutdown=SHUTDOWN_GRACE_S,
                lifespan="on",
                server_header=False,
            )
        )
        host = f"[{listen}]" if ":" in listen else listen
        url = f"http://{host}:{port}/{token}/"
        say(f"studio: {url}")
        say("Ctrl-C ends it")
        if opens_browser:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
        server.run(sockets=[listening])
    for file in studio.unsaved_work():
        say(f"unsaved work is kept in {file}")


@contextmanager
def _bound(address: str, port: int) -> Iterator[socket.socket]:
    """A socket that listens at an address and a port."""
    try:
        given = ipaddress.ip_address(address)
    except ValueError:
        raise ListenError(f"--listen: {address!r} must be an address as {LOOPBACK}") from None
    if given.is_unspecified:
        raise ListenError(f"--listen: {address} means all addresses; name the one that the page is reached at")
    family = socket.AF_INET6 if given.version == 6 else socket.AF_INET
    with socket.socket(family, socket.SOCK_STREAM) as listening:
        try:
            listening.bind((address, port))
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise ListenError(f"cannot listen at {address}, port {port}: {reason}") from None
        listening.listen()
        yield listening
