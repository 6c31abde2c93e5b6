"""Areas, curvatures, strains and standard pose of a triangulated sheet in space."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array, csc_array, diags_array

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry import planar
from asterism.pattern.geometry.normals import sum_at_vertices, triangle_normals, vertex_normals


def surface_triangle_areas(
    positions: Float[np.ndarray, "V _"], triangles: Int[np.ndarray, "T 3"]
) -> Float[np.ndarray, " T"]:
    """(T,) areas in mm^2; `positions` are (V, 2) or (V, 3) mm."""
    if positions.shape[1] == 2:
        return np.abs(planar.triangle_areas(positions, triangles))
    return np.asarray(np.linalg.norm(triangle_normals(positions, triangles), axis=1) / 2)


def directed_edges(triangles: Int[np.ndarray, "T 3"]) -> Int[np.ndarray, "_ 2"]:
    """(3 T, 2) edges in the direction of their triangles: first edges of all triangles, second ones, third ones."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).astype(np.int64)


def border_edges(triangles: Int[np.ndarray, "T 3"]) -> Int[np.ndarray, "_ 2"]:
    """(B, 2) edges of one triangle only, in its direction."""
    edges = directed_edges(triangles)
    # one number for each edge: pairs of numbers are slow to sort
    keys = edges.min(axis=1) * (edges.max(initial=0) + 1) + edges.max(axis=1)
    _, where, uses = np.unique(keys, return_inverse=True, return_counts=True)
    return edges[uses[where] == 1]


def border_of(triangles: Int[np.ndarray, "T 3"], count: int) -> Bool[np.ndarray, " {count}"]:
    """(count,) bool, vertices on the outline: those of edges that belong to one triangle only."""
    on_border = np.zeros(count, dtype=bool)
    on_border[border_edges(triangles)] = True
    return on_border


def vertex_areas(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> Float[np.ndarray, " V"]:
    """(V,) area of each vertex in mm^2; the sum is the area of the sheet.

    A vertex has its Voronoi area in acute triangles, and a half or a quarter of obtuse triangles.

    References
    ----------
    Meyer, Desbrun, Schroeder and Barr, Discrete differential-geometry operators for triangulated
    2-manifolds, 2003, section 3.3.
    """
    area = surface_triangle_areas(positions, triangles)[:, None]
    cotangents, squares = _cotangents(positions, triangles)
    # the cell of a corner has a share of its two edges, which are opposite to the other two corners
    share = (cotangents * squares) / 8
    voronoi = share.sum(axis=1, keepdims=True) - share
    obtuse = cotangents < 0
    halves = np.where(obtuse, area / 2, area / 4)
    return sum_at_vertices(
        triangles, np.where(obtuse.any(axis=1, keepdims=True), halves, voronoi).ravel(), len(positions)
    )


def gaussian_curvature(
    positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]
) -> Float[np.ndarray, " V"]:
    """(V,) 1/mm^2, angle defect (2 pi minus the angles around a vertex) over its area; NaN on the border."""
    return _per_area(2 * np.pi - angle_sums(positions, triangles), positions, triangles)


def angle_sums(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> Float[np.ndarray, " V"]:
    """(V,) rad, sum of the angles of the triangles around each vertex."""
    corners = positions[triangles]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    twice_area = np.linalg.norm(triangle_normals(positions, triangles), axis=1)[:, None]
    angles = np.arctan2(twice_area, np.einsum("tki,tki->tk", ahead, behind))
    return sum_at_vertices(triangles, angles.ravel(), len(positions))


def mean_curvature(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> Float[np.ndarray, " V"]:
    """(V,) 1/mm, mean of the principal curvatures by the cotangent formula; NaN on the border.

    Positive where the plastic side is convex: 1/R on a sphere whose outside is the plastic side.
    """
    pull = laplacian(positions, triangles) @ positions
    along_normal = np.einsum("vi,vi->v", pull, vertex_normals(positions, triangles))
    return _per_area(along_normal / 2, positions, triangles)


def laplacian(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> csc_array:
    """(V, V) minus the integral of the Laplacian over the cell of each vertex; positive semidefinite.

    An edge has the weight `(cot alpha + cot beta)/2` of the angles opposite to it.

    References
    ----------
    Pinkall and Polthier, Computing discrete minimal surfaces and their conjugates, 1993.
    """
    count = len(positions)
    cotangents, _ = _cotangents(positions, triangles)
    i, j = triangles[:, [1, 2, 0]].ravel(), triangles[:, [2, 0, 1]].ravel()
    weights = coo_array((cotangents.ravel() / 2, (i, j)), shape=(count, count)).tocsr()
    weights = weights + weights.T
    return csc_array(diags_array(weights.sum(axis=1)) - weights)


def deformation_gradients(
    flat: Float[np.ndarray, "V 2"], positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]
) -> Float[np.ndarray, "T 3 2"]:
    """(T, 3, 2) gradients of the positions (V, 3) mm with respect to a flat reference (V, 2) mm."""
    a, b, c = triangles.T
    (ux, vx), (uy, vy) = ((column[b] - column[a], column[c] - column[a]) for column in flat.T)
    area = ux * vy - uy * vx
    ux, uy, vx, vy = (component / area for component in (ux, uy, vx, vy))
    out = np.empty((len(triangles), 3, 2))
    for row, column in enumerate(positions.T):
        u, v = column[b] - column[a], column[c] - column[a]
        out[:, row, 0], out[:, row, 1] = u * vy - v * uy, v * ux - u * vx
    return out


def principal_strains(gradients: Float[np.ndarray, "T 3 2"]) -> Float[np.ndarray, "T 2"]:
    """(T, 2) singular values of deformation gradients (T, 3, 2) minus one, the larger first."""
    one, two = gradients.transpose(2, 0, 1)
    first, second = np.einsum("ti,ti->t", one, one), np.einsum("ti,ti->t", two, two)
    half_trace = (first + second) / 2
    radius = np.hypot((first - second) / 2, np.einsum("ti,ti->t", one, two))
    squares = np.column_stack([half_trace + radius, half_trace - radius])
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)) - 1)


def point_fields(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> dict[str, Floats]:
    """Fields of the sheet at the vertices, for reports and exports."""
    return {
        "normal": vertex_normals(positions, triangles),
        "mean_curvature_per_mm": mean_curvature(positions, triangles),
        "gaussian_curvature_per_mm2": gaussian_curvature(positions, triangles),
    }


def cell_fields(
    printed: Float[np.ndarray, "V 2"],
    positions: Float[np.ndarray, "V 3"],
    triangles: Int[np.ndarray, "T 3"],
    stretch: float | tuple[float, float],
) -> dict[str, Float[np.ndarray, " T"]]:
    """Principal strains of the triangles relative to the sheet in print and to the unstretched fabric."""
    gradients = deformation_gradients(printed, positions, triangles)
    from_print = principal_strains(gradients)
    # lengths in the unstretched fabric are the printed lengths over the stretch of each direction
    from_rest = principal_strains(gradients * np.asarray(stretch, dtype=float))
    return {
        "strain_from_print_max": from_print[:, 0],
        "strain_from_print_min": from_print[:, 1],
        "strain_from_rest_max": from_rest[:, 0],
        "strain_from_rest_min": from_rest[:, 1],
    }


def upright_rotation(
    printed: Float[np.ndarray, "V 2"],
    positions: Float[np.ndarray, "V 3"],
    weights: Float[np.ndarray, " V"],
    plastic_side: Float[np.ndarray, " 3"],
) -> Float[np.ndarray, "3 3"]:
    """Compute the rotation that turns the principal axes to x, y and z, with the plastic side up.

    If two moments are nearly equal (a dome seen from above, the section of a tube), their axes are undetermined. Then
    the plastic side and the printed directions decide, so that equal shapes have equal pictures. The `weights` add up
    to 1; the `plastic_side` is the mean direction of the normals, of any length. The rotation is for column vectors.
    """
    centred = positions - weights @ positions
    # principal axes of the second moments, the smallest first
    moments, axes = np.linalg.eigh((weights[:, None] * centred).T @ centred)
    (short, middle, long), moments = axes.T, moments[::-1]
    short = short * np.sign(np.linalg.det([long, middle, short]))
    if moments[1] < 1.3 * moments[2]:
        across = plastic_side - (plastic_side @ long) * long
        if np.linalg.norm(across) > 0:
            short = across / np.linalg.norm(across)
    elif plastic_side @ short < 0:
        short = -short
    middle = np.cross(short, long)

    flat = centred @ np.column_stack([long, middle])
    overlap = (weights[:, None] * (printed - weights @ printed)).T @ flat
    turn = np.arctan2(overlap[1, 0] - overlap[0, 1], overlap[0, 0] + overlap[1, 1])
    if moments[0] > 1.1 * moments[1]:
        # the longest axis is well determined and stays along x: the only choice left is a half turn
        turn = 0.0 if abs(turn) <= np.pi / 2 else np.pi
    cos, sin = np.cos(turn), np.sin(turn)
    return np.array([cos * long - sin * middle, sin * long + cos * middle, short])


def _cotangents(positions: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    """(T, 3) cotangent at each corner and (T, 3) mm^2 square of the edge opposite to it."""
    corners = positions[triangles]
    next_edge = np.roll(corners, -1, axis=1) - corners
    last_edge = np.roll(corners, -2, axis=1) - corners
    twice_area = np.linalg.norm(triangle_normals(positions, triangles), axis=1)[:, None]
    # limits the division for a triangle that has collapsed to a line, with corner angles 0 and pi
    tiny = np.finfo(float).tiny + 1e-12 * np.einsum("tki,tki->tk", next_edge, next_edge)
    cotangents = np.einsum("tki,tki->tk", next_edge, last_edge) / np.maximum(twice_area, tiny)
    opposite = np.roll(next_edge, -1, axis=1)
    return cotangents, np.einsum("tki,tki->tk", opposite, opposite)


def _per_area(values: Floats, positions: Floats, triangles: Ints) -> Floats:
    """(V,) values over the area of each vertex; NaN on the border and at vertices of zero area."""
    area = vertex_areas(positions, triangles)
    defined = ~border_of(triangles, len(positions)) & (area > 0)
    return np.asarray(np.divide(values, area, out=np.full(len(positions), np.nan), where=defined))
