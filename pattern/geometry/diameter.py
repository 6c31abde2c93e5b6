"""Diameter of a set of points."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from asterism.equilibrium.arrays import Floats


def diameter(positions: Float[np.ndarray, "n 3"]) -> float:
    """Largest distance of two points (n, 3), in mm.

    Exact if at most 1000 points can be ends of the diameter. Nearly spherical sheets have more; then every second,
    third, ... of these points is used.

    >>> import numpy as np
    >>> diameter(np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]]))
    5.0
    """
    from scipy.spatial.distance import pdist

    first = positions[_distances(positions, positions.mean(axis=0)).argmax()]
    second = positions[_distances(positions, first).argmax()]
    distances = _distances(positions, second)
    # a long distance between two points, and the point halfway between them
    lower_bound, middle = distances.max(), 0.5 * (second + positions[distances.argmax()])
    # the triangle inequality excludes points near the middle: a longer distance cannot end there
    distances = _distances(positions, middle)
    ends = positions[distances >= (1.0 - 1e-9) * lower_bound - distances.max()]
    return float(pdist(ends[:: max(len(ends) // 500, 1)]).max(initial=lower_bound))


def _distances(positions: Floats, point: Floats) -> Floats:
    """(n,) mm from positions (n, 3) to a point (3,)."""
    offset = positions - point
    return np.asarray(np.sqrt(np.einsum("nc,nc->n", offset, offset)))
