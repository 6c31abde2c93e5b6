"""Which way a sheet is rolled."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import Layout

# rotation of the normal from one end of the sheet to the other
MIN_ROLL_RAD = 1.0
# squared curvature along the axis over that across it
MAX_ROLL_ASPECT = 0.3
# mean curvature over its rms: a wave bends both ways
MIN_ONE_SIDEDNESS = 0.5
# factor on the three limits for sheets that are almost rolled
ALMOST_ROLLED_FACTOR = 0.7


def roll_axis_from_normals(layout: Layout, normal: Floats, almost: bool = False) -> float | None:
    """Axis of a rolled sheet in printed coordinates, 0 to 180 deg from the x axis; None for other shapes.

    Parameters
    ----------
    normal : (S, 3) unit normals at the layout's `sample_points`: the star centres, or points of a drawing.
    almost : accept sheets that are almost rolled.

    Notes
    -----
    At every star, a linear map W (3, 2) of the printed place is fitted to the change of the normal from star to star.
    The mean of W^T W has one large eigenvalue if the sheet bends about one axis only. A roll bends to one side.
    """
    points, neighbours = layout.sample_points, layout.sample_pairs
    pairs = np.concatenate([neighbours, neighbours[:, ::-1]])
    step = points[pairs[:, 1]] - points[pairs[:, 0]]
    change = normal[pairs[:, 1]] - normal[pairs[:, 0]]
    spacing = layout.spacing_mm
    # the normal equations of all stars at once
    count, star = len(points), pairs[:, 0]
    square, product = np.zeros((count, 2, 2)), np.zeros((count, 2, 3))
    np.add.at(square, star, step[:, :, None] * step[:, None])
    np.add.at(product, star, step[:, :, None] * change[:, None])
    # a map of the plane needs neighbours in two directions
    fitted = np.linalg.eigvalsh(square)[:, 0] >= (0.1 * spacing) ** 2
    if not fitted.any():
        return None
    w = np.linalg.solve(square[fitted], product[fitted])
    total = (w @ np.swapaxes(w, 1, 2)).mean(axis=0)
    (low, high), vectors = np.linalg.eigh(total)
    factor = ALMOST_ROLLED_FACTOR if almost else 1.0
    if np.sqrt(high) * layout.diameter_mm < factor * MIN_ROLL_RAD or factor * low > MAX_ROLL_ASPECT * high:
        return None
    bends = np.cross(normal[fitted], vectors[:, 1] @ w)
    if np.linalg.norm(bends.mean(axis=0)) < factor * MIN_ONE_SIDEDNESS * np.sqrt(high):
        return None
    x, y = vectors[:, 0]
    return float(np.degrees(np.arctan2(y, x)) % 180.0)
