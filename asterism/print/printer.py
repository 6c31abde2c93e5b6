"""Profiles of printers and plastics: for the layout, the start code and the estimate of the time."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Literal, Self, TypeVar

from pydantic import AfterValidator, Field, ValidationError, field_validator, model_validator

from asterism.pattern.design.errors import DesignError, from_validation
from asterism.pattern.design.files import own_folders, read_table
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.design.section import Line, MassDensity, Number, Point, Section, Text
from asterism.process.settings import ExportSettings


def _sides(size: Point) -> Point:
    if not all(10 <= side <= 5000 for side in size):
        raise DesignError("", "must be two sides from 10 to 5000 mm", size)
    return size


Sides = Annotated[Point, AfterValidator(_sides)]
# names in braces that a start code may contain
PLACEHOLDERS = ("z_offset_mm", "above_bed_mm", "above_fabric_mm")
# first line of every start code
NOT_COMPLETE = "; not a complete start: put it after the slicer's own, which heats, homes and purges"


class PrintSpeed(Section):
    """Speeds, for the estimate of the time."""

    # first_layer_mm_s and print_mm_s, travel_mm_s: speeds of the nozzle
    first_layer_mm_s: Number = Field(gt=0, le=1000)
    print_mm_s: Number = Field(gt=0, le=1000)
    travel_mm_s: Number = Field(gt=0, le=2000)
    island_s: Number = Field(ge=0, le=60)  # time lost at each separate piece of a layer
    heating_min: Number = Field(ge=0, le=60)  # time before the first line


class FabricFrame(Section):
    """The frame that holds the fabric, centred on the bed."""

    size_mm: Sides = (260.0, 260.0)  # width and depth with the bars
    bar_mm: Number = Field(15.0, ge=0, le=1000)  # width of the bars, which are outside the printable area
    plate_mm: Number = Field(4.0, ge=0, le=50)  # thickness of the plate under the fabric

    @model_validator(mode="after")
    def _bars_leave_an_opening(self) -> Self:
        # smallest width of the opening between the bars of a frame
        most = (min(self.size_mm) - 5.0) / 2
        if self.bar_mm > most:
            sides = f"{self.size_mm[0]:g} x {self.size_mm[1]:g}"
            raise DesignError("bar_mm", f"must be at most {most:g} in a frame of {sides} mm", self.bar_mm)
        return self

    @property
    def opening_mm(self) -> tuple[float, float]:
        """Width and depth between the bars."""
        width, depth = self.size_mm
        return width - 2 * self.bar_mm, depth - 2 * self.bar_mm


class Printer(Section):
    """A printer."""

    name: Line = Field(min_length=1, max_length=100)  # name in tables and instructions
    bed_mm: Sides  # width and depth that the nozzle reaches
    # origin of the coordinates: the left front `corner` of the bed, or its `centre`
    origin: Literal["corner", "centre"] = "corner"
    nozzle_mm: Number = Field(0.4, ge=0.1, le=2)  # diameter of the nozzle, which is also the width of a line
    # allowed heights of the first layer, the preferred first
    first_layers_mm: tuple[Annotated[Number, Field(ge=0.05, le=2)], ...] = Field(min_length=1, max_length=20)
    layer_mm: Number = Field(ge=0.01, le=2)  # height of the other layers
    filament_mm: Number = Field(1.75, ge=1, le=5)  # diameter of the filament
    homes: Literal["away", "onto"]  # motion of the nozzle when z is homed: `away` from the bed, or down `onto` it
    speed: PrintSpeed
    frame: FabricFrame = FabricFrame()
    # G-code that puts the height of the fabric to z = 0, with the `PLACEHOLDERS` in braces. Temperatures, homing,
    # purging and the end are left to the slicer.
    start_code: Text = Field(max_length=10_000)

    @model_validator(mode="after")
    def _layers_of_the_nozzle(self) -> Self:
        heights = {"layer_mm": self.layer_mm}
        heights |= {f"first_layers_mm[{number}]": height for number, height in enumerate(self.first_layers_mm)}
        for field, height in heights.items():
            if height > self.nozzle_mm:
                raise DesignError(field, f"must be at most the nozzle's {self.nozzle_mm:g} mm", height)
        return self

    @field_validator("start_code")
    @classmethod
    def _known_placeholders(cls, code: str) -> str:
        for name in re.findall(r"\{([^{}]*)\}", code):
            if name not in PLACEHOLDERS:
                raise DesignError("", f"may have {', '.join(PLACEHOLDERS)} in braces", "{" + name + "}")
        if "{z_offset_mm}" not in code and "{above_bed_mm}" not in code:
            raise DesignError("", "must use {z_offset_mm} or {above_bed_mm}: the nozzle starts on the fabric")
        return code

    def roundings(self) -> list[Rounding]:
        """The sizes that the printer can make, for each height of the first layer."""
        sizes = {"layer_mm": self.layer_mm, "line_mm": self.nozzle_mm}
        return [Rounding(first_layer_mm=first, **sizes) for first in self.first_layers_mm]

    @property
    def bed_centre_mm(self) -> tuple[float, float]:
        """The middle of the bed in the printer's coordinates."""
        if self.origin == "centre":
            return 0.0, 0.0
        return self.bed_mm[0] / 2, self.bed_mm[1] / 2

    def start_snippet(self, z_offset_mm: float, released_mm: float | None = None) -> str:
        """The start code for a height of the fabric's surface above the bed.

        `released_mm` is the thickness of the released fabric, if that of the stretched fabric is not known.
        """
        above = 10.0  # mm, of the nozzle above the fabric when the start code sets z
        values = (z_offset_mm, z_offset_mm + above, above)
        code = self.start_code
        for name, value in zip(PLACEHOLDERS, values, strict=True):
            code = code.replace("{" + name + "}", f"{value:.2f}")
        code = f"{NOT_COMPLETE}\n{code.strip()}\n"
        if released_mm is None:
            return code
        return f"; for {released_mm:.2f} mm of fabric, released: stretched it is thinner, measure it\n{code}"


class PlasticProfile(Section):
    """A plastic for the printer. Its stiffness belongs to the design."""

    name: Line = Field(min_length=1, max_length=100)
    density_kg_m3: MassDensity = Field(gt=0)  # density, for the mass
    # the export names stars with shorter arms, which may jump off the fabric
    tiny_arm_mm: Number = Field(3.0, ge=0, le=100)
    # nozzle_c and bed_c: temperatures in the instructions; None for no advice
    nozzle_c: Number | None = Field(None, ge=0, le=500)
    bed_c: Number | None = Field(None, ge=0, le=200)
    advice: tuple[Line, ...] = Field((), max_length=20)  # lines of the instructions


_Kind = TypeVar("_Kind", bound=Section)


def profile_names(kind: str) -> list[str]:
    """Names of all profiles of a kind: `printers` or `plastics`."""
    return sorted({path.stem for path in _files(kind)})


def readable_profiles(
    kind: str, load: Callable[[str], _Kind], wrong: Callable[[DesignError], object]
) -> Iterator[tuple[str, _Kind]]:
    """Yield names and profiles of a kind by `load_printer` or `load_plastic`; files with a mistake go to `wrong`."""
    for name in profile_names(kind):
        try:
            profile = load(name)
        except DesignError as error:
            wrong(error)
        else:
            yield name, profile


def load_printer(printer: str | Printer) -> Printer:
    """The profile of a printer.

    `printer`: name of a profile, path of a `.toml` or `.json` file, or the profile itself.

    Raises DesignError: no profile has the name, or the file is wrong; the message names the field, its value and the
    range.
    """
    return _load("printers", printer, Printer)


def load_plastic(plastic: str | PlasticProfile) -> PlasticProfile:
    """The profile of a plastic; parameter and errors as of `load_printer`."""
    return _load("plastics", plastic, PlasticProfile)


def _load(kind: str, name_or_file: str | _Kind, section: type[_Kind]) -> _Kind:
    if not isinstance(name_or_file, str):
        return name_or_file
    path = Path(name_or_file)
    if path.suffix.lower() not in (".toml", ".json"):
        files = [file for file in _files(kind) if file.stem == name_or_file]
        if not files:
            allowed = f"must be a file (.toml) or a name: {', '.join(profile_names(kind))}"
            raise DesignError(f"--{kind[:-1]}", allowed, name_or_file)
        path = files[0]
    try:
        return section.model_validate(read_table(path))
    except ValidationError as error:
        raise from_validation(error, path) from None


def _files(kind: str) -> list[Path]:
    """In the order of the search: of `ASTERISM_PROFILES`, of the user, of the package."""
    folders = (*own_folders(), Path(__file__).parent / "data")
    return [file for folder in folders for file in sorted((folder / kind).glob("*.toml"))]


def adjusted_printer(settings: ExportSettings) -> Printer:
    """The printer of some settings, with their layers, plate and frame in place of its own.

    Raises DesignError: no profile has the name, or an option is out of range.
    """
    data = load_printer(settings.printer).model_dump(mode="json")
    if settings.first_layer_mm is not None:
        data["first_layers_mm"] = [settings.first_layer_mm]
    if settings.layer_mm is not None:
        data["layer_mm"] = settings.layer_mm
    if settings.plate_mm is not None:
        data["frame"]["plate_mm"] = settings.plate_mm
    if settings.frame_mm is not None:
        data["frame"]["size_mm"] = list(settings.frame_mm)
    options = {"first_layers_mm[0]": "--first-layer", "layer_mm": "--layer", "frame.plate_mm": "--plate"}
    options |= {f"frame.{name}": "--frame" for name in ("size_mm", "bar_mm")}
    try:
        return Printer.model_validate(data)
    except ValidationError as error:
        wrong = from_validation(error)
        raise DesignError(options.get(wrong.field, wrong.field), wrong.allowed, wrong.value) from None
