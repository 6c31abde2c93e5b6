"""Finding printed points in the triangles of a sheet."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from pattern.geometry.arrays import Floats, Ints


def locate(printed: Floats, triangles: Ints, points: Floats) -> tuple[Ints, Floats]:
    """The triangle that holds each point, and the point's weights there.

    Parameters
    ----------
    printed : (V, 2) mm.
    triangles : (T, 3).
    points : (n, 2) mm.

    Returns
    -------
    triangle : (n,)
    weights : (n, 3) barycentric, never negative, adding up to 1.

    Raises
    ------
    ValueError
        If these are no points, or one is off the sheet by more than a rounding error.
    """
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(f"printed points must be pairs of mm, shape (n, 2), got shape {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError("a printed point is not a number")
    corners = printed[triangles]
    inverse = np.linalg.inv(np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1))

    def weights_in(candidates: Ints, of: Floats) -> Floats:
        """(n, k, 3) weights of n points in k triangles each."""
        rest = np.einsum("nkab,nkb->nka", inverse[candidates], of[:, None] - corners[candidates, 0])
        return np.concatenate([1 - rest.sum(axis=-1, keepdims=True), rest], axis=-1)

    tree = cKDTree(corners.mean(axis=1))
    near = tree.query(points, k=np.arange(1, min(12, len(triangles)) + 1))[1]
    weights = weights_in(near, points)
    best = weights.min(axis=-1).argmax(axis=1)
    row = np.arange(len(points))
    found, weights = near[row, best], weights[row, best]
    # long triangles may hide their centroid from a point: those few points are tried in every triangle
    everywhere = np.arange(len(triangles))[None]
    for i in np.flatnonzero(weights.min(axis=1) < 0):
        tried = weights_in(everywhere, points[i : i + 1])[0]
        found[i] = tried.min(axis=-1).argmax()
        weights[i] = tried[found[i]]
    clipped = np.maximum(weights, 0.0)
    clipped /= clipped.sum(axis=1, keepdims=True)
    missed = np.linalg.norm(np.einsum("nk,nki->ni", clipped, corners[found]) - points, axis=1)
    off = np.flatnonzero(missed > 1e-9 * np.ptp(printed, axis=0).max())
    if len(off):
        x, y = points[off[0]]
        raise ValueError(
            f"{len(off)} of {len(points)} printed points are off the sheet, the first at ({x:g}, {y:g}) mm"
        )
    return found, clipped
