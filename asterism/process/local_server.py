"""A web server for this machine: who may ask, where it listens, and its end at Ctrl-C."""

from __future__ import annotations

import ipaddress
import signal
import socket
import threading
from collections.abc import Awaitable, Callable, Iterator, Mapping, MutableMapping
from contextlib import contextmanager
from types import FrameType
from typing import Any

import uvicorn
from starlette.responses import PlainTextResponse, Response

from asterism.equilibrium.errors import Error

LOOPBACK = "127.0.0.1"

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


class ListenError(Error, ValueError):
    """An address or a port that a server cannot use; the message is one line."""


class Guard:
    """Lets requests through that name this server as their host; subclasses refuse more.

    A stranger's page in the same browser can send requests to this machine. It cannot hide its origin, and a name of
    its own that it points to this machine arrives as the host.

    Parameters
    ----------
    hosts : values that the header Host may have, with the port.
    policy : content security policy of answers without one of their own.
    """

    def __init__(self, app: Any, hosts: frozenset[str], policy: str) -> None:
        self._app, self._hosts, self._policy = app, hosts, policy

    def refusal(self, scope: Scope, headers: Mapping[str, str]) -> int | None:
        """The status of a request that is refused; None if it is allowed."""
        return 403 if headers.get("host") not in self._hosts else None

    def refused(self, status: int) -> Response:
        """The answer to a request that is refused."""
        return PlainTextResponse("not allowed" if status == 403 else "not found", status)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        status = self.refusal(scope, headers)
        if status is None:
            await self._app(scope, receive, self._with_headers(scope, send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        else:
            await self.refused(status)(scope, receive, send)

    def _with_headers(self, scope: Scope, send: Send) -> Send:
        if scope["type"] != "http":
            return send

        async def send_with_headers(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                given = {name for name, _ in message["headers"]}
                message["headers"] += [
                    (name, value)
                    for name, value in (
                        (b"content-security-policy", self._policy.encode()),
                        (b"x-content-type-options", b"nosniff"),
                        (b"referrer-policy", b"no-referrer"),
                        (b"cross-origin-resource-policy", b"same-origin"),
                        (b"cache-control", b"no-store"),
                    )
                    if name not in given
                ]
            await send(message)

        return send_with_headers


class _Server(uvicorn.Server):
    """Ends on Ctrl-C without raising it again: that is how it ends."""

    def __init__(self, config: uvicorn.Config, stop: Callable[[], None] | None) -> None:
        super().__init__(config)
        self._stop = stop

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        if self._stop is not None:
            self._stop()
        super().handle_exit(sig, frame)

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


def serve(listening: socket.socket, app: Any, stop: Callable[[], None] | None = None, **options: Any) -> None:
    """Serve an application until Ctrl-C.

    Parameters
    ----------
    stop : called at Ctrl-C, before open connections have some seconds to end.
    options : of `uvicorn.Config`.
    """
    usual = {"log_level": "warning", "access_log": False, "lifespan": "on", "server_header": False}
    _Server(uvicorn.Config(app, **{**usual, "timeout_graceful_shutdown": 2, **options}), stop).run(sockets=[listening])


def host_names(listen: str, port: int) -> frozenset[str]:
    """The values of the header Host that name a server at an address and a port."""
    names = {listen, "localhost"} if listen == LOOPBACK else {listen}
    return frozenset(f"[{name}]:{port}" if ":" in name else f"{name}:{port}" for name in names)


@contextmanager
def bound(address: str, port: int) -> Iterator[socket.socket]:
    """A socket that listens at an address and a port; port 0 takes a free one.

    Raises ListenError: the address is not one of this machine, or the port is in use.
    """
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
