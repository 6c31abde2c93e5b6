"""Checks of a mesh before functions are defined on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from skfem import ElementTriP1, MeshTri


def checked_mesh(mesh: MeshTri) -> MeshTri:
    """The mesh with the corners of every triangle in ascending order, which fixes the direction of its edges.

    Vertices, triangles and edges keep their numbers, and named boundaries their edges.

    Raises
    ------
    ValueError
        A triangle is curved, degenerate or not finite; a vertex belongs to no triangle; an edge has more than two
        triangles; or the mesh is not connected.
    """
    if mesh.elem is not ElementTriP1:
        raise ValueError("mesh: triangles must have straight edges, as those of MeshTri")
    if mesh.t.size == 0:
        raise ValueError("mesh: has no triangles")
    if not np.isfinite(mesh.p).all():
        raise ValueError("mesh: a vertex is not finite")
    size, t = mesh.p.shape[1], mesh.t
    unused = np.flatnonzero(np.bincount(t.ravel(), minlength=size) == 0)
    if len(unused):
        raise ValueError(f"mesh: vertex {unused[0]} belongs to no triangle")
    side1, side2 = (mesh.p[:, t[k]] - mesh.p[:, t[0]] for k in (1, 2))
    degenerate = np.flatnonzero(side1[0] * side2[1] == side1[1] * side2[0])
    if len(degenerate):
        raise ValueError(f"mesh: triangle {degenerate[0]} has no area")
    crowded = np.flatnonzero(np.bincount(mesh.t2f.ravel()) > 2)
    if len(crowded):
        raise ValueError(f"mesh: edge {crowded[0]} has more than two triangles")
    edges = sp.coo_array((np.ones(mesh.facets.shape[1]), tuple(mesh.facets)), shape=(size, size))
    pieces = connected_components(edges, directed=False, return_labels=False)
    if pieces > 1:
        raise ValueError(f"mesh: has {pieces} pieces that are not connected")
    return mesh if (np.diff(t, axis=0) > 0).all() else replace(mesh, t=np.sort(t, axis=0), sort_t=True)
