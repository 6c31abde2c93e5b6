"""The settings of an export: one object for Python, the command, whose options are made from it, and the studio."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from asterism.process.settings import check_settings


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
