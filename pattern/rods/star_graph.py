"""The graph of stars: one rod an arm, from the star's centre to the tip."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.rods.graph import Rod, RodGraph


def star_graph(
    centres: Floats, arm_star: Ints, tips: Floats, thickness: Floats, width: Floats, meeting: float
) -> RodGraph:
    """The arms as rods, in their order. Ends of arms of different stars that meet are one node.

    Parameters
    ----------
    centres : (S, 2) mm.
    arm_star : (A,) star of each arm.
    tips : (A, 2) mm.
    thickness, width : (A, 2) mm, at the centre and at the tip.
    meeting : mm, ends closer than this meet; 0 lets none meet.

    Examples
    --------
    Two stars of one arm each, whose tips meet:

    >>> centres, sizes = np.array([[0.0, 0.0], [10.0, 0.0]]), np.full((2, 2), 0.3)
    >>> star_graph(centres, np.array([0, 1]), np.array([[5.0, 0.0], [5.0, 0.0]]), sizes, sizes, 1e-6).joints
    ()
    >>> star_graph(centres, np.array([0, 1]), np.array([[5.0, 1.0], [5.0, 1.0]]), sizes, sizes, 1e-6).joints
    (2,)
    """
    places = np.concatenate([centres, tips])
    node = np.arange(len(places))
    pairs = np.empty((0, 2), dtype=np.int64)
    if meeting > 0.0:
        from scipy.spatial import cKDTree  # slow to import; readers of designs do without it

        pairs = cKDTree(places).query_pairs(meeting, output_type="ndarray")
    for pair in pairs[np.lexsort(pairs.T)]:
        node[node == node[pair.max()]] = node[pair.min()]
    kept, node = np.unique(node, return_inverse=True)
    start, end = node[arm_star], node[len(centres) :]
    touched = np.bincount(end, minlength=len(kept)) > 0
    stars = np.bincount(node[: len(centres)], minlength=len(kept))
    paired = np.flatnonzero((stars == 1) & ~touched)
    points = np.stack([centres[arm_star], tips], axis=1)
    of_arms = zip(points, start.tolist(), end.tolist(), thickness, width, arm_star.tolist(), strict=True)
    rods = tuple(Rod(ends, first, last, thick, wide, group=star) for ends, first, last, thick, wide, star in of_arms)
    return RodGraph(places[kept], rods, paired)
