"""Finding printed points in the triangles of a sheet."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints

# Triangles with the nearest centroids, of which one holds a point.
CANDIDATE_TRIANGLES = 12


class TriangleFinder:
    """Finds printed points in the triangles of a sheet; made once for all questions about a mesh.

    Parameters
    ----------
    printed : (V, 2) mm.
    triangles : (T, 3).

    >>> finder = TriangleFinder(np.array([[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]), np.array([[0, 1, 2]]))
    >>> triangle, weights = finder.nearest(np.array([[1.0, 2.0]]))
    >>> triangle.tolist(), weights.tolist()
    ([0], [[0.25, 0.25, 0.5]])
    """

    def __init__(self, printed: Floats, triangles: Ints) -> None:
        self._corners = corners = printed[triangles]
        self._inverse = np.linalg.inv(np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1))
        self._tree = cKDTree(corners.mean(axis=1))

    def nearest(
        self, points: Float[np.ndarray, "n 2"], candidates: int = CANDIDATE_TRIANGLES
    ) -> tuple[Int[np.ndarray, " n"], Float[np.ndarray, "n 3"]]:
        """Of triangles with near centroids the best for each point (n, 2) mm, and the weights (n, 3) there.

        A weight is negative if the point is outside, or if its triangle is not among so many candidates.
        """
        near = self._tree.query(points, k=np.arange(1, min(candidates, len(self._corners)) + 1))[1]
        weights = self._weights_in(near, points)
        row, best = np.arange(len(points)), weights.min(axis=-1).argmax(axis=1)
        return near[row, best], weights[row, best]

    def near_before(
        self, points: Float[np.ndarray, "n 2"], known: Int[np.ndarray, " n"], candidates: int = CANDIDATE_TRIANGLES
    ) -> tuple[Int[np.ndarray, " n"], Float[np.ndarray, "n 3"]]:
        """As `nearest`, in less time for points that are still in the triangles `known`."""
        triangle, weights = known.copy(), self._weights_in(known[:, None], points)[:, 0]
        left = np.flatnonzero(weights.min(axis=1) < 0.0)
        if len(left):
            triangle[left], weights[left] = self.nearest(points[left], candidates)
        return triangle, weights

    def _weights_in(self, candidates: Ints, points: Floats) -> Floats:
        """(n, k, 3) weights of points (n, 2) in k triangles each."""
        offset = points[:, None] - self._corners[candidates, 0]
        rest = np.einsum("nkab,nkb->nka", self._inverse[candidates], offset)
        return np.concatenate([1 - rest.sum(axis=-1, keepdims=True), rest], axis=-1)


def clipped(weights: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Weights (n, 3) of places within the triangles: negative ones become 0, and the rest adds up to 1."""
    kept = np.maximum(weights, 0.0)
    return np.asarray(kept / kept.sum(axis=1, keepdims=True))


def locate(printed: Floats, triangles: Ints, points: Floats, off_sheet_mm: float = 0.0) -> tuple[Ints, Floats]:
    """The triangle that holds each point, and the point's weights there.

    Raises `ValueError` if these are no points, or one is off the sheet by more than `off_sheet_mm` and a rounding
    error.

    Parameters
    ----------
    printed : (V, 2) mm.
    triangles : (T, 3).
    points : (n, 2) mm.
    off_sheet_mm : points off the triangles by less are taken to them.

    Returns
    -------
    triangle : (n,)
    weights : (n, 3) barycentric, never negative, adding up to 1.
    """
    if points.ndim != 2 or points.shape[1] != 2:
        raise ValueError(f"printed points must be pairs of mm, shape (n, 2), got shape {points.shape}")
    if not np.isfinite(points).all():
        raise ValueError("a printed point is not a number")
    finder = TriangleFinder(printed, triangles)
    triangle, weights = finder.nearest(points)
    # long triangles may hide their centroid from a point: those few points are tried in every triangle; a point on an
    # edge may have a negative weight by a rounding error
    for i in np.flatnonzero(weights.min(axis=1) < -1e-9):
        triangle[i : i + 1], weights[i : i + 1] = finder.nearest(points[i : i + 1], len(triangles))
    weights = clipped(weights)
    allowed = max(off_sheet_mm, 1e-9 * float(np.ptp(printed, axis=0).max()))
    places = np.einsum("nk,nki->ni", weights, printed[triangles[triangle]])
    off = np.flatnonzero(np.linalg.norm(places - points, axis=1) > allowed)
    if len(off):
        x, y = points[off[0]]
        raise ValueError(
            f"{len(off)} of {len(points)} printed points are off the sheet, the first at ({x:g}, {y:g}) mm"
        )
    return triangle, weights
