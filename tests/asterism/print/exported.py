"""Files that an export writes, and the command that writes them."""

from __future__ import annotations

from collections.abc import Callable

from tests.asterism.commands import Outcome

Run = Callable[..., Outcome]

ALWAYS = {
    "border.stl",
    "export.json",
    "instructions.pdf",
    "instructions.txt",
    "layout.dxf",
    "layout.pdf",
    "layout.svg",
    "print.3mf",
    "rounded.toml",
    "stars.lua",
    "stars.scad",
    "stars.stl",
    "start.gcode",
}
PINNED = {"needles.csv", "needles.dxf", "needles.svg"}
SHAPE = {"shape.obj", "shape.stl", "shape.glb", "shape.vtu", "rods.vtu"}


def mistake(ended: Outcome) -> str:
    """The one line of a refused command."""
    assert ended.status == 2, ended.err
    return ended.line
