"""How far a shape is from that of an infinitely fine mesh, from the two finest meshes it was solved on."""

from __future__ import annotations

import numpy as np

from asterism.shape import Shape
from pattern.layout import Floats

# Observed order of the distance by the edge length, on aligned meshes: see docs/accuracy.md
ORDER = 1.0
# meshes of nearly the same edge say nothing, and shapes further apart (% of the diameter) are different minima
SMALLEST_RATIO = 1.2
LARGEST_PERCENT = 10.0


def mesh_error_percent(
    fine: Shape, coarse_printed: Floats, coarse_positions: Floats, order: float = ORDER
) -> float | None:
    """Richardson's estimate of the discretisation error of `fine`, rms over the sheet, in % of the diameter.

    With the edge ratio r and the order p it is the distance of the two shapes over `r^p - 1`.

    Parameters
    ----------
    fine : the shape on the finer mesh.
    coarse_printed, coarse_positions : (V, 2) and (V, 3) mm, vertices of the coarser mesh of the same sheet.

    Returns
    -------
    None if the meshes are too alike, or the shapes so different that they are not two views of the same one.
    """
    ratio = float(np.sqrt(len(fine.printed) / len(coarse_printed)))
    if ratio < SMALLEST_RATIO:
        return None
    distance = 100.0 * rms_distance(fine.at(coarse_printed), coarse_positions) / diameter(fine.positions)
    return distance / (ratio**order - 1.0) if distance < LARGEST_PERCENT else None


def rms_distance(one: Floats, other: Floats, mirrored: bool = False) -> float:
    """Root mean square distance (mm) of points (n, 3) after the best rigid motion; `mirrored`: the best reflection.

    Kabsch (1976).
    """
    a, b = one - one.mean(axis=0), other - other.mean(axis=0)
    u, size, vt = np.linalg.svd(a.T @ b)
    if (np.linalg.det(u @ vt) < 0.0) != mirrored:
        size[2] = -size[2]
    # |a R - b|^2 = |a|^2 + |b|^2 - 2 tr(R^T a^T b); rounding may leave a negative zero
    square = (a**2).sum() + (b**2).sum() - 2.0 * size.sum()
    return float(np.sqrt(max(square, 0.0) / len(a)))


def diameter(positions: Floats) -> float:
    """mm, the largest distance of two points, to the resolution of 500 of them."""
    from scipy.spatial import ConvexHull
    from scipy.spatial.distance import pdist

    flat = np.linalg.svd(positions - positions.mean(axis=0), full_matrices=False)[1]
    corners = positions if flat[2] < 1e-9 * flat[0] else positions[ConvexHull(positions).vertices]
    return float(pdist(corners[:: max(len(corners) // 500, 1)]).max())
