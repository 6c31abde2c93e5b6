"""Supported sheets on few needles, the same ones every time: canopies, and other outlines and supports."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.pattern.design.design import Design
from benchmarks.accuracy.designs import EDGE_MM
from benchmarks.accuracy.printable import printable

CANOPY_MM = [200.0, 140.0]
CANOPY_SCALES = (0.6, 0.65, 0.7, 0.75, 0.8, 0.9)
CANOPY_THICKNESSES_MM = (0.3, 0.4)
OTHERS = 20  # designs beside the canopies
STARS_OF_OTHERS = (12, 45)  # fewest and most


def canopies(edge_mm: float = EDGE_MM) -> list[Design]:
    """Rectangles of equal stars with arms of 8 mm on needles at their four corners."""
    return [
        Design.from_dict(
            {
                "name": f"canopy-s{scale:g}-h{thickness:g}",
                "stars": {"length_mm": 8.0, "thickness_mm": thickness},
                "border": {"rectangle_mm": CANOPY_MM},
                "pins": [{"where": "corners", "scale": scale}],
                "mesh": {"edge_mm": edge_mm},
            }
        )
        for thickness in CANOPY_THICKNESSES_MM
        for scale in CANOPY_SCALES
    ]


def other_held(count: int, edge_mm: float = EDGE_MM) -> list[Design]:
    """As many designs: circle, L, T, ellipse and trapezoid in turn, each with one of five ways of support."""
    return [_drawn(seed, edge_mm) for seed in range(count)]


def _drawn(seed: int, edge_mm: float) -> Design:
    """Drawn again until it can be printed and its number of stars is within `STARS_OF_OTHERS`."""
    rng = np.random.default_rng([22, seed])

    def draw() -> dict[str, Any]:
        outline = OUTLINES[seed % len(OUTLINES)](rng)
        data: dict[str, Any] = {
            "name": f"held-{seed:02d}",
            "stars": {"length_mm": _field(rng, 6.0, 10.0), "thickness_mm": round(float(rng.uniform(0.28, 0.45)), 2)},
            "border": {"polygon_mm": np.round(outline, 1).tolist()},
            "mesh": {"edge_mm": edge_mm},
        }
        return data | drawn_supports(rng, outline, (seed // len(OUTLINES) + seed) % 5)

    return printable(draw, STARS_OF_OTHERS)


def _circle(rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(45, 65) * _unit_circle()


def _ellipse(rng: np.random.Generator) -> np.ndarray:
    return _unit_circle() * [rng.uniform(60, 80), rng.uniform(35, 50)]


def _unit_circle() -> np.ndarray:
    angle = 2.0 * np.pi * np.arange(24) / 24
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _l_shape(rng: np.random.Generator) -> np.ndarray:
    (a, b), (c, d) = rng.uniform(50, 70, 2), rng.uniform(45, 65, 2)
    return np.array([[-a, -b], [a, -b], [a, d - b], [c - a, d - b], [c - a, b], [-a, b]])


def _t_shape(rng: np.random.Generator) -> np.ndarray:
    a, bar, stem = rng.uniform(55, 75), rng.uniform(40, 50), rng.uniform(22, 30)
    low, high = -rng.uniform(45, 65), 45.0
    return np.array(
        [[-stem, low], [stem, low], [stem, high - bar], [a, high - bar], [a, high], [-a, high], [-a, high - bar],
         [-stem, high - bar]]
    )  # fmt: skip


def _trapezoid(rng: np.random.Generator) -> np.ndarray:
    base, top, height = rng.uniform(60, 80), rng.uniform(30, 55), rng.uniform(40, 55)
    return np.array([[-base, -height], [base, -height], [top, height], [-top, height]])


OUTLINES = (_circle, _l_shape, _t_shape, _ellipse, _trapezoid)


def _field(rng: np.random.Generator, low: float, high: float) -> Any:
    """A number, or from one value to another outwards."""
    one, other = (round(float(value), 2) for value in rng.uniform(low, high, 2))
    if rng.random() < 0.5:
        return one
    return {"profile": "radial", "from": one, "to": other, "over_mm": 70.0}


def drawn_supports(rng: np.random.Generator, outline: np.ndarray, kind: int) -> dict[str, Any]:
    """Three needles, four to six, lifted ones, two edges moved together, or one edge under weight."""
    scale, corners = round(float(rng.uniform(0.65, 0.9)), 2), len(outline)
    needles = 3 if kind == 0 else min(int(rng.integers(4, 7)), corners)
    chosen = np.unique(np.rint(np.linspace(0, corners, needles, endpoint=False) + rng.uniform(0, 1)).astype(int))
    numbers = (chosen % corners).tolist()
    if kind < 2:
        return {"pins": [{"corners": numbers, "scale": scale}]}
    if kind == 2:
        lifted = {"corners": numbers[1::2], "scale": scale, "offset_mm": [0.0, 0.0, float(rng.integers(8, 30))]}
        return {"pins": [{"corners": numbers[::2], "scale": scale}, lifted]}
    if kind == 3:
        edges = [{"edges": list(range(first, first + corners // 4))} for first in (0, corners // 2)]
        return {"pins": [edge | {"scale": scale} for edge in edges]}
    weight = {"gravity": {"on": True}, "fabric": {"modulus_mpa": 7.1875}}
    return {"pins": [{"edges": list(range(corners // 4)), "scale": scale}]} | weight
