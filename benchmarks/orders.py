"""Orders of convergence and limits that the mesh study shows, by least squares over its finer meshes."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import least_squares

ASYMPTOTIC = 1.5  # mm: orders are fitted to edges up to this
LEAST, LARGEST = 0.2, 4.0  # orders that are looked for


def rates(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Order p and limit of `value = limit + c edge^p` for energy and size, and % of the surface error at edge 1 mm.

    The distance to the finest mesh is fitted by `c (edge^p - finest^p)`, which is what an error `c edge^p` leaves.
    """
    rows = [r for r in rows if r["mesh"]["edge_mm"] < ASYMPTOTIC]
    edge = np.array([r["mesh"]["edge_mm"] for r in rows])
    out: dict[str, float] = {}
    for name in ("stars_percent", "surface_percent"):
        value = np.array([r[name] for r in rows])

        def residual(a: np.ndarray, value: np.ndarray = value) -> np.ndarray:
            return np.exp(a[0]) * (edge ** a[1] - edge.min() ** a[1]) - value

        c, p = least_squares(residual, [0.0, 1.0], bounds=([-9.0, LEAST], [5.0, LARGEST])).x
        out[name], out[name + "_at_1mm"] = float(p), float(np.exp(c))
        out[name + "_edge_mm"] = float((1.0 / np.exp(c)) ** (1.0 / p))
    for name in ("energy_n_mm", "radius_mm" if rows[0]["radius_mm"] is not None else "height_mm"):
        out[name], out[name + "_limit"] = _limit(edge, np.array([r[name] for r in rows]))
    return out


def _limit(edge: np.ndarray, value: np.ndarray) -> tuple[float, float]:
    scale = value.mean()
    fit = least_squares(
        lambda a: (a[0] - 1.0) + a[1] * edge ** a[2] - (value / scale - 1.0),
        [1.0, 0.01, 1.0],
        bounds=([0.0, -1.0, LEAST], [2.0, 1.0, LARGEST]),
    )
    if not 0.1 < fit.x[0] < 1.9:  # the end of its range: a straight line fits as well
        return LEAST, np.nan
    return float(fit.x[2]), float(fit.x[0] * scale)


def observed(order: float) -> bool:
    """The fit found the order, and not the end of its range."""
    return 1.05 * LEAST < order < 0.98 * LARGEST
