"""Steps that turn instead of stretching.

A straight Newton step stretches what it should rotate, at second order, and the stiff arms pay for it. Here the step
is split, triangle by triangle and rod edge by rod edge, into a spin `w` and the rest `S` of the velocity, followed as
`F(a) = exp(a w) (F + a S)`, and positions are put together again by least squares: one scalar Laplacian, factorised
once, with weights mu V on triangles and EA/l on rod edges. At a = 0 the curve has the Newton direction as its slope,
so descent and quadratic convergence stay.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from discrete.energies.elements import Array
from discrete.model.state import State, edge_tangents, moved_state, parallel_transport
from equilibrium.linear.backends import make_factor
from equilibrium.linear.factor import Factor
from equilibrium.linear.sparse_pattern import SparsePattern

MAX_STEP_ROTATION_RAD = 1.0  # rad in one step


class Reconstruction:
    """Positions from deformation gradients, by weighted least squares.

    The release at which the gradients and weights are taken only scales the measures.

    Parameters
    ----------
    triangles, edges : (T, 3) and (R, 2) vertices.
    gradients : (T, 3, 2) 1/mm, gradients of the shape functions of each triangle.
    weight : (T,) N mm, shear modulus times rest volume.
    edge_weight : (R,) N/mm, axial stiffness EA/l.
    held : (V, 3) bool, components of vertices that do not move.

    Raises
    ------
    ValueError
        Some vertices are connected to nothing.
    """

    def __init__(
        self, triangles: Array, edges: Array, gradients: Array, weight: Array, edge_weight: Array, held: Array
    ) -> None:
        self._triangles, self._edges = triangles, edges
        self._b, self._weight = gradients.copy(), weight.copy()
        self._edge_weight = edge_weight
        self._held = held
        self._components = self._factorise(len(held))

    def _factorise(self, n: int) -> list[tuple[Array, Array, Factor]]:
        """One Laplacian for each different set of held vertices among x, y and z: axes, free vertices, factor."""
        groups: dict[bytes, list[int]] = {}
        for c in range(3):
            groups.setdefault(self._held[:, c].tobytes(), []).append(c)
        out: list[tuple[Array, Array, Factor]] = []
        for axes in groups.values():
            held = self._held[:, axes[0]].copy()
            if not held.any():
                held[0] = True  # translations: put back by the mean
            free = np.flatnonzero(~held)
            pattern, data = self.laplacian(free)
            factor = make_factor(pattern)
            if not factor.factorise(data):
                raise ValueError("the mesh has parts that hang on nothing")
            out.append((np.array(axes), free, factor))
        return out

    def laplacian(self, free: Array) -> tuple[SparsePattern, Array]:
        """Pattern and entries (nnz,) of the Laplacian over the vertices that are free (indices)."""
        i, j = np.tril_indices(3)
        triangle = np.einsum("t,tik,tjk->tij", self._weight, self._b, self._b)[:, i, j]
        edge = self._edge_weight[:, None] * np.array([1.0, -1.0, 1.0])
        pattern = SparsePattern([self._triangles, self._edges], len(self._held), free)
        return pattern, pattern.assemble([triangle, edge])

    def displacements(self, triangle_lack: Array, edge_lack: Array) -> Array:
        """(V, 3) moves whose gradients are closest to what is lacking.

        triangle_lack (T, 3, 2) of the deformation gradients; edge_lack (R, 3) of the edge vectors. Held components do
        not move, and the mean of those that nothing holds does not either.
        """
        n = len(self._held)
        pull = np.zeros((n, 3))
        corner = np.einsum("t,tik,tck->tic", self._weight, self._b, triangle_lack)
        for c in range(3):
            pull[:, c] = np.bincount(self._triangles.ravel(), corner[:, :, c].ravel(), n)
            along = self._edge_weight * edge_lack[:, c]
            pull[:, c] += np.bincount(self._edges[:, 1], along, n)
            pull[:, c] -= np.bincount(self._edges[:, 0], along, n)
        out = np.zeros((n, 3))
        for axes, free, factor in self._components:
            out[np.ix_(free, axes)] = factor.solve(pull[np.ix_(free, axes)])
            if not self._held[:, axes[0]].any():
                out[:, axes] -= out[:, axes].mean(axis=0)
        return out

    def move_supports(self, state: State, guess: Array) -> State:
        """The state with its held components as in `guess` (V, 3), everything else deformed as little as possible."""
        f, e = self.gradients(state.positions - guess)
        positions = guess + self.displacements(f, e)
        return moved_state(state, self._edges, positions, np.zeros(len(e)))

    def fit_edges(self, positions: Array, edge_target: Array) -> Array:
        """(V, 3) positions with the gradients of the given ones, but rod edges like `edge_target` (R, 3)."""
        lack = edge_target - self.gradients(positions)[1]
        return positions + self.displacements(np.zeros((len(self._triangles), 3, 2)), lack)

    def path(self, state: State, move: Array, turn: Array) -> tuple[Callable[[float], State], float]:
        """Curve of states with slope `move` (V, 3), `turn` (R,), and the longest step along it.

        The Laplacian is solved for the difference to a straight step, which is of second order: solved for positions it
        would leave an error of 1e-10 mm, and the bending of small triangles would answer with 1e-6 N.
        """
        f, e = self.gradients(state.positions)
        df, de = self.gradients(move)
        spin = triangle_spin(f, df)
        columns = f.transpose(0, 2, 1)
        rate = df.transpose(0, 2, 1) - np.cross(spin[:, None, :], columns)
        t = edge_tangents(state.positions, self._edges)
        # with its part about the edge itself: without it the arms of a star would turn out of each other's way
        edge_spin = np.cross(t, de) / np.linalg.norm(e, axis=1, keepdims=True) + turn[:, None] * t
        edge_rate = (de * t).sum(axis=1, keepdims=True) * t

        def at(a: float) -> State:
            lack = rotation_remainder(a * spin, columns, a * rate).transpose(0, 2, 1)
            edge_lack = rotation_remainder(a * edge_spin, e[:, None, :], a * edge_rate[:, None, :])[:, 0, :]
            positions = state.positions + (a * move + self.displacements(lack, edge_lack))
            t_turned, directors = rotate_vectors(a * edge_spin, np.stack([t, state.directors], axis=1)).transpose(
                1, 0, 2
            )
            return State(positions, parallel_transport(directors, t_turned, edge_tangents(positions, self._edges)))

        fastest = np.sqrt(max((w**2).sum(axis=1).max(initial=0.0) for w in (spin, edge_spin)))
        return at, MAX_STEP_ROTATION_RAD / max(fastest, 1e-30)

    def gradients(self, positions: Array) -> tuple[Array, Array]:
        """Deformation gradients (T, 3, 2) of the triangles and edge vectors (R, 3)."""
        f = np.einsum("tic,tik->tck", positions[self._triangles], self._b)
        return f, positions[self._edges[:, 1]] - positions[self._edges[:, 0]]


def triangle_spin(f: Array, df: Array) -> Array:
    """(T, 3) angular velocity of triangles with deformation gradients f and rates df, (T, 3, 2).

    The tangent plane turns with its normal; about the normal it is the skew part of the velocity gradient.
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


def rotate_vectors(spin: Array, vectors: Array) -> Array:
    """Vectors (E, k, 3) turned by exp(spin), spin (E, 3) rad."""
    sinc, versine, w = _rodrigues(spin)
    first = np.cross(w, vectors)
    return np.asarray(vectors + sinc * first + versine * np.cross(w, first))


def rotation_remainder(spin: Array, vectors: Array, change: Array) -> Array:
    """`exp(spin) (v + c) - (v + spin x v + c)` of vectors and their changes (E, k, 3), spin (E, 3) rad.

    What a turning step has beyond a straight one; its rounding is that of the small quantities it is made of.
    """
    sinc, versine, w = _rodrigues(spin)
    first, more = np.cross(w, vectors), np.cross(w, change)
    return np.asarray((sinc - 1.0) * first + sinc * more + versine * np.cross(w, first + more))


def _rodrigues(spin: Array) -> tuple[Array, Array, Array]:
    """`exp(w) v = v + sinc w x v + versine w x (w x v)`: the two numbers, and w ready for vectors (E, k, 3)."""
    angle = np.sqrt((spin**2).sum(axis=1))[:, None, None]
    return np.sinc(angle / np.pi), 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2, spin[:, None, :]
