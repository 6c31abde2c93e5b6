"""Places that are close to each other."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints


def clusters(places: Floats, distance: float) -> tuple[Ints, Floats]:
    """Cluster (n,) of each place, and the first place (k, 2) of each cluster; clusters in the order of their first."""
    # slow to import, and not needed to read a design
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    n = len(places)
    if n == 0:
        return np.empty(0, dtype=np.int64), np.empty((0, 2))
    pairs = cKDTree(places).query_pairs(distance, output_type="ndarray")
    label = connected_components(coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n)), directed=False)[1]
    _, first, group = np.unique(label, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return rank[group], places[first[order]]
