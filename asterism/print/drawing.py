"""A drawing to scale: lines, outlines, circles and texts on named layers, whatever file it becomes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pattern.geometry.arrays import Floats

# width and height of a page of A4 paper
A4_MM = (210.0, 297.0)
# widths of signs over the size of the font, none of them wider in common fonts
_WIDE, _USUAL = 1.15, 0.85


@dataclass(frozen=True)
class DrawingLayer:
    """How things are drawn.

    Attributes
    ----------
    name : as vector programs show it.
    colour : `#rrggbb`.
    width_mm : of the lines.
    dash_mm : lengths of dashes and gaps; empty for a full line.
    filled : closed lines are filled with the colour.
    meaning : for the legend; empty to leave it out.
    """

    name: str
    colour: str
    width_mm: float = 0.25
    dash_mm: tuple[float, ...] = ()
    filled: bool = False
    meaning: str = ""


@dataclass(frozen=True)
class Polyline:
    """Straight pieces through points (n, 2) mm; `holes` are further closed lines that a filled one leaves out."""

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
    """One line of text; `at` (2,) mm is on its baseline, at the given end of it."""

    layer: DrawingLayer
    at: Floats
    text: str
    size_mm: float = 3.5
    end: Literal["left", "middle"] = "left"
    bold: bool = False
    fixed_pitch: bool = False


@dataclass(frozen=True)
class Drawing:
    """A page of `low` to `high` (2,) mm with y upwards, at 1:1."""

    title: str
    low: Floats
    high: Floats
    items: tuple[Polyline | Circle | Label, ...]

    @property
    def size_mm(self) -> Floats:
        """(2,) width and height."""
        return self.high - self.low

    @property
    def layers(self) -> tuple[DrawingLayer, ...]:
        """The layers that are used, in the order of their first use."""
        return tuple(dict.fromkeys(item.layer for item in self.items))


def rectangle(layer: DrawingLayer, size_mm: tuple[float, float], centre: tuple[float, float] = (0.0, 0.0)) -> Polyline:
    """A closed rectangle about a centre."""
    half = np.asarray(size_mm) / 2
    return Polyline(layer, np.asarray(centre) + half * [[-1, -1], [1, -1], [1, 1], [-1, 1]], closed=True)


def cross_mark(layer: DrawingLayer, centre: Floats, arm_mm: float) -> list[Polyline]:
    """Two lines that cross at a point."""
    return [
        Polyline(layer, np.array([centre - arm, centre + arm]))
        for arm in (np.array([arm_mm, 0.0]), np.array([0, arm_mm]))
    ]


def offset_points(at: Floats, *offsets: tuple[float, float]) -> Floats:
    """Points (n, 2) at offsets in mm from a point, or (2,) for a single one."""
    points = np.asarray(at) + np.array(offsets)
    return np.asarray(points if len(offsets) > 1 else points[0])


def font_size_within(text: str, largest_mm: float, room_mm: float) -> float:
    """A size of bold text at which it is at most `room_mm` wide, whatever font: a long name is set small, not cut."""
    ems = sum(_WIDE if sign in "WMmw@%" or sign > "\u2e80" else _USUAL for sign in text)
    return min(largest_mm, room_mm / max(ems, 1.0))
