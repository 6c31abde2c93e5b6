"""Messages of the page, checked before anything is done with them."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError

from asterism.studio.gesture_requests import BrushRequest, Change, Paint, PlaceDrawing, StarsRequest, Weigh
from asterism.studio.request import Request, RequestError, WholeNumber

MAX_REQUEST_BYTES = 4_000_000
Name = Annotated[str, Field(min_length=1, max_length=200)]
Slot = Literal["A", "B", "C"]
# what holds a fitted sheet: `auto` chooses between needles and the whole border
Hold = Literal["auto", "border", "nothing"]


class Hello(Request):
    type: Literal["hello"]


class Gallery(Request):
    type: Literal["gallery"]


class Open(Request):
    """Open a design file of the folder, or a copy of a design of the gallery."""

    type: Literal["open"]
    name: Name | None = None
    gallery: Name | None = None


class New(Request):
    type: Literal["new"]


class Save(Request):
    """Write the design file; with `over` also over a text that another program has written there."""

    type: Literal["save"]
    name: Name | None = None
    over: bool = False


class Reread(Request):
    """Show the design file as it is on the disk."""

    type: Literal["reread"]


class Undo(Request):
    type: Literal["undo"]


class Redo(Request):
    type: Literal["redo"]


class HistoryRequest(Request):
    """Send small plans of the last states."""

    type: Literal["history"]


class Go(Request):
    """Show the state at a position of the history."""

    type: Literal["go"]
    position: WholeNumber


class Recover(Request):
    """Take the unsaved work of a former session, or forget it."""

    type: Literal["recover", "discard"]


class FlipRequest(Request):
    type: Literal["flip"]


class FormRequest(Request):
    type: Literal["form"]
    index: WholeNumber


class SlotRequest(Request):
    """Keep the design in a slot, show the one that is there, or empty the slot."""

    type: Literal["keep", "show", "drop"]
    slot: Slot


class BumpsRequest(Request):
    """Show the sheet with its bumps, or without them."""

    type: Literal["bumps"]
    shown: bool


class TargetRequest(Request):
    """Place the target surface: on the sheet, or as its file has it; read its numbers in another unit; forget it."""

    type: Literal["target"]
    do: Literal["fit", "file", "remove"] | None = None
    unit: Literal["mm", "cm", "m", "in"] | None = None


class Verify(Request):
    type: Literal["verify"]


class FitRequest(Request):
    """Fit outline, stars and supports to the target."""

    type: Literal["fit"]
    hold: Hold = "auto"


class CancelRequest(Request):
    """Break off the job."""

    type: Literal["cancel"]


class StopRequest(Request):
    """Break off what the engine computes; the shown shape stays."""

    type: Literal["stop"]


class ExportRequest(Request):
    type: Literal["export"]
    printer: Name | None = None
    plastic: Name | None = None
    options: dict[str, Any] = Field(default_factory=dict, max_length=20)


class ReportRequest(Request):
    type: Literal["report"]


class PrinterRequest(Request):
    type: Literal["printer"]
    name: Name


class Acknowledge(Request):
    type: Literal["ack"]
    frame: WholeNumber


AnyRequest = Annotated[
    Hello
    | Gallery
    | Open
    | New
    | Save
    | Reread
    | Undo
    | Redo
    | HistoryRequest
    | Go
    | Recover
    | Change
    | Paint
    | BrushRequest
    | StarsRequest
    | PlaceDrawing
    | Weigh
    | FlipRequest
    | FormRequest
    | SlotRequest
    | BumpsRequest
    | TargetRequest
    | Verify
    | FitRequest
    | CancelRequest
    | StopRequest
    | ExportRequest
    | ReportRequest
    | PrinterRequest
    | Acknowledge,
    Field(discriminator="type"),
]
_REQUESTS: TypeAdapter[Any] = TypeAdapter(AnyRequest)


def read_request(text: str) -> Request:
    """The message in a text of JSON.

    Raises
    ------
    RequestError
        It is not one of the messages above; the text says why, in one line.

    Examples
    --------
    >>> read_request('{"type": "open", "gallery": "dome"}').gallery
    'dome'
    """
    if len(text) > MAX_REQUEST_BYTES:
        raise RequestError(f"a message must be at most {MAX_REQUEST_BYTES // 1_000_000} MB")
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        raise RequestError("a message must be JSON") from None
    try:
        request: Request = _REQUESTS.validate_python(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        raise RequestError(f"message {place}: {first['msg']}"[:300]) from None
    except RecursionError:
        raise RequestError("a message is nested too deeply") from None
    return request
