"""Into how many mesh edges the arms of a cell are cut: a mean of two meshes where their length is between two numbers.

The grid of a cell has a whole number of edges between stars. An arm that is not a whole number of edges long is cut
into one more or one less, and the mesh is distorted to meet its end. Either changes the answers by a few percent, in
opposite senses. The mean of both, weighted by nearness, has no jumps and nearly no kinks over the length of the arms.
A free mesh has no grid to be distorted: its arms are cut into the nearest number.
"""

from __future__ import annotations

import math

import numpy as np

from homogenize.cell.aligned_cell_mesh import edges_per_spacing
from homogenize.cell.cell_mesh import lattice_lines, star_size
from pattern.design.design import Design

# of an edge, by which an arm may miss a whole number of edges without a second mesh
WHOLE_EDGE_TOLERANCE = 1e-3


def arm_segments(design: Design, edge_mm: float) -> tuple[tuple[int, float], ...]:
    """One or two (number of edges, weight); the weights add up to 1."""
    vectors = np.asarray(design.lattice.vectors)
    length, on_lines = star_size(design, "length_mm"), lattice_lines(design.lattice)
    if on_lines is None:
        return ((max(1, round(length / edge_mm)), 1.0),)
    k = edges_per_spacing(vectors, on_lines, np.full(len(on_lines), length), edge_mm)
    edge = float(np.linalg.norm(vectors, axis=1).min()) / k
    cut = length / edge
    low = math.floor(cut + WHOLE_EDGE_TOLERANCE)
    if low < 1:
        return ((1, 1.0),)
    above = max(cut - low, 0.0)
    # where arms come from both ends of a link, none reaches its middle unless they meet
    most = k - 1 if design.lattice.arms == 3 else (k - 1) // 2
    if above < WHOLE_EDGE_TOLERANCE or low + 1 > most:
        return ((low, 1.0),)
    return ((low, 1.0 - above), (low + 1, above))
