"""How large a shape is."""

from __future__ import annotations

import numpy as np

from pattern.geometry.arrays import Floats


def diameter(positions: Floats) -> float:
    """mm, the largest distance of two points (n, 3); of very round sheets, to the resolution of some hundred points."""
    from scipy.spatial.distance import pdist

    one = positions[_far(positions, positions.mean(axis=0)).argmax()]
    other = positions[_far(positions, one).argmax()]
    away = _far(positions, other)
    least, middle = away.max(), 0.5 * (other + positions[away.argmax()])
    # both ends of a longer distance are at least so far from any point
    away = _far(positions, middle)
    ends = positions[away >= (1.0 - 1e-9) * least - away.max()]
    return float(pdist(ends[:: max(len(ends) // 500, 1)]).max(initial=least))


def _far(positions: Floats, point: Floats) -> Floats:
    """(n,) mm from positions (n, 3) to a point (3,)."""
    offset = positions - point
    return np.asarray(np.sqrt(np.einsum("nc,nc->n", offset, offset)))
