"""Holes in the pattern of a sheet: sites without a star that have stars all around them."""

from __future__ import annotations

import numpy as np
import shapely
from scipy.ndimage import label
from scipy.spatial import cKDTree

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from pattern.geometry.arrays import Floats
from pattern.geometry.planar import distance_to_outline
from pattern.layout.layout import Layout

# steps to neighbours in the coordinates of the lattice, and how much longer than its longer vector they may be
LATTICE_NEIGHBOURS = np.array([[(i, j) for j in (-1, 0, 1)] for i in (-1, 0, 1)])
NEIGHBOUR_TOLERANCE = 1.0 + 1e-6


def in_holes(layout: Layout, points: Floats, model: PreviewModel = PREVIEW_MODEL) -> np.ndarray:
    """(n,) whether printed points (n, 2) mm are nearer to a site of a hole than to any star."""
    holes = hole_sites(layout, model) if model.has_holes else np.empty((0, 2))
    if not len(holes):
        return np.zeros(len(points), dtype=bool)
    return np.asarray(cKDTree(holes).query(points)[0] < cKDTree(layout.centres).query(points)[0])


def hole_sites(layout: Layout, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(n, 2) mm, sites of the lattice without a star from which no way over such sites leads to the sheet's rim."""
    vectors = layout.lattice_vectors
    sites = np.rint((layout.centres - layout.lattice_origin) @ np.linalg.inv(vectors)).astype(np.int64)
    first = sites.min(axis=0) - 1
    empty = np.ones(np.ptp(sites, axis=0) + 3, dtype=bool)
    empty[tuple((sites - first).T)] = False
    joined = (
        np.linalg.norm(LATTICE_NEIGHBOURS @ vectors, axis=-1)
        <= NEIGHBOUR_TOLERANCE * np.linalg.norm(vectors, axis=1).max()
    )
    region, _ = label(empty, joined)
    places = layout.lattice_origin + (np.argwhere(empty) + first) @ vectors
    of = region[empty]
    sheet = shapely.polygons(layout.outline)
    near = model.hole_rim_distance * layout.spacing_mm
    rim = ~shapely.contains_xy(sheet, places) | (distance_to_outline(places, layout.outline) < near)
    return np.asarray(places[~np.isin(of, of[rim])])
