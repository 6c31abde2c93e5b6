"""Designs whose motif repeats: lines, nets, waves, and stars written as rods."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import Lattice

Line = dict[str, Any]
Pattern = tuple[list[Line], dict[str, Any]]  # motif and lattice

HEIGHT = 4.5  # half of a rhomb
HALF_WIDTH = 9.0 * np.cos(np.pi / 6)


def lines(*points: Sequence[Sequence[float]]) -> list[Line]:
    return [{"line_mm": [tuple(map(float, point)) for point in line]} for line in points]


def parallel(distance: float = 5.0) -> Pattern:
    return lines([(0, 0), (distance, 0)]), {"kind": "square", "spacing_mm": distance}


def grid(distance: float = 10.0) -> Pattern:
    return lines([(0, 0), (distance, 0)], [(0, 0), (0, distance)]), {"kind": "square", "spacing_mm": distance}


def diamonds() -> Pattern:
    vectors = [(HALF_WIDTH, HEIGHT), (HALF_WIDTH, -HEIGHT)]
    return lines(*([(0, 0), vector] for vector in vectors)), {"kind": "custom", "vectors_mm": vectors}


def waves() -> Pattern:
    places = np.linspace(0.0, 20.0, 17)
    spline = [(float(x), float(2.0 * np.sin(0.1 * np.pi * x))) for x in places]
    return [{"spline_mm": spline}], {"kind": "custom", "vectors_mm": [(20, 0), (0, 8)]}


def honeycomb(side: float = 10.0) -> Pattern:
    up = side * np.sqrt(0.75)
    ends = [(0.5 * side, up), (0.5 * side, -up), (-side, 0)]
    vectors = [(1.5 * side, up), (1.5 * side, -up)]
    return lines(*([(0, 0), end] for end in ends)), {"kind": "custom", "vectors_mm": vectors}


def stars(length: float = 10.0) -> Pattern:
    return lines(*([(0, 0), length * arm] for arm in Lattice().arm_directions)), {}


def moved(pattern: Pattern, shift: Sequence[float]) -> Pattern:
    """The pattern with its motif elsewhere in the lattice."""
    motif, lattice = pattern
    return [
        {key: [(x + shift[0], y + shift[1]) for x, y in points] for key, points in line.items()} for line in motif
    ], lattice


def motif_design(pattern: Pattern, thickness: float = 0.4, **more: Any) -> Design:
    motif, lattice = pattern
    rods = {"motif": motif, "thickness_mm": thickness}
    sheet = {"rods": rods, "lattice": lattice, "border": {"rectangle_mm": (60, 60)}, "fabric": {"bending": "paper"}}
    return Design.from_dict(sheet | more)
