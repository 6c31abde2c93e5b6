"""The first cells of the universal law: spread evenly over its range, by a Sobol sequence.

The sequence has no end, and a longer list begins with the shorter one. So a campaign can be extended at any time, and
its finished cells stay in the plan.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.universal.groups import GROUP_KEYS, GROUPS, MAX_ARM_CURL, MIN_FABRIC_TO_EDGE, arm_curl

# mesh edges between two stars; coarse meshes are cheap, and the answers vary evenly from mesh to mesh
EDGES_BETWEEN_STARS = (10, 12, 15, 20)
# points of the sequence that are drawn at a time, a power of two
_BLOCK = 1024
_ARM, _FABRIC, _EDGE = (GROUP_KEYS.index(key) for key in ("arm", "fabric", "edge"))


def spread_groups(count: int, seed: int = 0) -> Floats:
    """(count, G) groups of the first cells. Every cell needs a single mesh: its arms are a whole number of edges long.

    Parameters
    ----------
    seed : of the scrambled sequence; another seed gives cells that can test a law of the first ones.

    Examples
    --------
    >>> few, more = spread_groups(3), spread_groups(5)
    >>> bool((few == more[:3]).all()), more.shape
    (True, (5, 8))
    """
    from scipy.stats import qmc  # its import takes half a second, and only campaigns use it

    engine = qmc.Sobol(len(GROUPS), seed=np.random.default_rng(seed))
    rows = np.empty((0, len(GROUPS)))
    while len(rows) < count:
        groups = groups_at(engine.random(_BLOCK))
        rows = np.vstack([rows, groups[arm_curl(groups) <= MAX_ARM_CURL]])
    return rows[:count]


def groups_at(points: Floats) -> Floats:
    """(n, G) groups of points (n, G) in the unit cube, with a whole number of mesh edges on arms and between stars."""
    groups = np.column_stack([group.at_coordinate(points[:, n]) for n, group in enumerate(GROUPS)])
    # the meshes that are fine enough for a fabric have equal shares of its cells
    first = np.searchsorted(EDGES_BETWEEN_STARS, MIN_FABRIC_TO_EDGE / groups[:, _FABRIC])
    left = len(EDGES_BETWEEN_STARS) - first
    edges = np.array(EDGES_BETWEEN_STARS)[first + np.minimum((points[:, _EDGE] * left).astype(int), left - 1)]
    shortest, longest = GROUPS[_ARM].limits
    along = np.clip(np.rint(groups[:, _ARM] * edges), np.ceil(shortest * edges), np.floor(longest * edges + 1e-9))
    groups[:, _ARM] = along / edges
    groups[:, _EDGE] = 1.0 / edges
    return np.round(groups, 12)
