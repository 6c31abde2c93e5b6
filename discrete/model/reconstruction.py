"""Newton steps that rotate elements, and positions reconstructed from the gradients of the elements.

A straight step stretches to second order the elements that it should rotate, which costs much energy in stiff arms.
Here the velocity of every triangle and rod edge is split into a spin w and a remainder S, and its deformation gradient
follows `F(a) = exp(a w) (F + a S)`. Positions follow by least squares: one scalar Laplacian, factorised once, with
weights mu V on triangles and EA/l on rod edges. At a = 0 the slope of the curve is the Newton direction, so it descends
and converges quadratically.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.discrete.model.state import (
    State,
    edge_tangents,
    moved_state,
    parallel_transport,
    rotate_vectors,
    rotation_remainder,
)
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


class Reconstruction:
    """Positions from deformation gradients, by weighted least squares.

    The release of the model only scales gradients and weights, so one reconstruction serves all releases. Raises
    `ValueError` if a part of the mesh is connected to no support, or the free mesh has more than one part.

    Parameters
    ----------
    triangles : (T, 3) vertices.
    edges : (R, 2) vertices of the rod edges.
    gradients : (T, 3, 2) 1/mm, gradients of the shape functions of each triangle.
    weight : (T,) N mm, shear modulus times rest volume.
    edge_weight : (R,) N/mm, axial stiffness EA/l.
    held : (V, 3) bool, components of vertices that do not move.

    Half of a strip of two triangles is held; its free vertices follow a prescribed stretch of 10 % along x:

    >>> points = np.array([[0, 0], [0, 1], [1, 0], [1, 1.0]])
    >>> triangles, edges = np.array([[0, 2, 1], [2, 3, 1]]), np.empty((0, 2), dtype=int)
    >>> from asterism.pattern.geometry.planar import triangle_gradients
    >>> held = np.repeat([[True], [True], [False], [False]], 3, axis=1)
    >>> ones = np.ones(2)
    >>> solver = Reconstruction(triangles, edges, triangle_gradients(points, triangles), ones, np.empty(0), held)
    >>> stretch = np.zeros((2, 3, 2))
    >>> stretch[:, 0, 0] = 0.1
    >>> solver.displacements(stretch, np.empty((0, 3)))[2].round(6) + 0.0
    array([0.1, 0. , 0. ])
    """

    def __init__(
        self, triangles: Array, edges: Array, gradients: Array, weight: Array, edge_weight: Array, held: Array
    ) -> None:
        self._triangles, self._edges = triangles, edges
        self._b, self._weight = gradients.copy(), weight.copy()
        self._edge_weight = edge_weight
        self._held = held
        self._components = self._factorise()

    def _factorise(self) -> list[tuple[Array, Array, Factor]]:
        """A Laplacian for each distinct set of held vertices along x, y and z: axes, free vertices, factor."""
        groups: dict[bytes, list[int]] = {}
        for c in range(3):
            groups.setdefault(self._held[:, c].tobytes(), []).append(c)
        out: list[tuple[Array, Array, Factor]] = []
        for axes in groups.values():
            held = self._held[:, axes[0]].copy()
            if not held.any():
                held[0] = True  # removes the translation; `displacements` subtracts the mean
            free = np.flatnonzero(~held)
            pattern, data = self.laplacian(free)
            factor = make_factor(pattern)
            if not factor.factorise(data):
                raise ValueError("the mesh has parts that are not connected to the rest or to a support")
            out.append((np.array(axes), free, factor))
        return out

    def laplacian(self, free: Array) -> tuple[SparsePattern, Array]:
        """Pattern and entries (nnz,) of the Laplacian over the free vertices (indices)."""
        i, j = np.tril_indices(3)
        triangle = np.einsum("t,tik,tjk->tij", self._weight, self._b, self._b)[:, i, j]
        edge = self._edge_weight[:, None] * np.array([1.0, -1.0, 1.0])
        pattern = SparsePattern([self._triangles, self._edges], len(self._held), free)
        return pattern, pattern.assemble([triangle, edge])

    def displacements(self, gradient_change: Array, edge_change: Array) -> Array:
        """(V, 3) mm, displacements whose gradients are closest to prescribed changes.

        Held components do not move. Along an axis without supports the mean displacement is zero.

        Parameters
        ----------
        gradient_change : (T, 3, 2) change of the deformation gradients.
        edge_change : (R, 3) mm, change of the edge vectors.
        """
        n = len(self._held)
        rhs = np.zeros((n, 3))
        corner = np.einsum("t,tik,tck->tic", self._weight, self._b, gradient_change)
        for c in range(3):
            rhs[:, c] = np.bincount(self._triangles.ravel(), corner[:, :, c].ravel(), n)
            along = self._edge_weight * edge_change[:, c]
            rhs[:, c] += np.bincount(self._edges[:, 1], along, n)
            rhs[:, c] -= np.bincount(self._edges[:, 0], along, n)
        out = np.zeros((n, 3))
        for axes, free, factor in self._components:
            out[np.ix_(free, axes)] = factor.solve(rhs[np.ix_(free, axes)])
            if not self._held[:, axes[0]].any():
                out[:, axes] -= out[:, axes].mean(axis=0)
        return out

    def move_supports(self, state: State, guess: Array) -> State:
        """The state with its held components at those of `guess` (V, 3) mm, deformed as little as possible."""
        f, e = self.gradients(state.positions - guess)
        positions = guess + self.displacements(f, e)
        return moved_state(state, self._edges, positions, np.zeros(len(e)))

    def fit_edges(self, positions: Array, edge_target: Array) -> Array:
        """(V, 3) mm, positions changed so that rod edges are closest to `edge_target` (R, 3) mm."""
        change = edge_target - self.gradients(positions)[1]
        return positions + self.displacements(np.zeros((len(self._triangles), 3, 2)), change)

    def path(self, state: State, move: Array, turn: Array, spin: Array) -> tuple[Callable[[float], State], float]:
        """Curve of states with slope `move` (V, 3), `turn` (R,) and `spin` (J, 3), and the largest step along it.

        Joints turn by `exp(a spin)`.

        The Laplacian is solved for the difference to a straight step, which is of second order. Solved for positions,
        it would leave errors of 1e-10 mm, which cause bending forces of 1e-6 N in small triangles.
        """
        f, e = self.gradients(state.positions)
        df, de = self.gradients(move)
        triangle_turn = triangle_spin(f, df)
        columns = f.transpose(0, 2, 1)
        rate = df.transpose(0, 2, 1) - np.cross(triangle_turn[:, None, :], columns)
        t = edge_tangents(state.positions, self._edges)
        # with the spin about the edge itself; without it the arms of a star would separate at their junction
        edge_spin = np.cross(t, de) / np.linalg.norm(e, axis=1, keepdims=True) + turn[:, None] * t
        edge_rate = (de * t).sum(axis=1, keepdims=True) * t

        def state_at(a: float) -> State:
            change = rotation_remainder(a * triangle_turn, columns, a * rate).transpose(0, 2, 1)
            edge_change = rotation_remainder(a * edge_spin, e[:, None, :], a * edge_rate[:, None, :])[:, 0, :]
            positions = state.positions + (a * move + self.displacements(change, edge_change))
            frame = np.stack([t, state.directors], axis=1)
            rotated_t, directors = rotate_vectors(a * edge_spin, frame).transpose(1, 0, 2)
            carried = parallel_transport(directors, rotated_t, edge_tangents(positions, self._edges))
            return State(positions, carried, rotate_vectors(a * spin, state.frames))

        fastest = np.sqrt(max((w**2).sum(axis=1).max(initial=0.0) for w in (triangle_turn, edge_spin, spin)))
        # rad, largest rotation of an element in one step
        return state_at, 1.0 / max(fastest, 1e-30)

    def gradients(self, positions: Array) -> tuple[Array, Array]:
        """Deformation gradients (T, 3, 2) of the triangles and vectors (R, 3) mm of the rod edges."""
        f = np.einsum("tic,tik->tck", positions[self._triangles], self._b)
        return f, positions[self._edges[:, 1]] - positions[self._edges[:, 0]]


def triangle_spin(f: Array, df: Array) -> Array:
    """(T, 3) angular velocity of triangles with deformation gradients f and rates df, both (T, 3, 2).

    In the tangent plane it is the rotation of the normal; about the normal, the skew part of the velocity gradient.
    """
    f1, f2 = f[:, :, 0], f[:, :, 1]
    normal = np.cross(f1, f2)
    area = np.linalg.norm(normal, axis=1, keepdims=True)
    n = normal / area
    g1, g2 = np.cross(f2, n) / area, np.cross(n, f1) / area
    lift = (n[:, :, None] * df).sum(axis=1)
    turned = -lift[:, :1] * g1 - lift[:, 1:] * g2
    curl = np.cross(g1, df[:, :, 0]) + np.cross(g2, df[:, :, 1])
    return np.asarray(np.cross(n, turned) + 0.5 * (n * curl).sum(axis=1, keepdims=True) * n)
