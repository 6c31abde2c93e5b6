"""Holes in the star pattern: lattice sites without a star that are enclosed by stars. The fabric is whole there."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import label
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats
from asterism.pattern.geometry.planar import distance_to_outline
from asterism.pattern.layout.layout import Layout

# radius of a cell in spacings: the corners of a cell of the triangular lattice
CELL_RADIUS = 3.0**-0.5
# steps to candidates for neighbours, in lattice coordinates
LATTICE_NEIGHBOURS = np.array([[(i, j) for j in (-1, 0, 1)] for i in (-1, 0, 1)])
# a candidate is a neighbour if its step is at most this many times the longer lattice vector
MAX_NEIGHBOUR_STEP = 1.0 + 1e-6


def in_holes(layout: Layout, points: Floats) -> Bools:
    """(n,) whether printed points (n, 2) mm are nearer to a site of a hole than to all stars."""
    holes = hole_sites(layout)
    if not len(holes):
        return np.zeros(len(points), dtype=bool)
    return np.asarray(cKDTree(holes).query(points)[0] < cKDTree(layout.centres).query(points)[0])


def hole_sites(layout: Layout) -> Floats:
    """(n, 2) mm, lattice sites without a star that are not connected to the rim through other such sites."""
    vectors = layout.lattice_vectors
    sites = np.rint((layout.centres - layout.lattice_origin) @ np.linalg.inv(vectors)).astype(np.int64)
    first = sites.min(axis=0) - 1
    empty = np.ones(np.ptp(sites, axis=0) + 3, dtype=bool)
    empty[tuple((sites - first).T)] = False
    longest = MAX_NEIGHBOUR_STEP * np.linalg.norm(vectors, axis=1).max()
    region = label(empty, np.linalg.norm(LATTICE_NEIGHBOURS @ vectors, axis=-1) <= longest)[0][empty]
    places = layout.lattice_origin + (np.argwhere(empty) + first) @ vectors
    near = CELL_RADIUS * layout.spacing_mm  # the cells of nearer sites reach the outline
    away = np.min([distance_to_outline(places, ring) for ring in layout.edges.rings], axis=0)
    rim = ~layout.is_on_sheet(places) | (away < near)
    return np.asarray(places[~np.isin(region, region[rim])])
