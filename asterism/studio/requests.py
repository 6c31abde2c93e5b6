"""Messages of the page, checked before anything is done with them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Annotated, Any, Literal, Self, Union

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, model_validator

from asterism.equilibrium.errors import Error
from asterism.pattern.design.stars import STAR_SIZES, RodSizeKey
from asterism.process.settings import ExportSettings
from asterism.studio.painted_field import Brush

WholeNumber = Annotated[int, Field(ge=0, le=2**53)]


class RequestError(Error, ValueError):
    """A message that the server does not understand."""


class Request(BaseModel):
    """A message of the page.

    Attributes
    ----------
    seq : number of the message in its tab; a problem with the message carries it.
    document : number of the document that the message is about; the server refuses one about a document that is not
        open any more.
    """

    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)
    seq: WholeNumber | None = None
    document: WholeNumber | None = None


SiteIndex = Annotated[int, Field(ge=-100_000, le=100_000)]
Sites = Annotated[list[tuple[SiteIndex, SiteIndex]], Field(max_length=20_000)]
SizesOfSites = Annotated[list[float | None], Field(max_length=20_000)]
PlaceMm = tuple[Annotated[float, Field(ge=-1e5, le=1e5)], Annotated[float, Field(ge=-1e5, le=1e5)]]


class GestureRequest(Request):
    """A change that belongs to a gesture; the gesture ends with `end`."""

    gesture: WholeNumber | None = None
    end: bool = True


class Change(GestureRequest):
    type: Literal["edit"]
    changes: dict[str, Any] = Field(max_length=100)


class TakeBack(GestureRequest):
    """The gesture is called off: its changes are forgotten."""

    type: Literal["take back"]


class Paint(GestureRequest):
    """Sizes of stars by their names, such as `length` and `thickness`."""

    type: Literal["sizes"]
    sites: Sites
    by_name: dict[str, SizesOfSites]

    @model_validator(mode="before")
    @classmethod
    def _by_name(cls, message: dict[str, Any]) -> dict[str, Any]:
        given = {size.name: message[size.name] for size in STAR_SIZES if message.get(size.name) is not None}
        return {**message, "by_name": given}

    @property
    def sizes(self) -> dict[str, list[float | None]]:
        """The sizes that are given, by the keys of the design file."""
        for name, values in self.by_name.items():
            if len(values) != len(self.sites):
                raise RequestError(f"sizes: {name} must have one value for each of the {len(self.sites)} sites")
        return {size.key: self.by_name[size.name] for size in STAR_SIZES if size.name in self.by_name}


class BrushRequest(GestureRequest, Brush):
    """Paint a size of rods.

    Attributes
    ----------
    size : that is painted.
    places : printed mm, each with its images under the symmetries of the brush.
    """

    type: Literal["brush"]
    size: RodSizeKey
    places: Annotated[list[Annotated[list[PlaceMm], Field(min_length=1, max_length=24)]], Field(max_length=1000)]


class StarsRequest(GestureRequest):
    """Remove stars, bring them back, or drop their painted sizes."""

    type: Literal["remove", "restore", "reset"]
    sites: Sites


class LayerUse(BaseModel):
    """What a layer of a drawing becomes, and the sections (mm) of its rods."""

    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)
    use: Literal["rods", "outline", "both"]
    thickness: float = 0.3
    width: float = 1.2


class PlaceDrawing(GestureRequest):
    """Lay a drawing that was sent before on the sheet.

    Attributes
    ----------
    drawing : its number.
    layers : by name; others are left out.
    strokes : widths of the rods are those of the drawn strokes.
    keep : the pattern that is there stays.
    sheet : without an outline in the drawing, the sheet keeps its own, or gets a rectangle around the drawing.
    origin : the middle of the drawing, or its own origin, becomes that of the sheet.
    """

    type: Literal["drawing"]
    drawing: WholeNumber
    layers: dict[str, LayerUse] = Field(min_length=1, max_length=1000)
    strokes: bool = False
    keep: bool = False
    sheet: Literal["kept", "around"] = "kept"
    origin: Literal["middle", "drawing"] = "middle"


class Weigh(GestureRequest):
    """Other weights of places in a fit; null takes a weight away."""

    type: Literal["weigh"]
    sites: Sites
    weights: SizesOfSites

    @model_validator(mode="after")
    def _one_a_site(self) -> Self:
        if len(self.weights) != len(self.sites):
            raise ValueError(f"weights must have one value for each of the {len(self.sites)} sites")
        return self


MAX_REQUEST_BYTES = 4_000_000
Name = Annotated[str, Field(min_length=1, max_length=200)]
# never a file: names come from outside
ProfileName = Annotated[str, Field(pattern=r"^[A-Za-z0-9-]+$", max_length=200)]
# what holds a fitted sheet: `auto` chooses between needles and the whole border
Hold = Literal["auto", "border", "nothing"]


class Simple(Request):
    """A message of one word: its type."""

    type: Literal[
        "hello",  # show me all that there is
        "gallery",
        "new",
        "reread",  # show the design file as it is on the disk
        "undo",
        "redo",
        "history",  # send small plans of the last states
        "kept",  # send small plans of the unsaved work that other sessions have left
        "flip",
        "settle",  # compute the exact shape, although it takes long
        "verify",
        "report",
        "animate",  # draw the release of the sheet to the exact shape that is shown
        "spread",  # compute how much prints differ from the exact shape that is shown
        "cancel",  # break off the job
        "stop",  # break off what the engine computes; the shown shape stays
    ]


class Open(Request):
    """Open a design file of the folder, or a copy of a design of the gallery."""

    type: Literal["open"]
    name: Name | None = None
    gallery: Name | None = None


class Save(Request):
    """Write the design file; with `over` also over a text that another program has written there."""

    type: Literal["save"]
    name: Name | None = None
    over: bool = False


class Go(Request):
    """Show the state at a position of the history."""

    type: Literal["go"]
    position: WholeNumber


class Recover(Request):
    """Take the unsaved work of another session, or forget it; without a name the last one, or all."""

    type: Literal["recover", "discard"]
    name: Name | None = None


class FormRequest(Request):
    type: Literal["form"]
    index: WholeNumber


class ExactFormRequest(Request):
    """Show the exact shape that the release from the flat print leads to, or the one that followed the preview."""

    type: Literal["exact-form"]
    released: bool


class SlotRequest(Request):
    """Keep the design in a slot, or show the one that is there."""

    type: Literal["keep", "show"]
    slot: Literal["A", "B", "C"]


class BumpsRequest(Request):
    """Show the sheet with its bumps, or without them."""

    type: Literal["bumps"]
    shown: bool


class TargetRequest(Request):
    """Place the target surface: on the sheet, or as its file has it; read its numbers in another unit; forget it."""

    type: Literal["target"]
    do: Literal["fit", "file", "remove"] | None = None
    unit: Literal["mm", "cm", "m", "in"] | None = None


class FitRequest(Request):
    """Fit outline, stars and supports to the target."""

    type: Literal["fit"]
    hold: Hold = "auto"


class ExportRequest(Request):
    """Write the files for the print; without a printer for the chosen one. For the others see `asterism export`."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)
    type: Literal["export"]
    printer: ProfileName | None = None
    plastic: ProfileName | None = None
    preview: bool | None = None
    border: bool | None = None
    needle_spacing_mm: float | None = None

    def settings(self, printer: str) -> ExportSettings:
        """The settings of the export, with the printer that the studio has chosen if none is given."""
        given = self.model_dump(exclude={"type", "seq", "document"}, exclude_none=True)
        return ExportSettings(**{"printer": printer, **given})


class PrinterRequest(Request):
    type: Literal["printer"]
    name: Name


class Acknowledge(Request):
    type: Literal["ack"]
    frame: WholeNumber


def _kinds(of: type[Request]) -> Iterator[type[Request]]:
    """The classes of messages, each with the words of its own in `type`."""
    if "type" in of.model_fields:
        yield of
    for kind in of.__subclasses__():
        yield from _kinds(kind)


_ANY: Any = Annotated[Union[*_kinds(Request)], Field(discriminator="type")]
_REQUESTS: TypeAdapter[Request] = TypeAdapter(_ANY)


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
        return _REQUESTS.validate_python(data)
    except ValidationError as error:
        first = error.errors(include_url=False, include_input=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        raise RequestError(f"message {place}: {first['msg']}"[:300]) from None
    except RecursionError:
        raise RequestError("a message is nested too deeply") from None
