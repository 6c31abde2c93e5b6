"""Where a sheet is covered by its motif, and where its fabric is bare.

In an endless pattern no place is farther from a rod than a certain reach: half the distance of parallel lines. A rim is
as wide as that, or narrower, wherever the outline cuts the pattern; it belongs to the motif, as the fabric between rods
does. Beyond, the sheet turns to bare fabric over half of that reach, since the shell's fields have no jumps.
"""

from __future__ import annotations

import numpy as np
import shapely

from equilibrium.arrays import Floats
from pattern.design.design import Design
from pattern.layout.layout import Layout
from pattern.rods.curves import polyline

# points along each lattice vector at which the endless pattern is sampled
SAMPLES = 40
# copies of the motif on each side of a cell
COPIES = 2
# of the reach, over which the sheet turns to bare fabric
TURN_SHARE = 0.5


def reach_mm(design: Design) -> float:
    """Largest distance of a place of the endless pattern from its nearest rod.

    Examples
    --------
    >>> lines = Design.from_dict({
    ...     "rods": {"motif": [{"line_mm": [(0, 0), (5, 0)]}]}, "lattice": {"kind": "square", "spacing_mm": 5.0},
    ...     "border": {"rectangle_mm": (40, 40)},
    ... })
    >>> reach_mm(lines)
    2.5
    """
    vectors = np.asarray(design.lattice.vectors)
    steps = np.arange(-COPIES, COPIES + 1)
    shifts = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    lines = [polyline(line, design.required_rods.curve_mm) for line in design.required_rods.motif]
    drawn = shapely.MultiLineString([line + shift for shift in shifts for line in lines])
    parts = np.arange(SAMPLES) / SAMPLES
    places = np.stack(np.meshgrid(parts, parts, indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    return float(shapely.distance(drawn, shapely.points(places)).max())


def bare_share(layout: Layout, reach: float, points: Floats) -> Floats:
    """(n,) from 0 in the pattern to 1 on bare fabric, at printed points (n, 2) mm."""
    drawn = shapely.MultiLineString([rod.points for rod in layout.graph.rods])
    shapely.prepare(drawn)
    away = shapely.distance(drawn, shapely.points(points))
    return np.asarray(np.clip((away - reach) / (TURN_SHARE * reach), 0.0, 1.0))
