"""Files that a page sends are read in a process of their own, with limits; it ends with the page's request."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from starlette.requests import Request

from asterism.equilibrium.errors import Error
from asterism.pattern.drawing.records import MM_OF_UNITS, NoUnitError
from asterism.studio.child import Child, StartedProcess
from asterism.studio.page_data import failure_data
from asterism.studio.uploads import UploadError, UploadKind, read_upload

MAX_READ_S = 60.0
MAX_MEMORY_BYTES = 4_000_000_000  # beside what the libraries take
_READER = "asterism.studio.reading:run_reader"


async def read_apart(request: Request, kind: UploadKind, path: Path, name: str) -> Any:
    """What is in a file: a `Drawing`, a `Target`, or data for the page; a pair of status and data where it fails.

    Raises
    ------
    UploadError
        Reading takes too long or too much memory.
    """
    answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()

    def take(child: Child, message: Any = None) -> None:
        if not answer.done():
            answer.set_result(message)

    child = Child(StartedProcess(_READER, (kind, path, name, request.query_params.get("units"))), take, take)
    try:
        for _ in range(int(MAX_READ_S / 0.25)):
            await asyncio.wait([answer], timeout=0.25)
            if answer.done() or await request.is_disconnected():
                break
        if not answer.done():
            raise UploadError(f"{name}: is not read after {MAX_READ_S:.0f} s: simplify it")
        if answer.result() is None:
            raise UploadError(f"{name}: needs too much memory: simplify it")
        return answer.result()
    finally:
        child.kill()


def run_reader(connection: Connection, kind: UploadKind, path: Path, name: str, units: str | None) -> None:
    """The body of the process: read a file, and send what is in it."""
    from asterism.studio.drawing import read_drawing
    from asterism.studio.target import read_target

    with suppress(ImportError, ValueError, OSError):  # other systems than Linux have no such limit
        import resource

        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (taken + MAX_MEMORY_BYTES, resource.RLIM_INFINITY))
    try:
        if kind is UploadKind.TARGET:
            connection.send(read_target(path, name))
        elif kind is UploadKind.DRAWING:
            connection.send(read_drawing(path, name, units))
        else:
            connection.send(read_upload(kind, path, name))
    except NoUnitError:
        connection.send((200, {"units": list(MM_OF_UNITS)}))  # a question
    except MemoryError:
        connection.send(None)
    except Exception as error:
        problem = failure_data(error, None, "a file of a page")
        text = problem["text"].replace(f"{path}: ", f"{name}: ")
        connection.send((422 if isinstance(error, Error) else 500, {"problem": {**problem, "text": text}}))
