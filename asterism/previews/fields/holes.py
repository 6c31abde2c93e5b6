"""Holes in the star pattern: lattice sites without a star that are enclosed by stars. The fabric is whole there."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import distance_to_outline
from asterism.pattern.layout.layout import Layout
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# steps to candidates for neighbours, in lattice coordinates
LATTICE_NEIGHBOURS = np.array([[(i, j) for j in (-1, 0, 1)] for i in (-1, 0, 1)])
# a candidate is a neighbour if its step is at most this many times the longer lattice vector
MAX_NEIGHBOUR_STEP = 1.0 + 1e-6


def in_holes(layout: Layout, points: Floats, model: PreviewModel = PREVIEW_MODEL) -> np.ndarray:
    """(n,) bool, whether printed points (n, 2) mm are nearer to a site of a hole than to all stars."""
    holes = hole_sites(layout, model)
    if not len(holes):
        return np.zeros(len(points), dtype=bool)
    return np.asarray(cKDTree(holes).query(points)[0] < cKDTree(layout.centres).query(points)[0])


def hole_sites(layout: Layout, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(n, 2) mm, lattice sites without a star that are not connected to the rim through other such sites."""
    vectors = layout.lattice_vectors
    sites = np.rint((layout.centres - layout.lattice_origin) @ np.linalg.inv(vectors)).astype(np.int64)
    first = sites.min(axis=0) - 1
    empty = np.ones(np.ptp(sites, axis=0) + 3, dtype=bool)
    empty[tuple((sites - first).T)] = False
    joined = (
        np.linalg.norm(LATTICE_NEIGHBOURS @ vectors, axis=-1)
        <= MAX_NEIGHBOUR_STEP * np.linalg.norm(vectors, axis=1).max()
    )
    places = layout.lattice_origin + (np.argwhere(empty) + first) @ vectors
    region = connected_sites(empty, np.argwhere(joined) - 1)
    near = model.cell_radius * layout.spacing_mm  # the cells of nearer sites reach the outline
    away = np.min([distance_to_outline(places, ring) for ring in layout.edges.rings], axis=0)
    rim = ~layout.is_on_sheet(places) | (away < near)
    return np.asarray(places[~np.isin(region, region[rim])])


def connected_sites(empty: np.ndarray, steps: Ints) -> Ints:
    """(n,) number of the connected region of each true entry of a table (X, Y), for steps (k, 2) to neighbours."""
    count, (rows, columns) = int(empty.sum()), empty.shape
    number = np.full((rows + 2, columns + 2), -1)
    here = number[1:-1, 1:-1]
    here[empty] = np.arange(count)
    pairs = [np.empty((2, 0), dtype=np.int64)]
    for i, j in steps.tolist():
        there = number[1 + i : 1 + i + rows, 1 + j : 1 + j + columns]
        both = (here >= 0) & (there >= 0)
        pairs.append(np.stack([here[both], there[both]]))
    first, second = np.concatenate(pairs, axis=1)
    graph = coo_matrix((np.ones(len(first)), (first, second)), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])
