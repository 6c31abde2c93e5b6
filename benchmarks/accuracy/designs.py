"""The designs of the study (the gallery, and designs at random) and sheets on few supports, the same every time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout

RANDOM = 24
STARS = (12, 64)  # fewest and most
EDGE_MM = 17.3205 / 15.0
CANOPY_MM = [200.0, 140.0]
CANOPY_SCALES = (0.6, 0.65, 0.7, 0.75, 0.8, 0.9)
CANOPY_THICKNESSES_MM = (0.3, 0.4)
OTHERS = 20  # designs beside the canopies
STARS_OF_OTHERS = (12, 45)  # fewest and most


def designs(edge_mm: float = EDGE_MM) -> list[Design]:
    """Gallery first; all with the mesh's edge in mm that is asked for."""
    return [meshed(gallery.load(name), edge_mm) for name in gallery.names()] + [
        drawn(seed, edge_mm) for seed in range(RANDOM)
    ]


def drawn(seed: int, edge_mm: float = EDGE_MM) -> Design:
    """A design at random: outline, stretch, length and thickness over the sheet, width, and how it is held."""
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


def printable(draw: Callable[[], dict[str, Any]], stars: tuple[int, int]) -> Design:
    """The first of the drawn tables that can be printed and has a number of stars from `stars[0]` to `stars[1]`."""
    while True:
        data = draw()
        try:
            design = Design.from_dict(data)
            if stars[0] <= len(layout(design).centres) <= stars[1]:
                return design
        except DesignError:
            continue


def canopies(edge_mm: float = EDGE_MM) -> list[Design]:
    """Rectangles of equal stars with arms of 8 mm on needles at their four corners."""
    sheet = {"border": {"rectangle_mm": CANOPY_MM}, "mesh": {"edge_mm": edge_mm}}
    return [
        Design.from_dict(
            sheet
            | {"name": f"canopy-s{scale:g}-h{thickness:g}", "pins": [{"where": "corners", "scale": scale}]}
            | {"stars": {"length_mm": 8.0, "thickness_mm": thickness}}
        )
        for thickness in CANOPY_THICKNESSES_MM
        for scale in CANOPY_SCALES
    ]


def other_held(edge_mm: float = EDGE_MM) -> list[Design]:
    """Circle, L, T, ellipse and trapezoid in turn, each with one of five ways of support."""
    return [_held(seed, edge_mm) for seed in range(OTHERS)]


def _held(seed: int, edge_mm: float) -> Design:
    """Drawn again until it can be printed and its number of stars is within `STARS_OF_OTHERS`."""
    rng = np.random.default_rng([22, seed])

    def draw() -> dict[str, Any]:
        outline = OUTLINES[seed % len(OUTLINES)](rng)
        data: dict[str, Any] = {
            "name": f"held-{seed:02d}",
            "stars": {
                "length_mm": _held_size(rng, 6.0, 10.0),
                "thickness_mm": round(float(rng.uniform(0.28, 0.45)), 2),
            },
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


def _held_size(rng: np.random.Generator, low: float, high: float) -> Any:
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
