"""Small jobs for the tests of exports, the files that an export writes, and the command that writes them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from asterism import Design, ExportSettings, Shape
from asterism.print.job import Job, prepare
from asterism.print.printer import load_plastic, load_printer
from tests.asterism.commands import Outcome

SMALL: dict[str, Any] = {
    "name": "small",
    "fabric": {"stretch": [1.35, 1.3]},
    "stars": {
        "length_mm": 8.0,
        "thickness_mm": {"profile": "radial", "from": 0.6, "to": 0.2, "over_mm": 40.0},
        "override": [{"at_mm": [0.0, 0.0], "length_mm": 2.0}],
    },
    "border": {"rings": 2},
    "pins": [{"edges": [0, 3], "scale": 0.8}],
}
# a rim, a rib across it and a vein beyond it
LEAF: dict[str, Any] = {
    "name": "leaf",
    "rods": {
        "draw": [
            {
                "name": "rim",
                "spline_mm": [(-40, 0), (-20, 13), (10, 17), (40, 0), (10, -17), (-20, -13)],
                "closed": True,
                "thickness_mm": 0.6,
                "width_mm": 1.6,
            },
            {"name": "rib", "line_mm": [(-40, 0), (40, 0)], "thickness_mm": 0.4},
            {"name": "vein", "line_mm": [(-15, 0), (0, 30)], "width_mm": 0.8},
        ]
    },
    "border": {"rods": "rim"},
}


def design(**changes: Any) -> Design:
    """A hexagon of 19 stars, with its sections changed."""
    return Design.from_dict(SMALL | changes)


def job(
    of: Design | None = None,
    printer: dict[str, Any] | None = None,
    shape: Shape | None = None,
    any_size: bool = False,
    **settings: Any,
) -> Job:
    """A job for the paper's printer, with some of its entries changed."""
    machine = load_printer("ultimaker2")
    changed = type(machine).model_validate(machine.model_dump() | (printer or {}))
    return prepare(of or design(), changed, load_plastic("tpu95a"), ExportSettings(**settings), shape, any_size)


Run = Callable[..., Outcome]
