"""The plan of a small law: one material, and the sizes that the stars of one design have."""

from __future__ import annotations

import math

import numpy as np

from homogenize.law.hermite_grid import Floats
from homogenize.law.law import WITHOUT_BENDING
from homogenize.law.material import Material
from homogenize.law.plan import MIN_CELL_EDGE_MM
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.design.stars import MIN_ARM_MM, THICKNESS_RANGE_MM, WIDTH_RANGE_MM

# of cells along an arm's spacing, as in the law that comes with the package: edges of 1.15 mm for the paper's lattice
EDGES_PER_SPACING = 15
# from one cell to the next, as in that law or closer: lengths are whole numbers of edges, the others grow by a factor
THICKNESS_NODE_RATIO, WIDTH_NODE_RATIO = 1.2, 1.3
# random cells that test a law of more than one size
HELD_OUT_CELLS = 4


def plan_for_sizes(design: Design, sizes: Floats, edge_mm: float | None = None) -> Material:
    """The material of a design, with cells that its stars lie between.

    Parameters
    ----------
    sizes : (S, 3) mm, length, thickness and width of its stars.
    edge_mm : of the cells' mesh; by default a fifteenth of the spacing, or the shortest that a plan may have.

    Raises
    ------
    DesignError
        There is no star, or the law cannot hold the material.
    """
    if len(sizes) == 0:
        raise DesignError("stars", "must be at least one: bare fabric needs no law")
    if not np.isfinite(sizes).all():
        raise DesignError("stars", "must have sizes that are finite numbers")
    if not design.fabric.has_bending:
        raise DesignError("fabric.bending", WITHOUT_BENDING, design.fabric.bending)
    sx, sy = design.fabric.stretch_xy
    if not math.isclose(sx, sy):
        raise DesignError("fabric.stretch", "must be one number: cells are stretched alike in x and y", [sx, sy])
    spacing = design.lattice.spacing_mm
    edge = edge_mm or max(round(spacing / EDGES_PER_SPACING, 4), MIN_CELL_EDGE_MM)
    length, thickness, width = sizes.T
    nodes = {
        "lengths_mm": _lengths(np.clip(length, MIN_ARM_MM, spacing), spacing),
        "thicknesses_mm": _growing(np.clip(thickness, *THICKNESS_RANGE_MM), THICKNESS_NODE_RATIO),
        "widths_mm": _growing(np.clip(width, *WIDTH_RANGE_MM), WIDTH_NODE_RATIO),
    }
    one = all(len(each) == 1 for each in nodes.values())
    data = design.to_dict()
    return Material.from_dict(
        {
            "name": design.name,
            "fabric": data["fabric"] | {"stretch": sx},
            "plastic": data["plastic"],
            "lattice": {key: value for key, value in data["lattice"].items() if key != "origin_mm"},
            "plan": nodes | {"edge_mm": edge, "held_out": 0 if one else HELD_OUT_CELLS},
        }
    )


def _lengths(values: Floats, spacing: float) -> list[float]:
    """From the least to the largest in steps of a fifteenth of the spacing, where cells cost least."""
    low, high = _ends(values)
    step = spacing / EDGES_PER_SPACING
    inner = [
        round(n * step, 4) for n in range(1, EDGES_PER_SPACING + 1) if low + 0.3 * step < n * step < high - 0.3 * step
    ]
    return _increasing([low, *inner, min(high, spacing)])


def _growing(values: Floats, factor: float) -> list[float]:
    """From the least to the largest in equal ratios."""
    low, high = _ends(values)
    steps = math.ceil(math.log(high / low) / math.log(factor) - 1e-9) or 1
    return _increasing([low, *(round(low * (high / low) ** (n / steps), 4) for n in range(1, steps)), high])


def _ends(values: Floats) -> tuple[float, float]:
    """Rounded outwards to a thousandth; equal ones stay equal, and lose what rounding has added."""
    low, high = (float(end) for end in (values.min(), values.max()))
    if high - low < 1e-9 * high:
        return round(high, 9), round(high, 9)
    return math.floor(low * 1e3 + 1e-6) / 1e3, math.ceil(high * 1e3 - 1e-6) / 1e3


def _increasing(nodes: list[float]) -> list[float]:
    return sorted(set(nodes))
