"""Points along a line of a cell's mesh, closer together where other arms are near."""

from __future__ import annotations

import math

import numpy as np

from asterism.equilibrium.arrays import Floats

# length of an edge, over the distance to the arms of other stars
MAX_EDGE_TO_GAP_RATIO = 1.5
# growth of the edges along a line, per distance
LINE_EDGE_GROWTH = 0.6
# of an edge: a line may lack so much to one edge more
EDGE_COUNT_SLACK = 0.25


def graded_steps(fine: Floats, longest: float, gap: Floats) -> Floats:
    """(n + 1,) mm, points from the first to the last of fine points (m,).

    Parameters
    ----------
    fine : (m,) mm, increasing positions at which the gap is known.
    longest : mm, of an edge.
    gap : (m,) mm, distance to other arms.

    Examples
    --------
    >>> graded_steps(np.linspace(0.0, 6.0, 61), 2.0, np.full(61, np.inf)).round(9).tolist()
    [0.0, 2.0, 4.0, 6.0]
    """
    wish = np.minimum(longest, MAX_EDGE_TO_GAP_RATIO * gap)
    wish = (wish + LINE_EDGE_GROWTH * np.abs(fine[:, None] - fine)).min(axis=1)
    count = np.concatenate([[0.0], np.cumsum(0.5 * (1.0 / wish[1:] + 1.0 / wish[:-1]) * np.diff(fine))])
    number = max(1, math.ceil(round(count[-1] - EDGE_COUNT_SLACK, 6)))  # equal lines get equal numbers
    return np.interp(np.linspace(0.0, count[-1], number + 1), count, fine)
