"""Linear equations of a support along mesh edges, for both kinds of discretisation.

A C1 space with derivatives at its vertices (Argyris) gets equations for the value and its first and second derivative
along the curve. A clamp adds the slope and its derivative along the curve, and the slope at the edge midpoint if this
is a dof. On straight edges these equations determine the whole polynomial along the edge. A continuous space
(`fem.elements.lifted`) gets equations at its nodes along the edge, and a clamp at as many Gauss points as its slope has
degrees of freedom.

A clamp fixes the tangent plane and leaves the stretch across the edge free: `n . dx/dnu = 0`, with n the normal of the
target and nu the normal of the edge in the printed plane.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.deformation import Deformation, flat
from asterism.fem.elements.space import Space
from asterism.fem.supports.edge_curve import EdgeCurve, edge_curve, left

# points (n, 2), middles (n, 2) of their mesh edges and tangents (n, 2) to shifts and derivatives (n, 3, 3)
EdgeShift = Callable[[Floats, Floats, Floats], Floats]

MIN_COEFFICIENT = 1e-10  # 1: over the largest coefficient of an equation; smaller ones are rounding and dropped


@dataclass(frozen=True)
class Rows:
    """Equations `sum_ar weights[a, r] J_a[x_r] = right` on the jets J of the position.

    Attributes
    ----------
    triangles : (R,) triangle whose polynomial is evaluated.
    points : (R, 2) printed mm.
    weights : (R, 6, 3) weights of the value and the derivatives 1, 2, 11, 22, 12 of every component.
    right : (R, 2) right-hand sides for the printed sheet and for the target.
    """

    triangles: Ints
    points: Floats
    weights: Floats
    right: Floats

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
        names = ("triangles", "points", "weights", "right")
        if not parts:
            return cls(np.empty(0, dtype=np.int64), np.empty((0, 2)), np.empty((0, 6, 3)), np.empty((0, 2)))
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))

    def matrix(self, space: Space) -> sp.csr_matrix:
        """(R, 3N) coefficients of the dofs; those below MIN_COEFFICIENT are dropped."""
        dofs, jets = space.jets(self.triangles, self.points)
        table = np.matmul(jets, self.weights)
        size = np.abs(table)
        row, dof, component = np.nonzero(size > MIN_COEFFICIENT * size.max(axis=(1, 2), keepdims=True))
        columns = 3 * dofs[row, dof] + component
        return sp.csr_matrix((table[row, dof, component], (row, columns)), shape=(len(dofs), 3 * space.size))


def edge_equations(
    space: Space,
    facets: Ints,
    placement: Deformation,
    directions: Floats,
    clamped: bool,
    corner_deg: float,
    shift: EdgeShift | None = None,
) -> Rows:
    """Equations of supported mesh edges; arguments as in `fem.supports.conditions.EdgeSupport`."""
    curve = edge_curve(space.mesh, facets, corner_deg)
    triangles = space.mesh.f2t[0, facets]
    rows = _vertex_rows if space.smooth else _node_rows
    moved = shift or _no_shift
    return Rows.joined(list(rows(space, curve, triangles, placement, np.asarray(directions), clamped, moved)))


def _no_shift(points: Floats, middles: Floats, tangents: Floats) -> Floats:
    return np.zeros((len(points), 3, 3))


def _vertex_rows(
    space: Space,
    curve: EdgeCurve,
    triangles: Ints,
    placement: Deformation,
    directions: Floats,
    clamped: bool,
    shift: EdgeShift,
) -> list[Rows]:
    """Equations of a C1 space, for the dofs at the ends and midpoints of the edges."""
    parts = []
    for end in (0, 1):
        points, tangents, bends = curve.ends[:, end], curve.tangents[:, end], curve.curvatures[:, end]
        value, along, bend, across, twist = _line_jets(tangents, bends)
        moved = shift(points, curve.ends.mean(axis=1), tangents)
        fixed = [jet[:, :, None] * direction for direction in directions for jet in (value, along, bend)]
        shifts = [moved[:, order] @ direction for direction in directions for order in range(3)]
        if clamped:
            normal = placement.normal(points)[:, None]
            normal_rate = placement.normal_turn(points, tangents)[:, None]
            fixed += [across[:, :, None] * normal, twist[:, :, None] * normal + across[:, :, None] * normal_rate]
            shifts += [np.zeros(len(points))] * 2
        if fixed:
            repeated = np.tile(triangles, len(fixed)), np.tile(points, (len(fixed), 1))
            parts.append(Rows.at(*repeated, np.concatenate(fixed), placement, np.concatenate(shifts)))
    if clamped and space.mid_normals:
        parts.append(_slope_rows(curve, 0.5, triangles, placement))
    return parts


def _node_rows(
    space: Space,
    curve: EdgeCurve,
    triangles: Ints,
    placement: Deformation,
    directions: Floats,
    clamped: bool,
    shift: EdgeShift,
) -> list[Rows]:
    """Equations of a continuous space, at the nodes and Gauss points of the edges."""
    parts = []
    for share in np.linspace(0.0, 1.0, space.degree + 1):
        points, tangents = curve.along(share)
        value = _line_jets(tangents, np.zeros(len(points)))[0]
        moved = shift(points, curve.ends.mean(axis=1), tangents)[:, 0]
        for direction in directions:
            parts.append(Rows.at(triangles, points, value[:, :, None] * direction, placement, moved @ direction))
    if clamped:
        for root in np.polynomial.legendre.leggauss(space.degree)[0]:
            parts.append(_slope_rows(curve, 0.5 * (root + 1.0), triangles, placement))
    return parts


def _slope_rows(curve: EdgeCurve, share: float, triangles: Ints, placement: Deformation) -> Rows:
    """Equations of a clamp: the slope across the chord at a share of it.

    On plates with a closed form, the slope across the chord gives smaller errors than the slope across the curve.
    """
    chord = curve.ends[:, 1] - curve.ends[:, 0]
    points = curve.ends[:, 0] + share * chord
    across = _line_jets(chord / np.linalg.norm(chord, axis=1, keepdims=True), np.zeros(len(chord)))[3]
    return Rows.at(triangles, points, across[:, :, None] * placement.normal(points)[:, None], placement)


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
