"""Essential boundary conditions, imposed exactly by elimination: `x = T q + c`.

`PointSupport` fixes mesh vertices. `EdgeSupport` pins mesh edges, `d . (x - x_target) = 0` for given directions d, and
may clamp them: `n . dx/dnu = 0` with the target's normal n and the normal nu of the edge in the printed plane, which
fixes the tangent plane and leaves the stretch across the edge free. With three directions a point is fixed; with one it
slides on a plane. All other boundaries are free (natural conditions).

Each support gives linear equations for the position and its derivatives at printed points. They are solved for the dofs
that they determine. Redundant equations are dropped; contradictory equations are an error.

An edge gives equations at its ends for the value and its first and second derivative along the curve. A clamp adds the
slope and its derivative along the curve, and the slope at the edge midpoint. On straight edges these equations
determine the whole polynomial along the edge.

**Curves.** A supported edge may be straight, oblique or curved, but mesh edges are straight. Supports along each
straight edge would fix the gradient at every vertex of a curve, and refinement would not remove this error (Babuska's
paradox). Therefore a vertex with a small turning angle is a point of a smooth curve, with the curvature of the circle
through it and its two neighbours. A vertex with a larger turning angle is a corner, supported along both edges.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy.sparse as sp
from scipy.linalg import qr
from scipy.sparse.csgraph import connected_components
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.deformation import Deformation, flat

VERTEX_TOLERANCE_MM = 1e-6  # mm, largest distance of a mesh vertex from the point that it stands for
# points (n, 2), middles (n, 2) of their mesh edges and tangents (n, 2) to shifts and derivatives (n, 3, 3)
EdgeShift = Callable[[Floats, Floats, Floats], Floats]
MIN_COEFFICIENT = 1e-10  # 1: over the largest coefficient of an equation; smaller ones are rounding and dropped


class ConditionError(ValueError):
    """A support that is not admissible, or that contradicts another one."""


@dataclass(frozen=True)
class PointSupport:
    """Supported mesh vertices."""

    vertices: Ints  # (n,) of the mesh; `vertices_at` finds them
    places: Floats  # (n, 3) mm, target positions
    # (k, 3) unit vectors along which the position is fixed. The identity fixes all components; a single normal lets the
    # points slide on a plane.
    directions: Floats = field(default_factory=lambda: np.eye(3))
    name: str = "points"  # for messages


@dataclass(frozen=True)
class EdgeSupport:
    """Supported mesh edges along a straight or curved line."""

    facets: Ints  # (n,) of the mesh; the whole boundary is `mesh.boundary_facets()`
    # target of the edge, a deformation of the printed sheet; the printed plane by default.
    placement: Deformation = field(default_factory=flat)
    # (k, 3) unit vectors along which the position is fixed, as for points; (0, 3) fixes none.
    directions: Floats = field(default_factory=lambda: np.eye(3))
    clamped: bool = False  # fix the tangent plane along the edge to that of the target
    corner_deg: float = 30.0  # a vertex where the line turns by more than this angle is a corner
    # shift of the target from its placement, for edges that are not clamped: a function of points (n, 2) mm, the
    # middles (n, 2) mm of their mesh edges and tangents (n, 2) that gives (n, 3, 3) mm, the shift and its first and
    # second derivative along the edge.
    shift: EdgeShift | None = None
    name: str = "edge"  # for messages


Condition = PointSupport | EdgeSupport


@dataclass(frozen=True)
class Reduction:
    """Positions that meet all supports: `X.ravel() = map @ q + offset(progress)`."""

    map: sp.csr_matrix  # (3N, n)
    free: Ints  # (n,) entries of X.ravel() that are q
    # printed, target: (3N,) mm, constants for the supports at their printed and at their target positions.
    printed: Floats
    target: Floats
    # (k, 3) target normals of clamped edges; the printed normals are (0, 0, 1).
    normals: Floats = field(default_factory=lambda: np.empty((0, 3)))

    @cached_property
    def transposed(self) -> sp.csr_matrix:
        """(n, 3N) transpose of the map."""
        return sp.csr_matrix(self.map.T)

    def offset(self, progress: float = 1.0) -> Floats:
        """(3N,) mm; supports move along straight lines from their printed to their target positions."""
        return self.printed + progress * (self.target - self.printed)

    def positions(self, q: Floats, progress: float = 1.0) -> Floats:
        """(N, 3) from free unknowns (n,)."""
        return np.asarray((self.map @ q + self.offset(progress)).reshape(-1, 3))

    def project(self, positions: Floats) -> Floats:
        """(n,) free unknowns of any positions (N, 3)."""
        return positions.ravel()[self.free]


def impose_conditions(space: Argyris, conditions: Sequence[Condition]) -> Reduction:
    """The affine map from the free unknowns to the positions.

    Raises `ConditionError` if two supports contradict each other, or the directions are not independent unit vectors.
    """
    parts: list[Rows] = []
    names: list[str] = []
    for condition in conditions:
        _check(condition, space.mesh)
        if isinstance(condition, PointSupport):
            rows = _point_rows(space.mesh, condition)
        else:
            rows = _edge_rows(space.mesh, condition)
        parts.append(rows)
        names += [condition.name] * len(rows.triangles)
    size = 3 * space.size
    if not names:
        zero = np.zeros(size)
        return Reduction(sp.identity(size, format="csr"), np.arange(size), zero, zero)
    rows = Rows.joined(parts)
    extent = float(np.ptp(space.mesh.p, axis=1).max())
    try:
        # residual of redundant equations over the extent of the sheet, beyond which supports contradict each other
        solved = eliminate(rows.matrix(space), rows.right, 1e-7 * extent)
    except Contradiction as error:
        x, y = rows.points[error.row]
        others = sorted({name for name in names if name != names[error.row]})
        against = f"other conditions ({', '.join(others)})" if others else "itself"
        raise ConditionError(
            f"{names[error.row]}: contradicts {against} at ({x:.4g}, {y:.4g}) mm by {error.miss:.3g} mm"
        ) from None
    normals = np.concatenate([np.empty((0, 3)), *(_normals(c, space.mesh) for c in conditions)])
    return Reduction(solved.map, solved.free, solved.constant[:, 0], solved.constant[:, 1], normals)


def vertices_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) vertices at printed points (n, 2) mm, within VERTEX_TOLERANCE_MM.

    Raises `ConditionError` if a point has no vertex within the tolerance.
    """
    points = np.atleast_2d(points)
    distance = np.linalg.norm(mesh.p.T[None] - points[:, None], axis=2)
    nearest = distance.argmin(axis=1)
    for (x, y), miss in zip(points, distance.min(axis=1), strict=True):
        if not miss <= VERTEX_TOLERANCE_MM:  # nan too
            raise ConditionError(f"point support ({x:.6g}, {y:.6g}) mm: the nearest mesh vertex is {miss:.3g} mm away")
    return np.asarray(nearest)


def _check(condition: Condition, mesh: MeshTri) -> None:
    directions = np.asarray(condition.directions, dtype=float)
    if not np.isfinite(directions).all():
        raise ConditionError(f"{condition.name}: directions must be finite")
    if directions.ndim != 2 or directions.shape[1] != 3 or len(directions) > 3:
        raise ConditionError(
            f"{condition.name}: directions {directions.shape} are not up to three rows of three numbers"
        )
    are_units = np.allclose((directions**2).sum(axis=1), 1.0)
    if np.linalg.matrix_rank(directions, tol=1e-6) < len(directions) or not are_units:
        raise ConditionError(f"{condition.name}: directions are not independent unit vectors")
    if isinstance(condition, EdgeSupport) and condition.clamped and condition.shift is not None:
        raise ConditionError(f"{condition.name}: a clamped edge has no shift")
    if isinstance(condition, PointSupport):
        kind, numbers, allowed = "vertices", condition.vertices, mesh.nvertices
    else:
        kind, numbers, allowed = "facets", condition.facets, mesh.nfacets
    if len(numbers) == 0 or np.min(numbers) < 0 or np.max(numbers) >= allowed:
        raise ConditionError(f"{condition.name}: {kind} must be in 0 .. {allowed - 1}, and at least one")
    if not np.isfinite(_normals(condition, mesh)).all():
        raise ConditionError(f"{condition.name}: the target has no normal along this clamped edge")
    if isinstance(condition, PointSupport) and np.shape(condition.places) != (len(numbers), 3):
        raise ConditionError(f"{condition.name}: places {np.shape(condition.places)} are not ({len(numbers)}, 3)")
    if isinstance(condition, PointSupport) and not np.isfinite(condition.places).all():
        raise ConditionError(f"{condition.name}: places must be finite")


def _normals(condition: Condition, mesh: MeshTri) -> Floats:
    """(k, 3) target normals at the vertices of a clamped edge; empty for other supports."""
    if isinstance(condition, PointSupport) or not condition.clamped:
        return np.empty((0, 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        return condition.placement.normal(mesh.p.T[np.unique(mesh.facets[:, condition.facets])])


def _point_rows(mesh: MeshTri, points: PointSupport) -> Rows:
    """Equations of supported vertices, for the polynomial of any triangle of the vertex."""
    triangle = np.empty(mesh.nvertices, dtype=int)
    triangle[mesh.t] = np.arange(mesh.nelements)
    printed = mesh.p.T[points.vertices]
    start = np.column_stack([printed, np.zeros(len(printed))])
    weights = np.zeros((len(points.directions), len(printed), 6, 3))
    weights[:, :, 0] = np.asarray(points.directions)[:, None]
    right = np.einsum("dnr,pnr->dnp", weights[:, :, 0], np.stack([start, points.places]))
    count = len(points.directions)
    return Rows(
        np.tile(triangle[points.vertices], count),
        np.tile(printed, (count, 1)),
        weights.reshape(-1, 6, 3),
        right.reshape(-1, 2),
    )


class Rows(NamedTuple):
    """Equations `sum_ar weights[a, r] J_a[x_r] = right` on the jets J of the position."""

    triangles: Ints  # (R,) triangle whose polynomial is evaluated
    points: Floats  # (R, 2) printed mm
    weights: Floats  # (R, 6, 3) weights of the value and the derivatives 1, 2, 11, 22, 12 of every component
    right: Floats  # (R, 2) right-hand sides for the printed sheet and for the target

    @classmethod
    def at(
        cls, triangles: Ints, points: Floats, weights: Floats, placement: Deformation, shift: Floats | float = 0.0
    ) -> Rows:
        """Equations whose right-hand sides the printed plane and the placement, plus a shift (R,), satisfy."""
        printed, target = (np.einsum("nar,nar->n", weights, place.jets(points)) for place in (flat(), placement))
        return cls(triangles, points, weights, np.column_stack([printed, target + shift]))

    @classmethod
    def joined(cls, parts: Sequence[Rows]) -> Rows:
        """All equations of the parts, in their order."""
        none = cls(np.empty(0, dtype=np.int64), np.empty((0, 2)), np.empty((0, 6, 3)), np.empty((0, 2)))
        return cls(*(np.concatenate(columns) for columns in zip(none, *parts, strict=True)))

    def matrix(self, space: Argyris) -> sp.csr_matrix:
        """(R, 3N) coefficients of the dofs; those below MIN_COEFFICIENT are dropped."""
        dofs, jets = space.jets(self.triangles, self.points)
        table = np.matmul(jets, self.weights)
        size = np.abs(table)
        row, dof, component = np.nonzero(size > MIN_COEFFICIENT * size.max(axis=(1, 2), keepdims=True))
        columns = 3 * dofs[row, dof] + component
        return sp.csr_matrix((table[row, dof, component], (row, columns)), shape=(len(dofs), 3 * space.size))


def _edge_rows(mesh: MeshTri, edge: EdgeSupport) -> Rows:
    """Equations of supported mesh edges, for the dofs at their ends and midpoints."""
    curve, placement = edge_curve(mesh, edge.facets, edge.corner_deg), edge.placement
    triangles, middles = mesh.f2t[0, edge.facets], curve.ends.mean(axis=1)
    parts = []
    for end in (0, 1):
        points, tangents, bends = curve.ends[:, end], curve.tangents[:, end], curve.curvatures[:, end]
        value, along, bend, across, twist = _line_jets(tangents, bends)
        moved = np.zeros((len(points), 3, 3)) if edge.shift is None else edge.shift(points, middles, tangents)
        fixed = [jet[:, :, None] * direction for direction in edge.directions for jet in (value, along, bend)]
        shifts = [moved[:, order] @ direction for direction in edge.directions for order in range(3)]
        if edge.clamped:
            normal = placement.normal(points)[:, None]
            normal_rate = placement.normal_turn(points, tangents)[:, None]
            fixed += [across[:, :, None] * normal, twist[:, :, None] * normal + across[:, :, None] * normal_rate]
            shifts += [np.zeros(len(points))] * 2
        if fixed:
            repeated = np.tile(triangles, len(fixed)), np.tile(points, (len(fixed), 1))
            parts.append(Rows.at(*repeated, np.concatenate(fixed), placement, np.concatenate(shifts)))
    if edge.clamped:
        # on plates with a closed form, the slope across the chord gives smaller errors than that across the curve
        chord = curve.ends[:, 1] - curve.ends[:, 0]
        across = _line_jets(chord / np.linalg.norm(chord, axis=1, keepdims=True), np.zeros(len(chord)))[3]
        normal = placement.normal(middles)[:, None]
        parts.append(Rows.at(triangles, middles, across[:, :, None] * normal, placement))
    return Rows.joined(parts)


def _line_jets(tangents: Floats, bends: Floats) -> tuple[Floats, ...]:
    """(n, 6) weights of value, d/ds, d2/ds2, d/dnu and d/ds d/dnu along a curve of signed curvature k.

    The normal nu is on the left of the tangent t. With `t' = k nu` and `nu' = -k t`, the second derivative along the
    curve is `t . H t + k d/dnu`, and the derivative of the slope across it is `t . H nu - k d/dt`.
    """
    normals = left(tangents)
    zero, one = np.zeros(len(tangents)), np.ones(len(tangents))
    (t1, t2), (n1, n2) = tangents.T, normals.T
    value = np.column_stack([one, zero, zero, zero, zero, zero])
    along = np.column_stack([zero, t1, t2, zero, zero, zero])
    across = np.column_stack([zero, n1, n2, zero, zero, zero])
    bend = np.column_stack([zero, bends * n1, bends * n2, t1 * t1, t2 * t2, 2.0 * t1 * t2])
    twist = np.column_stack([zero, -bends * t1, -bends * t2, t1 * n1, t2 * n2, t1 * n2 + t2 * n1])
    return value, along, bend, across, twist


@dataclass(frozen=True)
class EdgeCurve:
    """The curve at E mesh edges, each directed from its first end to its second."""

    ends: Floats  # (E, 2, 2) mm, their two ends
    tangents: Floats  # (E, 2, 2) unit tangents of the curve at both ends
    curvatures: Floats  # (E, 2) per mm, at both ends; positive if the curve turns left


def left(vectors: Floats) -> Floats:
    """(..., 2) vectors rotated by 90 degrees to the left."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def edge_curve(mesh: MeshTri, facets: Ints, corner_deg: float) -> EdgeCurve:
    """The curve through mesh edges. On the boundary, unsupported boundary edges count as neighbours too.

    Parameters
    ----------
    mesh : mesh of scikit-fem.
    facets : (E,) numbers of its edges.
    corner_deg : deg, turning angle above which a vertex is a corner.

    The corners of a square are corners, so its edges are straight:

    >>> mesh = MeshTri()
    >>> bool(edge_curve(mesh, mesh.boundary_facets(), 30.0).curvatures.any())
    False
    """
    points = mesh.p.T
    pairs = mesh.facets[:, facets].T
    outer = mesh.f2t[1, facets] < 0
    rim = _neighbours(mesh.facets[:, mesh.boundary_facets()].T)
    line = _neighbours(pairs)
    bends = np.zeros((len(facets), 2))
    for row, (pair, on_rim) in enumerate(zip(pairs, outer, strict=True)):
        neighbours = rim if on_rim else line
        at_ends = [_bend(points, neighbours, int(pair[1 - end]), int(pair[end]), corner_deg) for end in (0, 1)]
        # at the first end the curvature is measured in the opposite direction of the edge
        first, second = (None if at_ends[0] is None else -at_ends[0]), at_ends[1]
        bends[row, 0] = first if first is not None else second or 0.0
        bends[row, 1] = second if second is not None else first or 0.0
    ends = points[pairs]
    chord = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(chord, axis=1, keepdims=True)
    bends[np.abs(bends * length) < 1e-9] = 0.0
    half = np.arcsin(np.clip(0.5 * bends * length, -1.0, 1.0)) * np.array([-1.0, 1.0])
    direction = (chord / length)[:, None]
    tangents = np.cos(half)[..., None] * direction + np.sin(half)[..., None] * left(direction)
    return EdgeCurve(ends, tangents, bends)


def _neighbours(pairs: Ints) -> dict[int, list[int]]:
    """The vertices connected to each vertex by an edge."""
    neighbours: dict[int, list[int]] = defaultdict(list)
    for a, b in pairs.tolist():
        neighbours[a].append(b)
        neighbours[b].append(a)
    return neighbours


def _bend(points: Floats, neighbours: dict[int, list[int]], start: int, vertex: int, corner_deg: float) -> float | None:
    """Curvature of the circle through `start`, `vertex` and the next vertex; None at an end or a corner."""
    following = [number for number in neighbours[vertex] if number != start]
    if len(following) != 1:
        return None
    p, q, r = points[start], points[vertex], points[following[0]]
    u, v, w = q - p, r - q, r - p
    cross, dot = u[0] * v[1] - u[1] * v[0], u @ v
    if abs(np.degrees(np.arctan2(cross, dot))) > corner_deg:
        return None
    return float(2.0 * cross / np.sqrt((u @ u) * (v @ v) * (w @ w)))


COEFFICIENT_DIGITS = 10  # decimals of coefficients scaled to a maximum of 1; equal blocks are then solved once


@dataclass(frozen=True)
class Elimination:
    """x = map q + constant."""

    map: sp.csr_matrix  # (n, len(free)); rows of the free unknowns are those of the identity
    constant: Floats  # (n, k), one column for each right-hand side
    free: Ints  # numbers of the unknowns that are kept, sorted


class Contradiction(ValueError):
    """The equations have no solution; `row` is the worst equation and `miss` its residual."""

    def __init__(self, row: int, miss: float) -> None:
        super().__init__(f"equation {row} is off by {miss:.3g}")
        self.row, self.miss = row, miss


def eliminate(matrix: sp.csr_matrix, right: Floats, tolerance: float) -> Elimination:
    """Solve equations `matrix x = right` for as many unknowns as they determine.

    Blocks of equations that share unknowns are solved separately, by QR with column pivoting. Raises `Contradiction` if
    the equations have no solution.

    Parameters
    ----------
    matrix : (R, n) coefficients.
    right : (R, k) right-hand sides.
    tolerance : largest residual of a redundant equation, scaled to a largest coefficient of 1.

    `x0 + x1 = 2`, twice, leaves x1 and x2 free:

    >>> solved = eliminate(sp.csr_matrix([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0]]), np.array([[2.0], [4.0]]), 1e-9)
    >>> solved.free.tolist()
    [1, 2]
    >>> (solved.map @ np.array([0.5, 7.0]) + solved.constant[:, 0]).round(6)
    array([1.5, 0.5, 7. ])
    """
    matrix = sp.csr_matrix(matrix)
    matrix.sum_duplicates()
    largest = abs(matrix).max(axis=1).toarray().ravel() if matrix.shape[0] else np.empty(0)
    empty = largest == 0.0
    wrong = empty & ~(np.abs(right).max(axis=1) <= tolerance)  # nan too
    if wrong.any():
        first = int(wrong.argmax())
        raise Contradiction(first, float(np.abs(right[first]).max()))
    scale = np.where(empty, 1.0, largest)
    matrix = sp.csr_matrix(sp.diags_array(1.0 / scale) @ matrix)
    matrix.data = np.round(matrix.data, COEFFICIENT_DIGITS)
    matrix.eliminate_zeros()
    right = right / scale[:, None]
    size = matrix.shape[1]
    constant = np.zeros((size, right.shape[1]))
    eliminated = np.zeros(size, dtype=bool)
    rows_out: list[Ints] = []
    columns_out: list[Ints] = []
    entries_out: list[Floats] = []
    equal_blocks: dict[tuple[int, bytes], list[tuple[Ints, Ints]]] = {}  # such as the components of a vector
    for rows, columns, block in _blocks(matrix):
        equal_blocks.setdefault((len(rows), block.tobytes()), []).append((rows, columns))
    for (height, entries), places in equal_blocks.items():
        rows, columns = (np.array(part) for part in zip(*places, strict=True))  # a block in each row
        q, inverse, pivot, row, column, weight = _solved(np.frombuffer(entries).reshape(height, -1))
        given = right[rows]
        miss = np.abs(given - q @ (q.T @ given)).max(axis=2)
        if not miss.max() <= tolerance:  # nan too
            worst = np.unravel_index(miss.argmax(), miss.shape)
            raise Contradiction(int(rows[worst]), float(miss[worst]))
        pivots = columns[:, pivot]
        eliminated[pivots] = True
        constant[pivots] = inverse @ given
        rows_out.append(pivots[:, row].ravel())
        columns_out.append(columns[:, column].ravel())
        entries_out.append(np.tile(weight, len(rows)))
    free = np.flatnonzero(~eliminated)
    number = np.full(size, -1)
    number[free] = np.arange(len(free))
    where = np.concatenate([*rows_out, free]), number[np.concatenate([*columns_out, free])]
    weights = np.concatenate([*entries_out, np.ones(len(free))])
    mapping = sp.csr_matrix((weights, where), shape=(size, len(free)))
    return Elimination(mapping, constant, free)


def _solved(block: Floats) -> tuple[Floats, Floats, Ints, Ints, Ints, Floats]:
    """A block of equations, solved by QR with column pivoting: `x[pivots] = inverse @ right + W x`.

    An orthonormal basis of the range of the block, as columns, the inverse, the pivots, and rows, columns and weights
    of the entries of W.
    """
    q, r, order = qr(block, mode="economic", pivoting=True, check_finite=False)
    # a smaller pivot, over the largest one, belongs to a redundant equation
    rank = int(np.sum(np.abs(np.diag(r)) > 1e-9 * abs(r[0, 0])))
    q = q[:, :rank]
    solved = np.linalg.solve(r[:rank, :rank], np.hstack([q.T, -r[:rank, rank:]]))
    weights = solved[:, len(block) :]
    i, j = np.nonzero(np.abs(weights) >= 10.0**-COEFFICIENT_DIGITS)
    return q, solved[:, : len(block)], order[:rank], i, order[rank:][j], weights[i, j]


def _blocks(matrix: sp.csr_matrix) -> Iterator[tuple[Ints, Ints, Floats]]:
    """Rows, columns and dense entries of the diagonal blocks of a matrix, after a permutation."""
    count = matrix.shape[0]
    entries = matrix.tocoo()
    graph = sp.coo_matrix((np.ones(entries.nnz), (entries.row, count + entries.col)), shape=(sum(matrix.shape),) * 2)
    kinds, label = connected_components(graph, directed=False)
    order = np.argsort(label, kind="stable")  # rows first within a block
    ends = np.searchsorted(label[order], np.arange(kinds + 1))
    place = np.empty_like(order)
    place[order] = np.arange(len(order)) - ends[label[order]]
    of_block = np.argsort(label[entries.row], kind="stable")
    stops = np.searchsorted(label[entries.row][of_block], np.arange(kinds + 1))
    i, j, values = place[entries.row[of_block]], place[count + entries.col[of_block]], entries.data[of_block]
    for kind in np.flatnonzero(np.diff(stops)):
        members = order[ends[kind] : ends[kind + 1]]
        height = int(np.searchsorted(members, count))
        block = np.zeros((height, len(members) - height))
        part = slice(stops[kind], stops[kind + 1])
        block[i[part], j[part] - height] = values[part]
        yield members[:height], members[height:] - count, block
