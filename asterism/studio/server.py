"""The web server of the studio: pages, files, uploads and the live connection, for this machine only, until Ctrl-C."""

from __future__ import annotations

import asyncio
import hmac
import mimetypes
import secrets
import tempfile
import threading
import webbrowser
from collections.abc import AsyncIterator, Callable, Mapping
from contextlib import asynccontextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from asterism.equilibrium.errors import Error
from asterism.pattern.drawing.read import Drawing
from asterism.process.local_server import LOOPBACK, Guard, Scope, bound, host_names, serve
from asterism.studio.child import Child
from asterism.studio.drawing import drawing_data
from asterism.studio.engine_link import EngineLink
from asterism.studio.examples import PICTURES
from asterism.studio.file_names import MAX_NAME_CHARACTERS, FileNameError, file_below
from asterism.studio.page_data import problem_data
from asterism.studio.pages import MAX_TABS, KeptShape, Tab
from asterism.studio.requests import MAX_REQUEST_BYTES
from asterism.studio.studio import Studio
from asterism.studio.target import Target
from asterism.studio.uploads import KINDS, MAX_UPLOAD_BYTES, read_apart

PAGE = Path(__file__).parent / "page"
# Windows may have other types for these in its registry, and a module of another type is not run.
for _suffix, _type in ((".js", "text/javascript"), (".css", "text/css"), (".svg", "image/svg+xml")):
    mimetypes.add_type(_type, _suffix)

TRY_AGAIN_LATER = 1013


class PageGuard(Guard):
    """Lets through what comes from a page of this server, and nothing else.

    A stranger's page does not know the token, and cannot hide its origin.
    """

    def __init__(self, app: Any, token: str, hosts: frozenset[str]) -> None:
        others = "object-src 'none'; base-uri 'none'; frame-ancestors 'none'"
        super().__init__(app, hosts, f"default-src 'self'; img-src 'self' blob: data:; {others}")
        self._token = token.encode()

    def refusal(self, scope: Scope, headers: Mapping[str, str]) -> int | None:
        """The status of a request that is refused; None if it is allowed."""
        if status := super().refusal(scope, headers):
            return status
        origin = headers.get("origin")
        needs_origin = scope["type"] == "websocket" or scope["method"] not in ("GET", "HEAD")
        if (origin is not None or needs_origin) and origin not in {f"http://{host}" for host in self._hosts}:
            return 403
        token = scope["path"].split("/")[1] if scope["path"].startswith("/") else ""
        return None if hmac.compare_digest(token.encode(), self._token) else 404


def _plain_name(name: str) -> str:
    """The last part of a file's name, printable and short."""
    last = name.replace("\\", "/").split("/")[-1]
    return "".join(c for c in last if c.isprintable())[-MAX_NAME_CHARACTERS:]


def application(studio: Studio, token: str, hosts: frozenset[str]) -> PageGuard:
    """The web application of a studio; `PageGuard` stands before it."""

    async def index(request: Request) -> Response:
        return FileResponse(PAGE / "index.html")

    async def file(request: Request) -> Response:
        path = file_below(studio.folder, request.path_params["name"])
        if not path.is_file():
            return PlainTextResponse("not found", 404)
        how = "inline" if path.suffix in (".html", ".pdf", ".png", ".gif") else "attachment"
        # reports are complete in themselves; they may style themselves and show the pictures in them, and nothing else
        policy = "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:"
        headers = {"content-security-policy": policy}
        return FileResponse(path, filename=path.name, content_disposition_type=how, headers=headers)

    async def upload(request: Request) -> Response:
        if (kind := request.query_params.get("kind", "")) not in KINDS:
            return PlainTextResponse("not found", 404)
        size = 0
        # a reader that has just been ended may still hold its file, which Windows then keeps
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as room:
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
                content = await read_apart(request, kind, path, name)
                if isinstance(content, Target):
                    number = request.query_params.get("document", "")
                    studio.open_document(int(number) if number.isdecimal() else None)
                    studio.parts.load(content)
                    content = {"target": studio.parts.data()}
                elif isinstance(content, Drawing):
                    data = await asyncio.to_thread(drawing_data, content, studio.drawings.add(content))
                    content = {"drawing": data}
            except Error as error:
                content = 422, {"problem": problem_data(error, None, work="a file of a page")}
            status, data = content if isinstance(content, tuple) else (200, content)
            return JSONResponse(data, status)

    async def target(request: Request) -> Response:
        if studio.parts.target is None:
            return PlainTextResponse("not found", 404)
        return await packed(studio.parts.target)

    async def shape(request: Request) -> Response:
        kept = studio.shown.kept.get(request.path_params["number"])
        if kept is None:
            return PlainTextResponse("not found", 404)
        return await packed(kept)

    async def packed(one: Target | KeptShape) -> Response:
        return Response(await asyncio.to_thread(one.packed), media_type="application/octet-stream")

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
                Route("/shape/{number:int}", shape),
                WebSocketRoute("/live", live),
            ],
        )
    ]
    app = Starlette(routes=routes, lifespan=lifespan, exception_handlers={FileNameError: refused})
    return PageGuard(app, token, hosts)


def run_studio(
    path: Path | None,
    *,
    port: int = 0,
    listen: str = LOOPBACK,
    opens_browser: bool = True,
    say: Callable[[str], None] = print,
    engine: Child | None = None,
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
    with bound(listen, port) as listening:
        port = listening.getsockname()[1]
        host = f"[{listen}]" if ":" in listen else listen
        url = f"http://{host}:{port}/{token}/"
        say(f"studio: {url}")
        say("Ctrl-C ends it")
        if opens_browser:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
        serve(
            listening,
            application(studio, token, host_names(listen, port)),
            ws="websockets-sansio",
            ws_max_size=MAX_REQUEST_BYTES,
            ws_per_message_deflate=False,
        )
    for file in studio.unsaved_work():
        say(f"unsaved work is kept in {file}")
