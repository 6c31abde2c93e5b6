"""Random drawings: lines, circles, waves and spirals on a square sheet."""

from __future__ import annotations

from typing import Any

import numpy as np

SIDE_MM = 90.0


def random_drawing(seed: int) -> dict[str, Any]:
    """Plain data of a design with 3 to 8 lines at random places."""
    rng = np.random.default_rng(seed)
    draw = [_line(rng, k) for k in range(rng.integers(3, 9))]
    rods = {"thickness_mm": 0.4, "width_mm": 1.2, "draw": draw}
    return {"rods": rods, "border": {"rectangle_mm": [SIDE_MM, SIDE_MM]}, "mesh": {"edge_mm": 3.0}}


def _line(rng: np.random.Generator, number: int) -> dict[str, Any]:
    """One of four kinds of line."""
    name, middle = f"line{number}", rng.uniform(-25.0, 25.0, 2)
    match rng.integers(4):
        case 0:
            return {"name": name, "line_mm": rng.uniform(-0.55 * SIDE_MM, 0.55 * SIDE_MM, (2, 2)).tolist()}
        case 1:
            return {"name": name, "circle_mm": {"centre": middle.tolist(), "radius": float(rng.uniform(5.0, 25.0))}}
        case 2:
            x = np.linspace(-40.0, 40.0, 12)
            y = middle[1] + rng.uniform(2.0, 8.0) * np.sin(x / rng.uniform(4.0, 10.0))
            return {"name": name, "spline_mm": np.column_stack([x, y]).tolist()}
        case _:
            t = np.linspace(0.0, 4.0 * np.pi, 24)
            r = 6.0 + rng.uniform(0.8, 2.0) * t
            return {"name": name, "spline_mm": (middle + r[:, None] * np.column_stack([np.cos(t), np.sin(t)])).tolist()}
