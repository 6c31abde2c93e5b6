"""Conditions on the sheet, met exactly: X = T q + c.

`PointSupport` pins mesh vertices, `EdgeSupport` pins or clamps mesh edges. Both hold all three components or only those
along given directions: one direction is a plane to slide on. Everything that is not held is free.

Every condition becomes linear equations on value and derivatives of the position at some printed points
(`fem.supports.edge_equations`), and the equations are solved for the dofs they determine (`fem.supports.elimination`).
Equations that others imply are dropped, those that contradict others are an error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from skfem import MeshTri

from fem.elements.deformation import Deformation, flat
from fem.elements.space import Space
from fem.elements.tabulation import Floats, Ints
from fem.supports.edge_equations import Rows, edge_equations
from fem.supports.elimination import Contradiction, eliminate

NEAR_MM = 1e-6  # so near a mesh vertex is at a point


class ConditionError(ValueError):
    """A condition that cannot be met, in one line."""


@dataclass(frozen=True)
class PointSupport:
    """Vertices held in place.

    Attributes
    ----------
    vertices : (n,) of the mesh; `vertices_at` finds them.
    places : (n, 3) mm, where they end.
    directions : (k, 3) held components of the position; the identity holds all, one normal lets them slide on a plane.
    name : for messages.
    """

    vertices: Ints
    places: Floats
    directions: Floats = field(default_factory=lambda: np.eye(3))
    name: str = "points"


@dataclass(frozen=True)
class EdgeSupport:
    """Mesh edges held along a line, straight, oblique or curved (`fem.supports.edge_curve`).

    Attributes
    ----------
    facets : (n,) of the mesh; its rim is `mesh.boundary_facets()`.
    placement : where the edge ends; the printed plane if nothing is said.
    directions : (k, 3) held components of the position, as for points; (0, 3) holds none.
    clamped : hold the surface's tangent plane along the edge at the placement's.
    corner_deg : a line that turns by more has a corner.
    name : for messages.
    """

    facets: Ints
    placement: Deformation = field(default_factory=flat)
    directions: Floats = field(default_factory=lambda: np.eye(3))
    clamped: bool = False
    corner_deg: float = 30.0
    name: str = "edge"


Condition = PointSupport | EdgeSupport


@dataclass(frozen=True)
class Reduction:
    """Positions that meet all conditions: `X.ravel() = map @ q + offset(progress)`.

    Attributes
    ----------
    map : (3N, n).
    free : (n,) entries of X.ravel() that are q.
    printed, target : (3N,) constants that hold the sheet where it was printed, and where it ends.
    redundant : number of equations that others imply.
    normals : (k, 3) of clamped edges where they end; those of the print are (0, 0, 1).
    """

    map: sp.csr_matrix
    free: Ints
    printed: Floats
    target: Floats
    redundant: int
    normals: Floats = field(default_factory=lambda: np.empty((0, 3)))

    @cached_property
    def transposed(self) -> sp.csr_matrix:
        """(n, 3N), the map's."""
        return sp.csr_matrix(self.map.T)

    def offset(self, progress: float = 1.0) -> Floats:
        """(3N,) mm; held parts move straight from their printed place to their target."""
        return self.printed + progress * (self.target - self.printed)

    def positions(self, q: Floats, progress: float = 1.0) -> Floats:
        """(N, 3) from free unknowns (n,)."""
        return np.asarray((self.map @ q + self.offset(progress)).reshape(-1, 3))

    def project(self, positions: Floats) -> Floats:
        """(n,) free unknowns of any positions (N, 3)."""
        return positions.ravel()[self.free]


def impose_conditions(space: Space, conditions: Sequence[Condition]) -> Reduction:
    """The linear map from what stays free to the positions of a space's dofs.

    Raises
    ------
    ConditionError
        Two conditions contradict each other, or a direction is not a unit vector or not a new one.
    """
    parts: list[Rows] = []
    names: list[str] = []
    for condition in conditions:
        _check(condition, space.mesh)
        if isinstance(condition, PointSupport):
            rows = _point_rows(space.mesh, condition)
        else:
            rows = edge_equations(
                space,
                condition.facets,
                condition.placement,
                condition.directions,
                condition.clamped,
                condition.corner_deg,
            )
        parts.append(rows)
        names += [condition.name] * len(rows.triangles)
    size = 3 * space.size
    if not names:
        nothing = np.zeros(size)
        return Reduction(sp.identity(size, format="csr"), np.arange(size), nothing, nothing, 0)
    rows = Rows.joined(parts)
    reach = float(np.ptp(space.mesh.p, axis=1).max())
    try:
        found = eliminate(rows.matrix(space), rows.right, 1e-7 * reach)
    except Contradiction as error:
        x, y = rows.points[error.row]
        others = sorted({name for name in names if name != names[error.row]})
        against = f"other conditions ({', '.join(others)})" if others else "itself"
        raise ConditionError(
            f"{names[error.row]}: contradicts {against} at ({x:.4g}, {y:.4g}) mm by {error.miss:.3g} mm"
        ) from None
    normals = np.concatenate([np.empty((0, 3)), *(_normals(c, space.mesh) for c in conditions)])
    return Reduction(found.map, found.free, found.constant[:, 0], found.constant[:, 1], found.redundant, normals)


def vertices_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) vertices at printed points (n, 2) mm, within NEAR_MM.

    Raises
    ------
    ConditionError
        No vertex is there.
    """
    points = np.atleast_2d(points)
    distance = np.linalg.norm(mesh.p.T[None] - points[:, None], axis=2)
    nearest = distance.argmin(axis=1)
    for (x, y), miss in zip(points, distance.min(axis=1), strict=True):
        if not miss <= NEAR_MM:  # nan too
            raise ConditionError(
                f"held point ({x:.6g}, {y:.6g}) mm: no mesh vertex there, the nearest is {miss:.3g} mm off"
            )
    return np.asarray(nearest)


def _check(condition: Condition, mesh: MeshTri) -> None:
    directions = np.asarray(condition.directions, dtype=float)
    if not np.isfinite(directions).all():
        raise ConditionError(f"{condition.name}: directions must be finite")
    if directions.ndim != 2 or directions.shape[1] != 3 or len(directions) > 3:
        raise ConditionError(
            f"{condition.name}: directions {directions.shape} are not up to three rows of three numbers"
        )
    if np.linalg.matrix_rank(directions, tol=1e-6) < len(directions) or not np.allclose(
        (directions**2).sum(axis=1), 1.0
    ):
        raise ConditionError(f"{condition.name}: directions are not independent unit vectors")
    points = isinstance(condition, PointSupport)
    numbers = condition.vertices if isinstance(condition, PointSupport) else condition.facets
    allowed = mesh.nvertices if points else mesh.nfacets
    if len(numbers) == 0 or np.min(numbers) < 0 or np.max(numbers) >= allowed:
        raise ConditionError(
            f"{condition.name}: {'vertices' if points else 'facets'} are not in 0 .. {allowed - 1}, or there are none"
        )
    if not np.isfinite(_normals(condition, mesh)).all():
        raise ConditionError(f"{condition.name}: clamped along a line where its placement has no normal")
    if isinstance(condition, PointSupport) and np.shape(condition.places) != (len(numbers), 3):
        raise ConditionError(f"{condition.name}: places {np.shape(condition.places)} are not ({len(numbers)}, 3)")
    if isinstance(condition, PointSupport) and not np.isfinite(condition.places).all():
        raise ConditionError(f"{condition.name}: places must be finite")


def _normals(condition: Condition, mesh: MeshTri) -> Floats:
    """(k, 3) of the placement at the vertices of a clamped edge; none of others."""
    if isinstance(condition, PointSupport) or not condition.clamped:
        return np.empty((0, 3))
    with np.errstate(divide="ignore", invalid="ignore"):
        return condition.placement.normal(mesh.p.T[np.unique(mesh.facets[:, condition.facets])])


def _point_rows(mesh: MeshTri, held: PointSupport) -> Rows:
    # any triangle of the vertex will do
    owner = np.empty(mesh.nvertices, dtype=int)
    owner[mesh.t] = np.arange(mesh.nelements)
    printed = mesh.p.T[held.vertices]
    start = np.column_stack([printed, np.zeros(len(printed))])
    weights = np.zeros((len(held.directions), len(printed), 6, 3))
    weights[:, :, 0] = np.asarray(held.directions)[:, None]
    right = np.einsum("dnr,pnr->dnp", weights[:, :, 0], np.stack([start, held.places]))
    count = len(held.directions)
    return Rows(
        np.tile(owner[held.vertices], count),
        np.tile(printed, (count, 1)),
        weights.reshape(-1, 6, 3),
        right.reshape(-1, 2),
    )
