"""A triangulated sheet in space: areas, curvatures, strains, standard pose, self-intersections and nearest points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.spatial import cKDTree

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


def self_intersections(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> int:
    """Count the pairs of triangles (T, 3) at positions (V, 3) mm that pass through each other and share no vertex."""
    pairs = _close_pairs(positions, triangles)
    corner = positions[triangles]
    through = _edge_through(corner[pairs[:, 0]], corner[pairs[:, 1]])
    rest = ~through
    through[rest] = _edge_through(corner[pairs[rest, 1]], corner[pairs[rest, 0]])
    return int(through.sum())


def meets_itself(
    printed: Float[np.ndarray, "V 2"], positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]
) -> bool:
    """Fast test whether a smooth sheet, printed (V, 2) mm and at positions (V, 3) mm, may pass through itself.

    True if two vertices that are printed more than three edge lengths apart are so close in space that their triangles
    can touch. If this is false, `self_intersections` can only find folds within three edge lengths, which a smooth
    sheet does not have. The test takes a fifth of its time.
    """
    edges = directed_edges(triangles)
    longest = _lengths(positions, edges).max()
    # each point of a triangle is within (longest edge) / sqrt(3) of its nearest corner
    reach = 2.0 * longest / np.sqrt(3.0)
    near = cKDTree(positions).query_pairs(reach, output_type="ndarray")
    # two vertices whose printed distance is above this number of edge lengths are not neighbours
    return bool((_lengths(printed, near) > 3.0 * _lengths(printed, edges).max()).any())


def _lengths(points: Floats, pairs: Ints) -> Floats:
    apart = points[pairs[:, 0]] - points[pairs[:, 1]]
    return np.asarray(np.sqrt(np.einsum("pi,pi->p", apart, apart)))  # faster than numpy's norm


def _close_pairs(positions: Floats, triangles: Ints) -> Ints:
    """(P, 2) pairs of triangles whose bounding boxes overlap, without pairs that share a vertex."""
    corner = positions[triangles]
    low, high = corner.min(axis=1), corner.max(axis=1)
    middle = 0.5 * (low + high)
    reach = float((high - low).max())  # the centres of overlapping boxes are closer than this along x, y and z
    pairs = cKDTree(middle).query_pairs(reach, p=np.inf, output_type="ndarray")
    i, j = pairs.T
    boxes = (low[i] <= high[j]).all(axis=1) & (low[j] <= high[i]).all(axis=1)
    pairs = pairs[boxes]
    first, second = triangles[pairs[:, 0]], triangles[pairs[:, 1]]
    # one pair of corners at a time: an array of all nine comparisons would need the most memory of this file
    shared = np.zeros(len(pairs), dtype=bool)
    for a in range(3):
        for b in range(3):
            shared |= first[:, a] == second[:, b]
    return np.asarray(pairs[~shared])


def _edge_through(first: Floats, second: Floats) -> NDArray[np.bool_]:
    """(P,) whether an edge of the first triangle (P, 3, 3) passes through the second one."""
    a, b, c = second.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    height = np.einsum("pki,pi->pk", first - a[:, None], normal)
    out = np.zeros(len(first), dtype=bool)
    for start, end in ((0, 1), (1, 2), (2, 0)):
        h0, h1 = height[:, start], height[:, end]
        crosses = np.flatnonzero(h0 * h1 < 0.0)
        t = h0[crosses] / (h0[crosses] - h1[crosses])
        p, q = first[crosses, start], first[crosses, end]
        point = p + t[:, None] * (q - p)
        n = normal[crosses]
        inside = np.ones(len(crosses), dtype=bool)
        for u, v in ((a, b), (b, c), (c, a)):
            side = (np.cross(v[crosses] - u[crosses], point - u[crosses]) * n).sum(axis=1)
            # triangles that overlap by less than this part of their size only touch
            inside &= side > 1e-12 * (n * n).sum(axis=1)
        out[crosses[inside]] = True
    return out


@dataclass(frozen=True)
class Nearest:
    """The nearest points on a surface to some points."""

    places: Floats  # (n, 3) mm, nearest points on the surface
    triangle: Ints  # (n,) triangles that contain them
    distance: Floats  # (n,) mm, positive on the side of the normals


class NearestOnSurface:
    """Search for the nearest points on triangles (T, 3) with vertices (V, 3) mm."""

    def __init__(self, vertices: Floats, triangles: Ints):
        self.vertices, self.triangles, self._corners = vertices, triangles, vertices[triangles]
        normals = triangle_normals(vertices, triangles)
        self.normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        centres = self._corners.mean(axis=1)
        size = np.linalg.norm(self._corners - centres[:, None], axis=2).max(axis=1)
        # triangles of one kind differ in size by a factor of 2 at most
        kind = np.floor(np.log(np.maximum(size, 1e-9) / max(size.max(), 1e-9)) / np.log(2.0)).astype(int)
        self._kinds = [(cKDTree(centres[kind == k]), np.flatnonzero(kind == k)) for k in np.unique(kind)]

    def __call__(self, points: Floats) -> Nearest:
        """The nearest points to points (n, 3) mm."""
        many = 20_000  # points that are computed in one array
        chunks = [self._some(points[i : i + many]) for i in range(0, len(points), many)]
        places, triangle = (np.concatenate(parts) for parts in zip(*chunks, strict=True))
        away = points - places
        side = np.where(np.einsum("ni,ni->n", away, self.normals[triangle]) < 0, -1.0, 1.0)
        return Nearest(places, triangle, side * np.linalg.norm(away, axis=1))

    def _some(self, points: Floats) -> tuple[Floats, Ints]:
        from trimesh.triangles import closest_point  # slow to import

        # of each kind, the triangles with the nearest centres
        near = [among[tree.query(points, k=range(1, min(12, len(among)) + 1))[1]] for tree, among in self._kinds]
        candidates = np.concatenate(near, axis=1)
        there = closest_point(self._corners[candidates.ravel()], np.repeat(points, candidates.shape[1], axis=0))
        places = there.reshape(*candidates.shape, 3)
        # triangles without area give nan in older releases of trimesh
        best = np.nan_to_num(((places - points[:, None, :]) ** 2).sum(axis=2), nan=np.inf).argmin(axis=1)
        rows = np.arange(len(points))
        return places[rows, best], candidates[rows, best]
