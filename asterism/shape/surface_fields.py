"""Areas, normals, curvatures and strains of a triangulated sheet in space."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array

from pattern.geometry import planar
from pattern.geometry.arrays import Floats, Ints
from pattern.geometry.normals import gather, triangle_normals, vertex_normals


def triangle_areas(positions: Floats, triangles: Ints) -> Floats:
    """(T,) mm^2; `positions` may be (V, 2) or (V, 3)."""
    if positions.shape[1] == 2:
        return np.abs(planar.triangle_areas(positions, triangles))
    return np.asarray(np.linalg.norm(triangle_normals(positions, triangles), axis=1) / 2)


def border_of(triangles: Ints, count: int) -> np.ndarray:
    """(count,) bool, vertices on the outline: on an edge that belongs to one triangle only."""
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    on_border = np.zeros(count, dtype=bool)
    on_border[unique[uses == 1].ravel()] = True
    return on_border


def vertex_areas(positions: Floats, triangles: Ints) -> Floats:
    """(V,) mm^2, the part of the sheet that belongs to each vertex; the parts add up to the whole sheet.

    Voronoi cells, replaced by halves and quarters in obtuse triangles.

    References
    ----------
    Meyer, Desbrun, Schroeder and Barr, Discrete differential-geometry operators for triangulated
    2-manifolds, 2003, section 3.3.
    """
    area = triangle_areas(positions, triangles)[:, None]
    cotangents, squares = _cotangents(positions, triangles)
    # the cell of corner k has a share of the two edges that meet there, opposite to the other two corners
    share = (cotangents * squares) / 8
    voronoi = share.sum(axis=1, keepdims=True) - share
    obtuse = cotangents < 0
    halves = np.where(obtuse, area / 2, area / 4)
    return gather(triangles, np.where(obtuse.any(axis=1, keepdims=True), halves, voronoi).ravel(), len(positions))


def gaussian_curvature(positions: Floats, triangles: Ints) -> Floats:
    """(V,) 1/mm^2, 2 pi less the angles around a vertex, over its area; NaN on the border."""
    cotangents, _ = _cotangents(positions, triangles)
    angles = np.arctan2(1.0, cotangents)
    defect = 2 * np.pi - gather(triangles, angles.ravel(), len(positions))
    return _per_area(defect, positions, triangles)


def mean_curvature(positions: Floats, triangles: Ints) -> Floats:
    """(V,) 1/mm, mean of the principal curvatures by the cotangent formula; NaN on the border.

    Positive where the plastic side is convex: 1/R on a sphere whose outside is the plastic side.
    """
    count = len(positions)
    cotangents, _ = _cotangents(positions, triangles)
    i, j = triangles[:, [1, 2, 0]].ravel(), triangles[:, [2, 0, 1]].ravel()
    weights = coo_array((cotangents.ravel() / 2, (i, j)), shape=(count, count)).tocsr()
    weights = weights + weights.T
    laplacian = weights @ positions - weights.sum(axis=1)[:, None] * positions
    along_normal = -np.einsum("vi,vi->v", laplacian, vertex_normals(positions, triangles))
    return _per_area(along_normal / 2, positions, triangles)


def deformation_gradients(flat: Floats, positions: Floats, triangles: Ints) -> Floats:
    """(T, 3, 2), edges in space times the inverse of those of a flat sheet (V, 2) mm, which counts as unstrained."""
    a, b, c = triangles.T
    (ux, vx), (uy, vy) = ((one[b] - one[a], one[c] - one[a]) for one in flat.T)
    area = ux * vy - uy * vx
    ux, uy, vx, vy = (one / area for one in (ux, uy, vx, vy))
    out = np.empty((len(triangles), 3, 2))
    for row, one in enumerate(positions.T):
        u, v = one[b] - one[a], one[c] - one[a]
        out[:, row, 0], out[:, row, 1] = u * vy - v * uy, v * ux - u * vx
    return out


def principal_strains(gradients: Floats) -> Floats:
    """(T, 2) singular values of deformation gradients (T, 3, 2), less one; the larger first."""
    one, two = gradients.transpose(2, 0, 1)
    first, second = np.einsum("ti,ti->t", one, one), np.einsum("ti,ti->t", two, two)
    half_trace = (first + second) / 2
    radius = np.hypot((first - second) / 2, np.einsum("ti,ti->t", one, two))
    squares = np.column_stack([half_trace + radius, half_trace - radius])
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)) - 1)


def point_fields(positions: Floats, triangles: Ints) -> dict[str, Floats]:
    """Fields of the sheet per vertex, for reports and exports."""
    return {
        "normal": vertex_normals(positions, triangles),
        "mean_curvature_per_mm": mean_curvature(positions, triangles),
        "gaussian_curvature_per_mm2": gaussian_curvature(positions, triangles),
    }


def cell_fields(
    printed: Floats, positions: Floats, triangles: Ints, stretch: float | tuple[float, float]
) -> dict[str, Floats]:
    """Strains per triangle from the sheet as printed and from the fabric at rest, for reports and exports."""
    gradients = deformation_gradients(printed, positions, triangles)
    from_print = principal_strains(gradients)
    # at rest lengths are the printed ones over the stretch of each direction
    from_rest = principal_strains(gradients * np.asarray(stretch, dtype=float))
    return {
        "strain_from_print_max": from_print[:, 0],
        "strain_from_print_min": from_print[:, 1],
        "strain_from_rest_max": from_rest[:, 0],
        "strain_from_rest_min": from_rest[:, 1],
    }


def _cotangents(positions: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """(T, 3) cotangent at each corner and (T, 3) mm^2 square of the edge opposite to it."""
    corners = positions[triangles]
    next_edge = np.roll(corners, -1, axis=1) - corners
    last_edge = np.roll(corners, -2, axis=1) - corners
    twice_area = np.linalg.norm(triangle_normals(positions, triangles), axis=1)[:, None]
    # a triangle squeezed to a line would divide by zero: its corner angles are 0 and pi, cotangents large
    tiny = np.finfo(float).tiny + 1e-12 * np.einsum("tki,tki->tk", next_edge, next_edge)
    cotangents = np.einsum("tki,tki->tk", next_edge, last_edge) / np.maximum(twice_area, tiny)
    opposite = np.roll(next_edge, -1, axis=1)
    return cotangents, np.einsum("tki,tki->tk", opposite, opposite)


def _per_area(values: Floats, positions: Floats, triangles: Ints) -> Floats:
    """(V,) values over the area of each vertex; NaN on the border and where the sheet has collapsed."""
    area = vertex_areas(positions, triangles)
    defined = ~border_of(triangles, len(positions)) & (area > 0)
    return np.asarray(np.divide(values, area, out=np.full(len(positions), np.nan), where=defined))
