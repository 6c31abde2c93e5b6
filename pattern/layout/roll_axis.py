"""Which way a sheet is rolled."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import Layout


def roll_axis_from_normals(layout: Layout, normal: Floats, almost: bool = False) -> float | None:
    """Axis of a rolled sheet in printed coordinates, 0 to 180 deg from the x axis; None for other shapes.

    At every star, a linear map W (3, 2) of the printed place is fitted to the change of the normal from star to star.
    The mean of W^T W has one large eigenvalue if the sheet bends about one axis only. A roll bends to one side.

    Parameters
    ----------
    normal : (S, 3) unit normals at the layout's `sample_points`: the star centres, or points of a drawing.
    almost : accept sheets that are almost rolled.
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
    factor = 0.7 if almost else 1.0
    # the normal rotates by 1 rad or more from end to end, and the sheet bends little along the axis
    if np.sqrt(high) * layout.diameter_mm < factor or factor * low > 0.3 * high:
        return None
    bends = np.cross(normal[fitted], vectors[:, 1] @ w)
    # a wave bends both ways
    if np.linalg.norm(bends.mean(axis=0)) < factor * 0.5 * np.sqrt(high):
        return None
    x, y = vectors[:, 0]
    # rounded, so that no axis along x is one of 180 deg
    return float(np.round(np.degrees(np.arctan2(y, x)), 9) % 180.0)
