"""Distance of two shapes of one design as held, for every symmetry of the design."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.free_motions import FreeMotions
from asterism.pattern.layout.symmetries import Symmetry

FREE_SHEET = FreeMotions()


def symmetric_distances(
    first: Floats, second: Floats, symmetries: Sequence[Symmetry], free: FreeMotions = FREE_SHEET
) -> Floats:
    """(n,) mm, rms distance of two shapes after the best free motion, for each of n symmetries.

    Parameters
    ----------
    first, second : (S, 3) mm, star centres of the two shapes.
    symmetries : each stands for the image `x'(p) = Q x(turn p + shift)` of the second shape, see `Symmetry`.
    free : motions that the supports leave to the first shape; by default all rigid motions of a free sheet.

    Examples
    --------
    A turn by a right angle is a free motion of a free sheet, and none of a sheet on needles.

    >>> star, none = np.arange(3), np.zeros(2)
    >>> first = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [-1.0, -1.0, 0.0]])
    >>> second = first[:, [1, 0, 2]] * [-1.0, 1.0, 1.0]
    >>> bool(symmetric_distances(first, second, [Symmetry(np.eye(2), none, star)])[0] < 1e-9)
    True
    >>> on_needles = FreeMotions(first, np.ones((3, 3), dtype=bool))
    >>> symmetric_distances(first, second, [Symmetry(np.eye(2), none, star)], on_needles).round(3).tolist()
    [2.16]
    """
    return np.array([_distance(first, each.in_space(second[each.star]), free) for each in symmetries])


def distances_of_images(
    printed: Floats,
    first: Floats,
    second_at: Callable[[Floats], Floats],
    symmetries: Sequence[Symmetry],
    free: FreeMotions = FREE_SHEET,
) -> Floats:
    """(n,) mm, as `symmetric_distances`, at any printed points.

    Parameters
    ----------
    printed : (P, 2) mm, the points.
    first : (P, 3) mm, their places in the first shape.
    second_at : gives the places (P, 3) of printed points in the second shape.
    """
    images = [each.in_space(second_at(printed @ each.turn.T + each.shift)) for each in symmetries]
    return np.array([_distance(first, image, free) for image in images])


def _distance(points: Floats, targets: Floats, free: FreeMotions) -> float:
    rotation, shift = free.fit(points, targets)
    return float(np.sqrt(((points @ rotation.T + shift - targets) ** 2).sum(axis=1).mean()))
