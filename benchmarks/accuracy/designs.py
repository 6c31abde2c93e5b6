"""The designs of the study: the gallery, and designs drawn at random, the same ones every time."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from benchmarks.accuracy.printable import printable

RANDOM = 24
STARS = (12, 64)  # fewest and most
EDGE_MM = 17.3205 / 15.0


def designs(edge_mm: float = EDGE_MM) -> list[Design]:
    """Gallery first; all with the mesh's edge in mm that is asked for."""
    return [meshed(gallery.load(name), edge_mm) for name in gallery.names()] + [
        drawn(seed, edge_mm) for seed in range(RANDOM)
    ]


# mm, lengths and thicknesses of equal stars on rectangles of two sides, and on hexagons of some rings
RECTANGLES = [
    (70, 62, 8, 0.35), (70, 62, 8, 0.3), (70, 62, 8, 0.5), (90, 70, 9, 0.4), (90, 70, 6, 0.3), (90, 70, 7, 0.35),
    (100, 40, 8, 0.35), (100, 75, 7, 0.4), (60, 100, 8, 0.35), (130, 100, 7, 0.3), (120, 90, 10, 0.4),
    (100, 85, 8, 0.35),
]  # fmt: skip
HEXAGONS = [
    (2, 8, 0.35), (2, 6, 0.3), (1, 8, 0.3), (1, 8, 0.35), (2, 7, 0.4), (3, 6, 0.3), (2, 10, 0.4), (1, 10, 0.4),
]  # fmt: skip
RIBBONS = [
    (100, 20, 6, 0.3), (100, 36, 8.5, 0.35), (160, 20, 8.5, 0.35), (160, 36, 6, 0.3), (160, 52, 6, 0.3),
    (160, 52, 8.5, 0.35), (160, 70, 6, 0.3), (220, 36, 6, 0.3),
]  # fmt: skip


def ribbons(edge_mm: float = EDGE_MM) -> list[Design]:
    """Free rectangles of one to four rows of equal stars."""
    return [_equal(f"{x}x{y}", {"rectangle_mm": [float(x), float(y)]}, *stars, edge_mm) for x, y, *stars in RIBBONS]


def even(edge_mm: float = EDGE_MM) -> list[Design]:
    """Small free sheets of equal stars, as one would try first."""
    rectangles = [
        _equal(f"{x}x{y}", {"rectangle_mm": [float(x), float(y)]}, *stars, edge_mm) for x, y, *stars in RECTANGLES
    ]
    return rectangles + [_equal(f"rings{rings}", {"rings": rings}, *stars, edge_mm) for rings, *stars in HEXAGONS]


def _equal(name: str, border: dict[str, Any], length: float, thickness: float, edge_mm: float) -> Design:
    stars = {"length_mm": float(length), "thickness_mm": thickness}
    data = {"name": f"{name}-l{length}-h{thickness}", "border": border, "stars": stars}
    return Design.from_dict(data | {"mesh": {"edge_mm": edge_mm}})


def drawn(seed: int, edge_mm: float = EDGE_MM) -> Design:
    """A design at random: outline, stretch, length and thickness over the sheet, width, and how it is held.

    Drawn again until it can be printed and has a number of stars within `STARS`.
    """
    rng = np.random.default_rng([20, seed])
    named = {"name": f"random-{seed:02d}", "mesh": {"edge_mm": edge_mm}}
    return printable(lambda: _draw(rng) | named, STARS)


def _draw(rng: np.random.Generator) -> dict[str, Any]:
    stretch = 1.35 if rng.random() < 0.7 else 1.75
    border, size = _border(rng)
    sizes = {
        "length_mm": size_field(rng, 4.0, 11.0, size),
        "thickness_mm": size_field(rng, 0.25, 0.55, size),
        "width_mm": round(float(rng.uniform(0.9, 1.5)), 2),
    }
    return {"fabric": {"stretch": stretch}, "stars": sizes, "border": border, "pins": _pins(rng, stretch)}


def _border(rng: np.random.Generator) -> tuple[dict[str, Any], float]:
    """An outline, and how far it reaches from the middle, mm."""
    kind = rng.integers(3)
    if kind == 0:
        rings = int(rng.integers(2, 4))
        return {"rings": rings}, 17.32 * rings
    if kind == 1:
        sides = [round(float(side), 1) for side in rng.uniform(80.0, 150.0, 2)]
        return {"rectangle_mm": sides}, 0.5 * max(sides)
    corners = int(rng.integers(4, 8))
    angle = 2.0 * np.pi * (np.arange(corners) + rng.uniform(-0.25, 0.25, corners)) / corners
    radius = rng.uniform(50.0, 75.0, corners)
    polygon = np.round(radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]), 1)
    return {"polygon_mm": polygon.tolist()}, float(radius.max())


def size_field(rng: np.random.Generator, low: float, high: float, size: float) -> Any:
    """A number, or from one value to another: from the middle outwards, or along a direction."""
    one, other = (round(float(value), 3) for value in rng.uniform(low, high, 2))
    kind = rng.random()
    if kind < 0.35:
        return one
    if kind < 0.7:
        power = float(rng.choice([0.5, 1.0, 2.0]))
        return {"profile": "radial", "from": one, "to": other, "over_mm": round(size, 1), "power": power}
    angle = rng.uniform(0.0, 2.0 * np.pi)
    end = np.round(size * np.array([np.cos(angle), np.sin(angle)]), 1)
    return {"profile": "linear", "from": one, "to": other, "start_mm": (-end).tolist(), "end_mm": end.tolist()}


def _pins(rng: np.random.Generator, stretch: float) -> list[dict[str, Any]]:
    """Free in half of the designs; else the border or all corners are held, somewhat apart or near to each other."""
    kind = rng.random()
    scale = round(float(rng.uniform(1.0, 1.15) / stretch), 3)
    if kind < 0.5:
        return []
    return [{"where": "border" if kind < 0.75 else "corners", "scale": scale}]


def meshed(design: Design, edge_mm: float) -> Design:
    """The design with another edge length of its mesh."""
    data = design.to_dict()
    return Design.from_dict(data | {"mesh": data["mesh"] | {"edge_mm": edge_mm}})
