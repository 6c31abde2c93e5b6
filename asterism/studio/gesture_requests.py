"""Messages of the page that change the design; those of one gesture are one step of undo."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from asterism.homogenize.law.motif_plan import RodSizeKey
from asterism.studio.painted_field import Brush
from asterism.studio.request import Request, RequestError, WholeNumber

MAX_SITES = 20_000
SiteIndex = Annotated[int, Field(ge=-100_000, le=100_000)]
Sites = Annotated[list[tuple[SiteIndex, SiteIndex]], Field(max_length=MAX_SITES)]
SizesOfSites = Annotated[list[float | None], Field(max_length=MAX_SITES)]
PlaceMm = tuple[Annotated[float, Field(ge=-1e5, le=1e5)], Annotated[float, Field(ge=-1e5, le=1e5)]]


class GestureRequest(Request):
    """A change that belongs to a gesture; the gesture ends with `end`."""

    gesture: WholeNumber | None = None
    end: bool = True


class Change(GestureRequest):
    type: Literal["edit"]
    changes: dict[str, Any] = Field(max_length=100)


class Paint(GestureRequest):
    type: Literal["sizes"]
    sites: Sites
    length: SizesOfSites | None = None
    thickness: SizesOfSites | None = None
    width: SizesOfSites | None = None

    @property
    def sizes(self) -> dict[str, list[float | None]]:
        """The sizes that are given, by the keys of the design file."""
        given = {"length_mm": self.length, "thickness_mm": self.thickness, "width_mm": self.width}
        for key, values in given.items():
            if values is not None and len(values) != len(self.sites):
                raise RequestError(f"sizes: {key} must have one value for each of the {len(self.sites)} sites")
        return {key: values for key, values in given.items() if values is not None}


class BrushRequest(GestureRequest):
    """Paint a size of rods.

    Attributes
    ----------
    size : that is painted.
    places : printed mm, each with its images under the symmetries of the brush.

    For the others, see `asterism.studio.painted_field.Brush`.
    """

    type: Literal["brush"]
    size: RodSizeKey
    mode: Literal["set", "add", "smooth"]
    radius: Annotated[float, Field(ge=0.5, le=1000)]
    strength: Annotated[float, Field(ge=0, le=1)]
    value: Annotated[float, Field(ge=-100, le=100)] = 0.0
    low: Annotated[float, Field(ge=0, le=100)]
    high: Annotated[float, Field(ge=0, le=100)]
    places: Annotated[list[Annotated[list[PlaceMm], Field(min_length=1, max_length=24)]], Field(max_length=1000)]

    @property
    def brush(self) -> Brush:
        """The brush of this request."""
        return Brush(self.mode, self.radius, self.strength, self.value, self.low, self.high)


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
