"""Files that a page sends, each read in a process of its own, with limits; it ends with the page's request."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from starlette.requests import Request

from asterism.equilibrium.errors import Error
from asterism.measure.outline import OUTLINE_FORMATS, read_outline
from asterism.pattern.design.sizing.grey_image import ImageError, pack_image, read_grey
from asterism.pattern.drawing.records import MM_OF_UNITS, NoUnitError
from asterism.studio.child import Child
from asterism.studio.drawing import UploadError, check_corners, read_drawing
from asterism.studio.page_data import problem_data
from asterism.studio.target import read_target

MAX_UPLOAD_BYTES = 8_000_000
MAX_READ_S = 60.0
KINDS = ("image", "outline", "target", "drawing")  # what a file is for
_READER = "asterism.studio.uploads:run_reader"


def read_picture(path: Path, name: str) -> dict[str, Any]:
    """A sizing profile of a design, without `low`, `high` and `extent_mm`; the name goes into it as a note.

    Raises
    ------
    UploadError
        The file cannot be read as a picture.
    """
    try:
        grey = read_grey(path)
    except ImageError as error:
        raise UploadError(f"the picture {error}") from None
    return {"image": name or path.name, "pixels": list(grey.shape[::-1]), "grey": pack_image(grey)}


def read_border(path: Path) -> dict[str, Any]:
    """A border of a design: around the origin, counterclockwise, and with as few corners as a print can show.

    Raises
    ------
    UploadError, ScanError
        The file cannot be read as an outline, or that has too many corners.
    """
    if path.suffix not in (*OUTLINE_FORMATS, ".dxf"):
        raise UploadError(f"an outline must be a file of {', '.join((*OUTLINE_FORMATS, '.dxf'))}")
    # Corners that are nearer to the line between their neighbours are left out.
    polygon = shapely.Polygon(read_outline(path).corners).simplify(0.05)
    corners = np.asarray(shapely.geometry.polygon.orient(polygon).exterior.coords)[:-1, :2]
    check_corners(len(corners))
    return {"polygon_mm": (corners - (corners.min(axis=0) + corners.max(axis=0)) / 2).round(4).tolist()}


async def read_apart(request: Request, kind: str, path: Path, name: str) -> Any:
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

    child = Child(_READER, (kind, path, name, request.query_params.get("units"))).listen(take, take)
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


def run_reader(connection: Connection, kind: str, path: Path, name: str, units: str | None) -> None:
    """The body of the process: read a file, and send what is in it."""
    with suppress(ImportError, ValueError, OSError):  # other systems than Linux have no such limit
        import resource

        taken = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        # 4 GB beside what the libraries take
        resource.setrlimit(resource.RLIMIT_AS, (taken + 4_000_000_000, resource.RLIM_INFINITY))
    try:
        match kind:
            case "target":
                connection.send(read_target(path, name))
            case "drawing":
                connection.send(read_drawing(path, name, units))
            case "image":
                connection.send({"value": read_picture(path, name)})
            case _:
                connection.send({"border": read_border(path)})
    except NoUnitError:
        connection.send((200, {"units": list(MM_OF_UNITS)}))  # a question
    except MemoryError:
        connection.send(None)
    except Exception as error:
        problem = problem_data(error, None, work="a file of a page")
        text = problem["text"].replace(f"{path}: ", f"{name}: ")
        connection.send((422 if isinstance(error, Error) else 500, {"problem": {**problem, "text": text}}))
