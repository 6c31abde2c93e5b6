"""The settings of jobs: one frozen dataclass for Python and the studio, from whose fields a command makes its options.

The type of a field may be annotated with the name of its option, such as `"--fabric"`, and with the limits of its
numbers, such as `(0.01, 50.0)`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

from asterism.equilibrium.errors import Error
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import is_whole


def field_types(kind: type) -> dict[str, tuple[Any, list[str], list[tuple[float, float]]]]:
    """Of each field of a settings object its type, the names of its option (none: as the field), and its limits."""
    found = {}
    for field, given in get_type_hints(kind, include_extras=True).items():
        plain, *extra = get_args(given) if get_origin(given) is Annotated else (given,)
        names = [each for each in extra if isinstance(each, str)]
        found[field] = plain, names, [each for each in extra if isinstance(each, tuple)]
    return found


def check_settings(settings: Any) -> None:
    """Raise DesignError, with the name of the option, for a number beyond its limits or a word that is no choice."""
    for field, (plain, names, limits) in field_types(type(settings)).items():
        value, problem = getattr(settings, field), ""
        for low, high in limits:
            if value is not None and not (isinstance(value, int | float) and low <= value <= high):
                problem = f"must be from {low:g} to {high:g}"
        if plain in (int, int | None) and not isinstance(value, int | None):
            problem = "must be a whole number"
        if any(get_origin(one) is tuple for one in (plain, *get_args(plain))) and isinstance(value, str | float | int):
            problem = "must be a tuple"
        if get_origin(plain) is Literal and value not in get_args(plain):
            problem = f"must be {' or '.join(get_args(plain))}"
        if problem:
            raise DesignError((names or [f"--{field.replace('_', '-')}"])[0], problem, value)


@dataclass(frozen=True, kw_only=True)
class ExportSettings:
    """How a design is made ready for a printer.

    Attributes
    ----------
    printer : name of a printer (see `asterism printers`), or its file.
    plastic : name of a plastic, or its file.
    preview : compute the printed shape by the preview, and write its files.
    simulate : the same by the exact model, with the effect of rounding.
    first_layer_mm : height of the first layer in mm, in place of the printer's.
    layer_mm : height of the other layers in mm.
    plate_mm : thickness of the plate under the fabric in mm.
    frame_mm : width and depth of the frame with its bars in mm, such as 300x250.
    fabric_mm : thickness of the stretched fabric in mm; by default that of the released fabric.
    fabric_set_percent : percent by which a bare piece of the fabric is longer after its release than before it was
        stretched; the check square is stretched further by as much.
    turn_deg : rotation of the print on the bed in degrees, counterclockwise.
    needle_spacing_mm : largest distance of needles on supported edges in mm.
    border : print a line to cut along, if it fits the bed and the frame.
    formats : also write this format: 3dm for Rhino (requires rhino3dm), with the sheet in space if its shape is known.

    Raises
    ------
    DesignError
        A number is out of range.
    """

    printer: str = "ultimaker2"
    plastic: str = "tpu95a"
    preview: bool = False
    simulate: bool = False
    first_layer_mm: Annotated[float | None, "--first-layer"] = None
    layer_mm: Annotated[float | None, "--layer"] = None
    plate_mm: Annotated[float | None, "--plate"] = None
    frame_mm: Annotated[tuple[float, float] | None, "--frame"] = None
    # the lower limit is that of a design
    fabric_mm: Annotated[float | None, "--fabric", (0.01, 50.0)] = None
    fabric_set_percent: Annotated[float, "--fabric-set", (0.0, 50.0)] = 0.0
    turn_deg: Annotated[float, "--turn", (-360.0, 360.0)] = 0.0
    needle_spacing_mm: Annotated[float, "--needle-spacing", (1.0, 1000.0)] = 20.0
    border: bool = True
    formats: Annotated[tuple[str, ...], "--format"] = ()

    def __post_init__(self) -> None:
        check_settings(self)


THICKNESSES_MM = (0.30, 0.35, 0.40, 0.45)
StripFormula = Literal["paper", "timoshenko"]
KappaBarKind = Literal["constant", "per-thickness", "zero"]


@dataclass(frozen=True, kw_only=True)
class StripPrintSettings:
    """A test print of strips.

    Attributes
    ----------
    printer : name of a printer (see `asterism printers`), or its file.
    thicknesses_mm : thickness of strips in mm; the command takes the option several times.
    count : number of strips of each thickness, and direction; by default 10, or 5 in both directions.
    both_directions : strips along the grain of the fabric, which lies along x, and as many across.
    length_mm : length of a strip in mm.
    stretch : stretch of the fabric.
    fabric_thickness_mm : thickness of the released fabric in mm.
    plate_mm : thickness of the plate under the fabric in mm, in place of the printer's.
    fabric_mm : thickness of the stretched fabric in mm; by default that of the released fabric.

    Raises
    ------
    DesignError
        A number is out of range.
    """

    printer: str = "ultimaker2"
    thicknesses_mm: Annotated[tuple[float, ...], "--thickness"] = THICKNESSES_MM
    count: Annotated[int | None, (1, 200)] = None
    both_directions: bool = False
    length_mm: Annotated[float, "--length", (10.0, 500.0)] = 60.0
    stretch: Annotated[float, (1.01, 3.0)] = 1.35
    fabric_thickness_mm: Annotated[float, "--fabric-thickness", (0.01, 10.0)] = 0.8
    plate_mm: Annotated[float | None, "--plate"] = None
    fabric_mm: Annotated[float | None, "--fabric", (0.01, 10.0)] = None

    def __post_init__(self) -> None:
        check_settings(self)
        if not self.thicknesses_mm:
            raise DesignError("--thickness", "must be one at least", self.thicknesses_mm)


@dataclass(frozen=True, kw_only=True)
class StripFitSettings:
    """How a material is fitted to a table of strips.

    Attributes
    ----------
    rest_curvature : formula for the curvature of a strip with its fabric, and convention of E1/E2.
    kappa_bar : model of the curvature of peeled strips.
    stretch : stretch of the fabric, if the table has no such column.
    fabric_thickness_mm : thickness of the fabric in mm, if the table has no such column.
    outside : the boxes enclose the strips with their thickness.

    Raises
    ------
    DesignError
        A number is out of range, or a word is no choice.
    """

    rest_curvature: StripFormula = "paper"
    kappa_bar: KappaBarKind = "constant"
    stretch: Annotated[float | None, (1.01, 3.0)] = None
    fabric_thickness_mm: Annotated[float | None, "--fabric-thickness", (0.01, 10.0)] = None
    outside: bool = False

    def __post_init__(self) -> None:
        check_settings(self)


class SettingError(Error, ValueError):
    """A setting of a fit is not allowed."""


@dataclass(frozen=True, kw_only=True)
class FitSettings:
    """How a design for a target is found.

    Attributes
    ----------
    stretch : stretch of the fabric; by default the smallest one of the law whose stars contract differently enough.
    needles : number of needles that hold the outline at its places on the target; 0 for a free sheet. By default they
        stand at the corners of the target, and at distances of about 1.6 spacings between.
    border : hold the whole border along that of the target, in place of needles. By default if needles are not given
        and a quarter of the absolute Gauss curvature of the target is negative.
    width_mm : width of all arms; 1.2 mm by default. The fit changes lengths and thicknesses.
    exact : correct the sizes by the exact model, and check the design as `verify` does.
    corrections : largest number of corrections by the exact model; 0 leaves the fit by the preview as it is.
    nearest : if stars cannot contract as differently or curve as tightly as the target needs, make the sheet that comes
        nearest, in place of an error.
    within_percent : distance, in % of the diameter, within which the target counts as reached.

    Raises
    ------
    SettingError
        `needles` is not a whole number from 0 to 1000, or is 1 or 2, or is given with `border`; `corrections` is not a
        whole number from 0 to 20; or a width or distance is not a positive number.
    """

    stretch: float | None = None
    needles: int | None = None
    border: bool | None = None
    width_mm: float | None = None
    exact: bool = True
    corrections: int = 5
    nearest: bool = False
    within_percent: Annotated[float, "--within"] = 1.0

    def __post_init__(self) -> None:
        needles = self.needles
        if needles is not None and (not is_whole(needles) or not 0 <= needles <= 1000 or needles in (1, 2)):
            raise SettingError(f"needles = {needles!r}: must be 0, or a whole number from 3 to 1000")
        if needles is not None and self.border:
            raise SettingError(f"needles = {needles}: conflicts with border = True")
        if not is_whole(self.corrections) or not 0 <= self.corrections <= 20:
            raise SettingError(f"corrections = {self.corrections!r}: must be a whole number from 0 to 20")
        for name, value in (("width_mm", self.width_mm), ("within_percent", self.within_percent)):
            if value is not None and not 0.0 < value < math.inf:
                raise SettingError(f"{name} = {value!r}: must be a positive number")
