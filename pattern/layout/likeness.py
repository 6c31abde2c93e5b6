"""How far two shapes of one design are from each other, and which way a shape is rolled."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pattern.geometry.arrays import Floats
from pattern.geometry.rigid_fit import rms_distance
from pattern.layout.layout import Layout
from pattern.layout.symmetries import Symmetry

ROLLED_TURN = 1.0  # rad from one side of the sheet to the other
ROLLED_ASPECT = 0.3  # of the curvatures' squares along and across the axis
ONE_WAY = 0.5  # of the curvature's rms: its mean. A wave bends both ways
NEARLY = 0.7  # by which both may be missed by what is almost rolled


def distances(first: Floats, second: Floats, symmetries: Sequence[Symmetry]) -> Floats:
    """(n,) mm, rms distance of the star centres (S, 3) of two shapes, laid on each other, for every symmetry.

    The second shape stands for all its images `x'(p) = Q x(turn p + shift)`; see `Symmetry`.
    """
    return np.array([rms_distance(second[each.star], first, each.mirrors) for each in symmetries])


def print_diameter(layout: Layout) -> float:
    """mm, largest distance of two corners of the print."""
    return float(np.linalg.norm(layout.border[:, None] - layout.border[None], axis=2).max())


def rolled_about(layout: Layout, normal: Floats, nearly: bool = False) -> float | None:
    """Axis of a rolled sheet in print coordinates, 0 to 180 deg from the x axis; None for other shapes.

    From unit normals (S, 3) at the star centres. `nearly`: of sheets that are almost rolled, too.

    At every star the change of the normal from star to star is fitted by a linear map W (3, 2) of the printed place;
    the mean of W^T W has one large eigenvalue if the sheet bends about one axis only. A roll bends to one side.
    """
    pairs = np.concatenate([layout.neighbours, layout.neighbours[:, ::-1]])
    step = layout.centres[pairs[:, 1]] - layout.centres[pairs[:, 0]]
    change = normal[pairs[:, 1]] - normal[pairs[:, 0]]
    spacing = layout.spacing_mm
    # the normal equations of all stars at once
    count, star = len(layout.centres), pairs[:, 0]
    square, product = np.zeros((count, 2, 2)), np.zeros((count, 2, 3))
    np.add.at(square, star, step[:, :, None] * step[:, None])
    np.add.at(product, star, step[:, :, None] * change[:, None])
    # a map of the plane takes two directions
    fitted = np.linalg.eigvalsh(square)[:, 0] >= (0.1 * spacing) ** 2
    if not fitted.any():
        return None
    w = np.linalg.solve(square[fitted], product[fitted])
    total = (w @ np.swapaxes(w, 1, 2)).mean(axis=0)
    (low, high), vectors = np.linalg.eigh(total)
    share = NEARLY if nearly else 1.0
    if np.sqrt(high) * print_diameter(layout) < share * ROLLED_TURN or share * low > ROLLED_ASPECT * high:
        return None
    bends = np.cross(normal[fitted], vectors[:, 1] @ w)
    if np.linalg.norm(bends.mean(axis=0)) < share * ONE_WAY * np.sqrt(high):
        return None
    x, y = vectors[:, 0]
    return float(np.degrees(np.arctan2(y, x)) % 180.0)
