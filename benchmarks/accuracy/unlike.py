"""Designs unlike those of the study: other outlines, and other ways to be held, the same ones every time.

L, ring segment, ellipse, triangle and cross beside hexagons and rectangles; single sides, sides that slide, corners
that slide, are raised, or take hold late; sizes that rise and fall over the sheet; stars left out.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.pattern.design.design import Design
from benchmarks.accuracy.designs import EDGE_MM, STARS
from benchmarks.accuracy.printable import printable


def unlike(count: int, edge_mm: float = EDGE_MM) -> list[Design]:
    """As many designs, with the mesh's edge in mm."""
    return [_drawn(seed, edge_mm) for seed in range(count)]


def _drawn(seed: int, edge_mm: float) -> Design:
    rng = np.random.default_rng([21, seed])
    return printable(lambda: _draw(rng, f"unlike-{seed:02d}", edge_mm), STARS)


def _draw(rng: np.random.Generator, name: str, edge_mm: float) -> dict[str, Any]:
    border = _border(rng)
    sides = 6 if "rings" in border else 4 if "rectangle_mm" in border else len(border["polygon_mm"])
    stars = {
        "length_mm": _field(rng, 4.0, 11.0),
        "thickness_mm": _field(rng, 0.25, 0.55),
        "width_mm": round(float(rng.uniform(0.9, 1.5)), 2),
    }
    if rng.random() < 0.2:
        stars["override"] = [{"star": int(star), "remove": True} for star in rng.choice(6, 2, replace=False)]
    return {
        "name": name,
        "fabric": {"stretch": float(rng.choice([1.35, 1.75]))},
        "stars": stars,
        "border": border,
        "pins": _pins(rng, sides),
        "mesh": {"edge_mm": edge_mm},
    }


def _border(rng: np.random.Generator) -> dict[str, Any]:
    kinds = [_hexagon, _rectangle, _angle, _ring_segment, _ellipse, _triangle, _cross]
    return dict(kinds[int(rng.integers(len(kinds)))](rng))


def _hexagon(rng: np.random.Generator) -> dict[str, Any]:
    return {"rings": int(rng.integers(2, 4))}


def _rectangle(rng: np.random.Generator) -> dict[str, Any]:
    return {"rectangle_mm": [round(float(rng.uniform(60, 170)), 1), round(float(rng.uniform(50, 130)), 1)]}


def _polygon(points: Any) -> dict[str, Any]:
    return {"polygon_mm": np.round(np.asarray(points), 1).tolist()}


def _angle(rng: np.random.Generator) -> dict[str, Any]:
    (a, b), (c, d) = rng.uniform(45, 70, 2), rng.uniform(45, 65, 2)
    return _polygon([[-a, -b], [a, -b], [a, d - b], [c - a, d - b], [c - a, b], [-a, b]])


def _ring_segment(rng: np.random.Generator) -> dict[str, Any]:
    inner = rng.uniform(30, 50)
    outer, half = inner + rng.uniform(45, 65), np.radians(rng.uniform(45, 100))
    along = np.linspace(-half, half, 14)
    ring = np.column_stack([np.cos(along), np.sin(along)])
    return _polygon(np.concatenate([outer * ring, inner * ring[::-1]]))


def _ellipse(rng: np.random.Generator) -> dict[str, Any]:
    along = 2.0 * np.pi * np.arange(28) / 28
    return _polygon(np.column_stack([rng.uniform(40, 80) * np.cos(along), rng.uniform(35, 60) * np.sin(along)]))


def _triangle(rng: np.random.Generator) -> dict[str, Any]:
    """Cut at its tip, more or less."""
    base, height, tip = rng.uniform(55, 85), rng.uniform(40, 65), rng.uniform(1, 30)
    return _polygon([[-base, -height], [base, -height], [tip, height], [-tip, height]])


def _cross(rng: np.random.Generator) -> dict[str, Any]:
    a, w = rng.uniform(50, 75), rng.uniform(20, 30)
    corner = np.array([[w, -a], [w, -w], [a, -w]])
    turns = [np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]]) for t in np.pi / 2 * np.arange(4)]
    return _polygon(np.concatenate([corner @ turn.T for turn in turns]))


def _field(rng: np.random.Generator, low: float, high: float) -> Any:
    """A number, from one value to another outwards or along a direction, or a wave."""
    one, other = (round(float(value), 3) for value in rng.uniform(low, high, 2))
    kind = int(rng.integers(4))
    if kind == 0:
        return one
    if kind == 1:
        power = float(rng.choice([0.5, 1.0, 2.0]))
        return {"profile": "radial", "from": one, "to": other, "over_mm": 70.0, "power": power}
    if kind == 2:
        angle = rng.uniform(0.0, 2.0 * np.pi)
        end = np.round(70.0 * np.array([np.cos(angle), np.sin(angle)]), 1)
        return {"profile": "linear", "from": one, "to": other, "start_mm": (-end).tolist(), "end_mm": end.tolist()}
    rate, lean, begin = 2 * np.pi / rng.uniform(60, 140), rng.uniform(-0.7, 0.7), rng.uniform(0, 6)
    middle, half = (one + other) / 2, abs(one - other) / 2
    return {"formula": f"{middle:.3f} + {half:.3f}*sin({rate:.4f}*(x + {lean:.2f}*y) + {begin:.2f})"}


def _pins(rng: np.random.Generator, sides: int) -> list[dict[str, Any]]:
    scale = round(float(rng.uniform(0.62, 0.95)), 3)
    one, other = (int(side) for side in rng.choice(sides, 2, replace=False))
    apart = abs(one - other) not in (1, sides - 1)
    slides = [{"edges": [other], "scale": scale, "slide": "plane"}] if apart else []
    raised = {"corners": list(range(1, sides, 2)), "scale": scale, "offset_mm": [0.0, 0.0, float(rng.integers(5, 30))]}
    ways: list[list[dict[str, Any]]] = [
        [],
        [],
        [{"where": "border", "scale": scale}],
        [{"where": "corners", "scale": scale}],
        [{"edges": sorted([one, other]), "scale": scale}],
        [{"edges": [one], "scale": scale}, *slides],
        [{"where": "corners", "scale": scale, "step": 1}],
        [{"where": "corners", "slide": "plane"}],
        [{"corners": list(range(0, sides, 2)), "scale": scale}, raised],
    ]
    return ways[int(rng.integers(len(ways)))]
