"""The server that Hops asks: descriptions of the components, and one computation after the other."""

from __future__ import annotations

import asyncio
import hmac
import json
import logging
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from asterism.equilibrium.errors import Error
from asterism.hops.components import COMPONENTS, Component, Stopped, Work
from asterism.hops.parameters import BadInputs, InputError, Units, read_inputs, write_outputs
from asterism.process.local_server import LOOPBACK, Guard, Scope, bound, host_names, serve

MAX_REQUEST_BYTES = 16_000_000
# requests that may wait at the same time
MAX_WAITING = 200

_log = logging.getLogger(__name__)


def _refused(error: str, status: int) -> Response:
    """An answer that shows as an error on the component. Hops keeps answers of status 200 only."""
    return JSONResponse({"values": [], "warnings": [], "errors": [error]}, status)


class HopsGuard(Guard):
    """Lets through requests without an origin: Hops sends none, and a page in a browser cannot leave it out.

    With a `key`, `solve` asks for it in the header RhinoComputeKey.
    """

    def __init__(self, app: Any, hosts: frozenset[str], key: str | None) -> None:
        super().__init__(app, hosts, "default-src 'none'")
        self._key = None if key is None else key.encode()

    def refusal(self, scope: Scope, headers: Mapping[str, str]) -> int | None:
        """The status of a request that is refused; None if it is allowed."""
        if scope["type"] != "http" or "origin" in headers:
            return 403
        if status := super().refusal(scope, headers):
            return status
        if scope["method"] != "POST":
            return None
        # Hops sends its key in this header
        if self._key is not None and not hmac.compare_digest(headers.get("rhinocomputekey", "").encode(), self._key):
            return 401
        is_json = headers.get("content-type", "").partition(";")[0].strip().lower() == "application/json"
        return None if is_json else 415

    def refused(self, status: int) -> Response:
        """The answer to a request that is refused."""
        reasons = {401: "the key of the server is missing or wrong", 415: "only application/json"}
        return _refused(reasons.get(status, "not allowed"), status)


def describe(part: Component) -> dict[str, Any]:
    """The description of a component, as Hops reads it."""
    return {
        "Uri": f"/{part.name}",
        "Name": part.name,
        "Description": part.description,
        "Icon": '<svg xmlns="http://www.w3.org/2000/svg" width="24" height="24" viewBox="0 0 24 24">'
        '<path d="M12 12 12 3M12 12 4 17M12 12 20 17" stroke="#e64a19" stroke-width="3" stroke-linecap="round"/></svg>',
        "Inputs": [parameter.as_input() for parameter in part.inputs],
        "Outputs": [parameter.as_output() for parameter in part.outputs],
    }


def solve(work: Work, request: Any) -> dict[str, Any]:
    """The answer to a request; an `Error` if it is wrong, or the sheet that it asks for."""
    pointer = request.get("pointer") if isinstance(request, dict) else None
    part = COMPONENTS.get(pointer.strip("/")) if isinstance(pointer, str) else None
    if part is None:
        raise InputError(f"pointer: must be one of {', '.join(COMPONENTS)}")
    units = Units.of(request)
    found, warnings = part.solve(work, read_inputs(part.inputs, request, units))
    values = write_outputs(part.outputs, found, units)
    return {"pointer": part.name, "values": values, "warnings": list(warnings), "errors": []}


def application(work: Work, hosts: frozenset[str], key: str | None = None) -> HopsGuard:
    """The web application; `HopsGuard` stands before it."""
    turn, waiting = asyncio.Lock(), 0

    async def descriptions(request: Request) -> Response:
        return JSONResponse([describe(part) for part in COMPONENTS.values()])

    async def description(request: Request) -> Response:
        part = COMPONENTS.get(request.path_params["name"])
        return _refused("not found", 404) if part is None else JSONResponse(describe(part))

    async def solved(request: Request) -> Response:
        nonlocal waiting
        body = bytearray()
        async for chunk in request.stream():
            body += chunk
            if len(body) > MAX_REQUEST_BYTES:
                return _refused(f"a request must be at most {MAX_REQUEST_BYTES // 1_000_000} MB", 413)
        if waiting >= MAX_WAITING:
            return _refused(f"{MAX_WAITING} requests wait already", 503)
        waiting += 1
        try:
            async with turn:  # in the order of arrival
                if await request.is_disconnected():
                    return _refused("nobody waits", 400)
                return await asyncio.to_thread(_answered, work, bytes(body))
        finally:
            waiting -= 1

    async def failed(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        return _refused("not found" if error.status_code == 404 else "not allowed", error.status_code)

    routes = [
        Route("/", descriptions),
        Route("/solve", solved, methods=["POST"]),
        Route("/{name}", description),
    ]
    app = Starlette(routes=routes, exception_handlers={HTTPException: failed})
    return HopsGuard(app, hosts, key)


def _answered(work: Work, body: bytes) -> Response:
    try:
        try:
            request = json.loads(body)
        except (ValueError, RecursionError):
            raise InputError("a request must be JSON") from None
        return JSONResponse(solve(work, request))
    except BadInputs as error:
        return JSONResponse({"values": [], "warnings": [], "errors": ["Bad inputs", str(error)]}, 500)
    except Stopped:
        return _refused("the server ends", 503)
    except (Error, OSError) as error:
        return _refused(" ".join(str(error).split()), 400)
    except Exception as error:
        _log.exception("a component")
        return _refused(f"a mistake of asterism, not of yours, see its terminal: {type(error).__name__}", 500)


def run_hops(
    folder: Path,
    *,
    port: int,
    key: str | None = None,
    patience_s: float = 100.0,
    say: Callable[[str], None] = print,
) -> None:
    """Serve the components to this machine, and return when the server has been stopped.

    Parameters
    ----------
    folder : prints are written below it.
    port : 0 takes a free one.
    key : that requests must carry; None for no key.
    patience_s : longest estimated time of an exact shape.
    say : called with the addresses of the components.

    Raises ListenError: the port is in use.
    """
    with bound(LOOPBACK, port) as listening:
        port = listening.getsockname()[1]
        work = Work(folder, patience_s)
        app = application(work, host_names(LOOPBACK, port), key)
        for part in COMPONENTS.values():
            say(f"http://{LOOPBACK}:{port}/{part.name:<6} {part.description}")
        say("Ctrl-C ends it")
        serve(listening, app, work.stopping.set, ws="none", timeout_graceful_shutdown=20)
