"""The number of mesh edges along the arms of a cell.

The grid of an aligned cell has a whole number of edges between stars. If an arm is not a whole number of edges long,
the mesh is distorted to meet its tip: the arm gets one edge more or one less. The two meshes change the answers by a
few percent, in opposite senses. The mean of both, weighted by nearness, is continuous and nearly smooth over the
length. A free mesh has no grid: its arms get the nearest number.
"""

from __future__ import annotations

import math

import numpy as np

from asterism.homogenize.cell.aligned_cell_mesh import edges_per_spacing
from asterism.homogenize.cell.aligned_lines import aligned_lines
from asterism.homogenize.cell.cell_mesh import star_size
from asterism.pattern.design.design import Design

# of an edge: an arm that is so near to a whole number of edges has one mesh
WHOLE_EDGE_TOLERANCE = 1e-3


def arm_segments(design: Design, edge_mm: float) -> tuple[tuple[int, float], ...]:
    """One or two pairs (number of edges, weight); the weights add up to 1.

    Examples
    --------
    >>> from asterism.pattern.design.design import Design
    >>> star = {"stars": {"length_mm": 9.0}, "border": {"rings": 1}}
    >>> [(n, round(w, 3)) for n, w in arm_segments(Design.from_dict(star), 2.0)]
    [(4, 0.323), (5, 0.677)]
    """
    vectors = np.asarray(design.lattice.vectors)
    length, on_lines = star_size(design, "length_mm"), aligned_lines(design.lattice)
    if on_lines is None:
        return ((max(1, round(length / edge_mm)), 1.0),)
    k = edges_per_spacing(vectors, on_lines, np.full(len(on_lines), length), edge_mm)
    edge = float(np.linalg.norm(vectors, axis=1).min()) / k
    cut = length / edge
    low = math.floor(cut + WHOLE_EDGE_TOLERANCE)
    if low < 1:
        return ((1, 1.0),)
    above = max(cut - low, 0.0)
    # arms from both ends of a lattice edge do not reach its middle unless they meet
    most = k - 1 if design.lattice.arms == 3 else (k - 1) // 2
    if above < WHOLE_EDGE_TOLERANCE or low + 1 > most:
        return ((low, 1.0),)
    return ((low, 1.0 - above), (low + 1, above))
