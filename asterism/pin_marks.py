"""Where a sheet is held, as balls at points and tubes along sides."""

from __future__ import annotations

import numpy as np

from asterism.mesh_error import diameter
from asterism.shape import Shape
from pattern.build import layout
from pattern.design import Design
from pattern.errors import DesignError
from pattern.layout import Floats, Ints, PinSet

# over the diameter of the sheet
BALL, TUBE = 0.011, 0.0045
# rings of a ball, places around it and around a tube, and the longest part of a tube over its radius
RINGS, AROUND, LONG = 5, 8, 4.0

Marks = tuple[Floats, Floats, Ints]  # points (n, 3) mm, their normals, triangles (m, 3) with these to the outside


def pin_marks(shape: Shape) -> Marks:
    """The marks of a shape whose summary knows its design; none otherwise, and of free sheets."""
    parts: list[Marks] = [(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))]
    pins, border = _pins(shape) if shape.held else ((), np.empty((0, 2)))
    size = diameter(shape.positions) if pins else 0.0
    for pin in pins:
        if len(pin.points):
            parts += [_ball(place, BALL * size) for place in shape.at(pin.points)]
        corners = sorted({corner % len(border) for edge in pin.edges for corner in (edge, edge + 1)})
        parts += [_ball(place, TUBE * size) for place in shape.at(border[corners])] if corners else []
        for edge in pin.edges:
            ends = border[[edge, (edge + 1) % len(border)]]
            count = int(np.ceil(np.linalg.norm(ends[1] - ends[0]) / (LONG * TUBE * size))) + 1
            parts.append(_tube(shape.at(np.linspace(ends[0], ends[1], max(count, 2))), TUBE * size))
    points, normals, triangles = zip(*parts, strict=True)
    first = np.cumsum([0, *(len(part) for part in points)])
    numbered = [part + start for part, start in zip(triangles, first, strict=False)]
    return np.concatenate(points), np.concatenate(normals), np.concatenate(numbered)


def _pins(shape: Shape) -> tuple[tuple[PinSet, ...], Floats]:
    """The pins of the shape's design, and its border (B, 2) mm."""
    try:
        plan = layout(Design.from_dict(shape.summary["design"]))
    except (KeyError, TypeError, DesignError):  # a shape made by hand, or whose image of sizes is gone
        return (), np.empty((0, 2))
    return plan.pins, plan.border


def _ball(centre: Floats, radius: float) -> Marks:
    polar = np.linspace(0.0, np.pi, RINGS)
    circles = np.stack([np.outer(np.sin(polar), one) for one in _circle()] + [np.outer(np.cos(polar), np.ones(AROUND))])
    normals = circles.reshape(3, -1).T
    return centre + radius * normals, normals, _grid(RINGS)


def _tube(places: Floats, radius: float) -> Marks:
    """Around a line (k, 3) mm, open at its ends."""
    along = np.gradient(places, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    aside = np.cross(along, np.eye(3)[np.abs(along).max(axis=0).argmin()])
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
    cosine, sine = _circle()
    normals = aside[:, None] * cosine[:, None] + np.cross(aside, along)[:, None] * sine[:, None]
    return (places[:, None] + radius * normals).reshape(-1, 3), normals.reshape(-1, 3), _grid(len(places))


def _circle() -> tuple[Floats, Floats]:
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    return np.cos(angle), np.sin(angle)


def _grid(rows: int) -> Ints:
    """Two triangles between neighbours of `AROUND` points in each of so many rows, row by row."""
    here = np.arange((rows - 1) * AROUND)
    turned = here // AROUND * AROUND + (here + 1) % AROUND
    below = np.column_stack([here, here + AROUND, turned + AROUND])
    return np.concatenate([below, np.column_stack([here, turned + AROUND, turned])])
