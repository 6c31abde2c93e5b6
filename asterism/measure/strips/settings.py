"""The settings of test strips, of their print and of their fit: for Python, and for the options of the commands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from asterism.pattern.design.errors import DesignError
from asterism.process.settings import check_settings

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
