"""Drawings to scale, for all file formats: lines, outlines, circles and texts on named layers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from asterism.equilibrium.arrays import Floats

# width and height of a page of A4 paper
A4_MM = (210.0, 297.0)


@dataclass(frozen=True)
class DrawingLayer:
    """A layer of a drawing: name and style of its items."""

    name: str  # name in vector programs
    colour: str  # `#rrggbb`
    width_mm: float = 0.25  # width of lines
    dash_mm: tuple[float, ...] = ()  # lengths of dashes and gaps; empty for full lines
    filled: bool = False  # closed lines are filled with the colour
    # `width_mm` is that of a printed line; formats whose lines have no width by themselves store it
    is_printed_width: bool = False
    meaning: str = ""  # text in the legend; empty for no entry


@dataclass(frozen=True)
class Polyline:
    """Straight segments through points (n, 2) mm; `holes` are closed lines that a filled polyline leaves out."""

    layer: DrawingLayer
    points: Floats
    closed: bool = False
    holes: tuple[Floats, ...] = ()


@dataclass(frozen=True)
class Circle:
    """A circle about `centre` (2,) mm."""

    layer: DrawingLayer
    centre: Floats
    radius_mm: float


@dataclass(frozen=True)
class Label:
    """One line of text; `at` (2,) mm lies on its baseline, at the end `end`."""

    layer: DrawingLayer
    at: Floats
    text: str
    size_mm: float = 3.5
    end: Literal["left", "middle"] = "left"
    bold: bool = False
    fixed_pitch: bool = False


@dataclass(frozen=True)
class Drawing:
    """A page at 1:1 from `low` to `high` (2,) mm, with y upwards."""

    title: str
    low: Floats
    high: Floats
    items: tuple[Polyline | Circle | Label, ...]

    @property
    def size_mm(self) -> Floats:
        """(2,) mm, width and height."""
        return self.high - self.low

    @property
    def layers(self) -> tuple[DrawingLayer, ...]:
        """The layers of all items, in the order of their first use."""
        return tuple(dict.fromkeys(item.layer for item in self.items))


def rectangle(layer: DrawingLayer, size_mm: tuple[float, float], centre: tuple[float, float] = (0.0, 0.0)) -> Polyline:
    """A closed rectangle about a centre."""
    half = np.asarray(size_mm) / 2
    return Polyline(layer, np.asarray(centre) + half * [[-1, -1], [1, -1], [1, 1], [-1, 1]], closed=True)


def cross_mark(layer: DrawingLayer, centre: Floats, arm_mm: float) -> list[Polyline]:
    """A cross of two lines at a point."""
    return [
        Polyline(layer, np.array([centre - arm, centre + arm]))
        for arm in (np.array([arm_mm, 0.0]), np.array([0, arm_mm]))
    ]


def font_size_within(text: str, largest_mm: float, room_mm: float) -> float:
    """Size (mm) at which a bold text is at most `room_mm` wide in common fonts."""
    # largest widths of characters in common fonts, over the size of the font
    ems = sum(1.15 if sign in "WMmw@%" or sign > "\u2e80" else 0.85 for sign in text)
    return min(largest_mm, room_mm / max(ems, 1.0))


# layers that more than the sheets have
STARS = DrawingLayer("stars", "#3a3a44", filled=True, meaning="stars")
RODS = DrawingLayer("rods", STARS.colour, filled=True, meaning="printed lines")
CUT = DrawingLayer("cut", "#d01c1c", 0.25, meaning="cut here")
NEEDLES = DrawingLayer("needles", "#a0109a", 0.3, meaning="needles")
TEXT = DrawingLayer("text", "#26262b")
