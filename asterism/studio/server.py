"""The web server of the studio: pages, files, uploads and the live connection, for this machine only, until Ctrl-C."""

from __future__ import annotations

import asyncio
import hmac
import ipaddress
import mimetypes
import secrets
import signal
import socket
import tempfile
import threading
import webbrowser
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, MutableMapping
from contextlib import asynccontextmanager, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from asterism.equilibrium.errors import Error
from asterism.pattern.drawing.records import MM_OF_UNITS, NoUnitError
from asterism.studio.child import StartedProcess
from asterism.studio.drawing import read_drawing
from asterism.studio.engine_link import EngineLink
from asterism.studio.examples import PICTURES
from asterism.studio.file_names import MAX_NAME_CHARACTERS, FileNameError, file_below
from asterism.studio.page_data import failure_data
from asterism.studio.requests import MAX_REQUEST_BYTES
from asterism.studio.studio import Studio
from asterism.studio.tab import MAX_TABS, Tab
from asterism.studio.target import read_target
from asterism.studio.uploads import MAX_UPLOAD_BYTES, UploadKind, read_upload

LOOPBACK = "127.0.0.1"


PAGE = Path(__file__).parent / "page"
# Windows may have other types for these in its registry, and a module of another type is not run.
for _suffix, _type in ((".js", "text/javascript"), (".css", "text/css"), (".svg", "image/svg+xml")):
    mimetypes.add_type(_type, _suffix)

PAGE_POLICY = (
    "default-src 'self'; img-src 'self' blob: data:; object-src 'none'; base-uri 'none'; frame-ancestors 'none'"
)
# Reports are complete in themselves; they may style themselves and show the pictures in them, and nothing else.
FILE_POLICY = "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:"
TRY_AGAIN_LATER = 1013

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


class Guard:
    """Lets through what comes from a page of this server, and nothing else.

    A stranger's page in the same browser can send requests to this machine. It does not know the token, it cannot hide
    its origin, and a name of its own that it points to this machine arrives as the host.

    Parameters
    ----------
    hosts : values that the header Host may have, with the port.
    """

    def __init__(self, app: Any, token: str, hosts: frozenset[str]) -> None:
        self._app, self._token, self._hosts = app, token.encode(), hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        status = self._refusal(scope)
        if status is None:
            await self._app(scope, receive, self._with_headers(scope, send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008})
        else:
            await PlainTextResponse("not allowed" if status == 403 else "not found", status)(scope, receive, send)

    def _refusal(self, scope: Scope) -> int | None:
        """The status of a request that is refused; None if it is allowed."""
        headers = {name.decode("latin-1"): value.decode("latin-1") for name, value in scope["headers"]}
        if headers.get("host") not in self._hosts:
            return 403
        origin = headers.get("origin")
        needs_origin = scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD")
        if (origin is not None or needs_origin) and origin not in {f"http://{host}" for host in self._hosts}:
            return 403
        token = scope["path"].split("/")[1] if scope["path"].startswith("/") else ""
        return None if hmac.compare_digest(token.encode(), self._token) else 404

    @staticmethod
    def _with_headers(scope: Scope, send: Send) -> Send:
        if scope["type"] != "http":
            return send

        async def send_with_headers(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                given = {name for name, _ in message["headers"]}
                message["headers"] += [
                    (name, value)
                    for name, value in (
                        (b"content-security-policy", PAGE_POLICY.encode()),
                        (b"x-content-type-options", b"nosniff"),
                        (b"referrer-policy", b"no-referrer"),
                        (b"cross-origin-resource-policy", b"same-origin"),
                        (b"cache-control", b"no-store"),
                    )
                    if name not in given
                ]
            await send(message)

        return send_with_headers


def _plain_name(name: str) -> str:
    """The last part of a file's name, printable and short."""
    last = name.replace("\\", "/").split("/")[-1]
    return "".join(c for c in last if c.isprintable())[-MAX_NAME_CHARACTERS:]


def application(studio: Studio, token: str, hosts: frozenset[str]) -> Guard:
    """The web application of a studio; `Guard` stands before it."""

    async def index(request: Request) -> Response:
        return FileResponse(PAGE / "index.html")

    async def file(request: Request) -> Response:
        path = file_below(studio.folder, request.path_params["name"])
        if not path.is_file():
            return PlainTextResponse("not found", 404)
        shown = path.suffix in (".html", ".pdf", ".png")
        return FileResponse(
            path,
            filename=path.name,
            content_disposition_type="inline" if shown else "attachment",
            headers={"content-security-policy": FILE_POLICY},
        )

    async def upload(request: Request) -> Response:
        try:
            kind = UploadKind(request.query_params.get("kind", ""))
        except ValueError:
            return PlainTextResponse("not found", 404)
        size = 0
        with tempfile.TemporaryDirectory() as room:
            name = _plain_name(unquote(request.headers.get("x-name", "")))
            suffix = Path(name).suffix.lower()
            path = Path(room) / f"upload{suffix if suffix[1:].isalnum() and len(suffix) <= 6 else ''}"
            with path.open("wb") as stream:
                async for part in request.stream():
                    size += len(part)
                    if size > MAX_UPLOAD_BYTES:
                        text = f"a file must be at most {MAX_UPLOAD_BYTES // 1_000_000} MB"
                        return JSONResponse({"problem": {"text": text}}, 413)
                    stream.write(part)
            try:
                if kind is UploadKind.TARGET:
                    surface = await asyncio.to_thread(read_target, path, name)
                    number = request.query_params.get("document", "")
                    studio.open_document(int(number) if number.isdecimal() else None)
                    studio.parts.load(surface)
                    return JSONResponse({"target": studio.parts.data()})
                if kind is UploadKind.DRAWING:
                    units = request.query_params.get("units")
                    drawing = await asyncio.to_thread(read_drawing, path, name, units)
                    return JSONResponse({"drawing": drawing.data(studio.drawings.add(drawing))})
                return JSONResponse(await asyncio.to_thread(read_upload, kind, path, name))
            except NoUnitError:
                return JSONResponse({"units": list(MM_OF_UNITS)})  # a question
            except Exception as error:
                problem = failure_data(error, None, "a file of a page")
                status = 422 if isinstance(error, Error) else 500
                return JSONResponse(
                    {"problem": {**problem, "text": problem["text"].replace(f"{path}: ", f"{name}: ")}}, status
                )

    async def target(request: Request) -> Response:
        if studio.parts.target is None:
            return PlainTextResponse("not found", 404)
        packed = await asyncio.to_thread(studio.parts.target.packed)
        return Response(packed, media_type="application/octet-stream")

    async def live(socket: WebSocket) -> None:
        await socket.accept()
        tab = studio.tabs.join()
        if tab is None:
            await socket.send_json({"type": "problem", "kind": "tabs", "text": f"at most {MAX_TABS} pages can be open"})
            await socket.close(TRY_AGAIN_LATER)
            return
        sending = asyncio.create_task(send(socket, tab))
        try:
            while (message := await socket.receive())["type"] != "websocket.disconnect":
                await studio.receive(tab, message.get("text") or "")
        finally:
            studio.tabs.leave(tab)
            studio.parts.update()
            sending.cancel()

    async def send(socket: WebSocket, tab: Tab) -> None:
        with suppress(WebSocketDisconnect, RuntimeError):  # the page has gone
            await tab.serve(socket)
            await socket.close(TRY_AGAIN_LATER)  # it does not read

    async def refused(request: Request, error: Exception) -> Response:
        return PlainTextResponse("not found", 404)

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        await studio.start()
        try:
            yield
        finally:
            await studio.stop()

    routes = [
        Mount(
            "/{token}",
            routes=[
                Route("/", index),
                Mount("/page", StaticFiles(directory=PAGE)),
                Mount("/gallery", StaticFiles(directory=PICTURES, check_dir=False)),
                Route("/file/{name:path}", file),
                Route("/upload", upload, methods=["POST"]),
                Route("/target", target),
                WebSocketRoute("/live", live),
            ],
        )
    ]
    app = Starlette(routes=routes, lifespan=lifespan, exception_handlers={FileNameError: refused})
    return Guard(app, token, hosts)


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
                # Seconds that open connections have to end after Ctrl-C.
                timeout_graceful_shutdown=2,
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
