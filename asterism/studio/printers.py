"""Printers and plastics as the page shows them."""

from __future__ import annotations

from functools import cache
from typing import Any

from asterism.print.bed_placement import room_mm
from asterism.print.profiles import load_printer, profile_names
from asterism.studio.request import RequestError

DEFAULT_PRINTER = "ultimaker2"


@cache
def printer_entries() -> tuple[dict[str, Any], ...]:
    """Name, title, printable area and frame (mm), and layer heights of each printer."""
    entries = []
    for name in profile_names("printers"):
        printer = load_printer(name)
        rounding = printer.roundings()[0]
        entries.append(
            {
                "name": name,
                "title": printer.name,
                "area_mm": [float(side) for side in room_mm(printer)],
                "frame_mm": [float(side) for side in printer.frame.size_mm],
                "rounding": {
                    "first_layer_mm": rounding.first_layer_mm,
                    "layer_mm": rounding.layer_mm,
                    "line_mm": rounding.line_mm,
                },
            }
        )
    return tuple(entries)


def plastic_names() -> list[str]:
    """Names of the plastics that can be chosen for an export."""
    return profile_names("plastics")


def known_printer(name: str) -> str:
    """The name, if there is a profile of that name.

    Raises
    ------
    RequestError
        There is none.
    """
    if name not in [entry["name"] for entry in printer_entries()]:
        raise RequestError(f"printer: there is no {name!r}")
    return name
