"""The plan of a small law: the material of one design, and unit cells around the sizes of its stars."""

from __future__ import annotations

import math

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.point_group import aligned_lines
from asterism.homogenize.law.axes import AXES, Axis
from asterism.homogenize.law.law import WITHOUT_BENDING
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.plan import MIN_CELL_EDGE_MM
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError

# mesh edges between adjacent stars, as in the paper's law, whose edges are 1.15 mm long
EDGES_PER_SPACING = 15
# longest edge of a graded cell, over the spacing
MAX_GRADED_EDGE_SPACINGS = 1 / 5
# random cells that test a law of more than one size
HELD_OUT_CELLS = 4
# of a mesh edge: nodes between the shortest and the longest arms keep this distance from both
MIN_NODE_DISTANCE = 0.3


def plan_for_sizes(design: Design, sizes: Floats, edge_mm: float | None = None) -> Material:
    """The material of a design, with unit cells whose sizes enclose those of its stars.

    Parameters
    ----------
    sizes : (S, A) of the stars, in the order of `homogenize.law.axes.AXES`, see `law_coordinates` there.
    edge_mm : of the cells' mesh; by default that of a graded design (at most `MAX_GRADED_EDGE_SPACINGS`), and else a
        fifteenth of the spacing, at least `MIN_CELL_EDGE_MM`. Cells are graded if the design is and they can be.

    Raises
    ------
    DesignError
        The design has no star, or its material has no law.
    """
    if len(sizes) == 0:
        raise DesignError("stars", "must be at least one: bare fabric needs no law")
    if not np.isfinite(sizes).all():
        raise DesignError("stars", "must have sizes that are finite numbers")
    if not design.fabric.has_bending:
        raise DesignError("fabric.bending", WITHOUT_BENDING, design.fabric.bending)
    sx, sy = design.fabric.stretch_xy
    if not math.isclose(sx, sy):
        raise DesignError("fabric.stretch", "must be one number: unit cells have equal stretch in x and y", [sx, sy])
    spacing = design.lattice.spacing_mm
    graded = design.graded_meshes and aligned_lines(design.lattice) is not None
    own = min(design.usual_edge_mm, spacing * MAX_GRADED_EDGE_SPACINGS) if graded else spacing / EDGES_PER_SPACING
    edge = edge_mm or max(round(own, 4), MIN_CELL_EDGE_MM)
    nodes = {axis.nodes_key: _nodes(axis, column, spacing) for axis, column in zip(AXES, sizes.T, strict=True)}
    single = all(len(each) == 1 for each in nodes.values())
    data = design.to_dict()
    return Material.from_dict(
        {
            "name": design.name,
            "fabric": data["fabric"] | {"stretch": sx},
            "plastic": data["plastic"],
            "lattice": {key: value for key, value in data["lattice"].items() if key != "origin_mm"},
            "plan": nodes | {"edge_mm": edge, "graded": graded, "held_out": 0 if single else HELD_OUT_CELLS},
        }
    )


def _nodes(axis: Axis, sizes: Floats, spacing: float) -> list[float]:
    """Increasing nodes of an axis that enclose these sizes (S,) of the stars."""
    low, high = axis.limits
    if axis.node_ratio is not None:
        return geometric_nodes(np.clip(sizes, low, high), axis.node_ratio)
    return _length_nodes(np.clip(sizes, low, spacing), spacing)


def _length_nodes(lengths: Floats, spacing: float) -> list[float]:
    """From the shortest to the longest arms in steps of a fifteenth of the spacing: these cells need one mesh only."""
    low, high = _ends(lengths)
    step = spacing / EDGES_PER_SPACING
    margin = MIN_NODE_DISTANCE * step
    steps = (n for n in range(1, EDGES_PER_SPACING + 1) if low + margin < n * step < high - margin)
    return sorted({low, *(round(n * step, 4) for n in steps), min(high, spacing)})


def geometric_nodes(sizes: Floats, max_ratio: float) -> list[float]:
    """From the smallest to the largest of sizes (S,) in equal ratios, each at most `max_ratio`.

    Examples
    --------
    >>> geometric_nodes(np.array([0.3, 0.45, 0.38]), 1.3)
    [0.3, 0.3674, 0.45]
    """
    low, high = _ends(sizes)
    steps = math.ceil(math.log(high / low) / math.log(max_ratio) - 1e-9) or 1
    return sorted({low, *(round(low * (high / low) ** (n / steps), 4) for n in range(1, steps)), high})


def _ends(sizes: Floats) -> tuple[float, float]:
    """Smallest and largest size, rounded outwards to 0.001 mm; one size gives two equal ends without rounding noise."""
    low, high = (float(end) for end in (sizes.min(), sizes.max()))
    if high - low < 1e-9 * high:
        return round(high, 9), round(high, 9)
    return math.floor(low * 1e3 + 1e-6) / 1e3, math.ceil(high * 1e3 - 1e-6) / 1e3
