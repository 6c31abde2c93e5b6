"""Steps that turn instead of stretching.

A straight Newton step stretches what it should rotate, at second order, and the stiff arms pay for it. Here the step
is split, triangle by triangle and rod edge by rod edge, into a spin `w` and the rest `S` of the velocity, followed as
`F(a) = exp(a w) (F + a S)`, and positions are put together again by least squares: one scalar Laplacian, factorised
once, with weights mu V on triangles and EA/l on rod edges. At a = 0 the curve has the Newton direction as its slope,
so descent and quadratic convergence stay.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from discrete.elements import Array
from discrete.state import State, carried, tangents
from equilibrium.factor import Factor, make_factor
from equilibrium.sparse_pattern import SparsePattern

if TYPE_CHECKING:
    from discrete.model import Model

LARGEST_TURN = 1.0  # rad in one step


class Reconstruction:
    """Positions from deformation gradients, for one model; the release it was made at only scales its measures."""

    def __init__(self, model: Model) -> None:
        self._triangles, self._edges = model.mesh.triangles, model.network.edges
        params = model.parts["membrane"].params
        self._b = params[:, :6].reshape(-1, 3, 2).copy()
        self._weight = params[:, 6].copy()
        ea, length = model.parts["rod_stretch"].params.T
        self._edge_weight = ea / length
        self._held = model.constraints.held
        self._components = self._factorise(model.n_vertices)

    def _factorise(self, n: int) -> list[tuple[Array, Array, Factor, SparsePattern, Array]]:
        """One Laplacian for each different set of held vertices among x, y and z."""
        i, j = np.tril_indices(3)
        triangle = np.einsum("t,tik,tjk->tij", self._weight, self._b, self._b)[:, i, j]
        edge = self._edge_weight[:, None] * np.array([1.0, -1.0, 1.0])
        groups: dict[bytes, list[int]] = {}
        for c in range(3):
            groups.setdefault(self._held[:, c].tobytes(), []).append(c)
        out: list[tuple[Array, Array, Factor, SparsePattern, Array]] = []
        everything = SparsePattern([self._triangles, self._edges], n, np.arange(n))
        whole = everything.assemble([triangle, edge])
        for axes in groups.values():
            held = self._held[:, axes[0]].copy()
            if not held.any():
                held[0] = True  # translations: put back by the mean
            free = np.flatnonzero(~held)
            pattern = SparsePattern([self._triangles, self._edges], n, free)
            factor = make_factor(pattern)
            if not factor.factorise(pattern.assemble([triangle, edge])):
                raise ValueError("the mesh has parts that hang on nothing")
            out.append((np.array(axes), free, factor, everything, whole))
        return out

    def solve(self, triangle_target: Array, edge_target: Array, guess: Array, mean: Array) -> Array:
        """(V, 3) positions whose gradients are closest to the targets.

        triangle_target (T, 3, 2) deformation gradients; edge_target (R, 3) edge vectors; guess (V, 3) gives held
        components; mean (3,) gives the mean of components that nothing holds.
        """
        rhs = np.zeros_like(guess)
        corner = np.einsum("t,tik,tck->tic", self._weight, self._b, triangle_target)
        for c in range(3):
            rhs[:, c] = np.bincount(self._triangles.ravel(), corner[:, :, c].ravel(), len(guess))
            pull = self._edge_weight * edge_target[:, c]
            rhs[:, c] += np.bincount(self._edges[:, 1], pull, len(guess))
            rhs[:, c] -= np.bincount(self._edges[:, 0], pull, len(guess))
        out = guess.copy()
        for axes, free, factor, everything, whole in self._components:
            start = guess[:, axes]
            residual = rhs[:, axes] - everything.product(whole, start)
            out[np.ix_(free, axes)] += factor.solve(residual[free])
            if not self._held[:, axes[0]].any():
                out[:, axes] += mean[axes] - out[:, axes].mean(axis=0)
        return out

    def moved(self, state: State, guess: Array) -> State:
        """The state with its held components as in `guess` (V, 3), everything else deformed as little as possible."""
        f = np.einsum("tic,tik->tck", state.positions[self._triangles], self._b)
        e = state.positions[self._edges[:, 1]] - state.positions[self._edges[:, 0]]
        positions = self.solve(f, e, guess, state.positions.mean(axis=0))
        return carried(state, self._edges, positions, np.zeros(len(e)))

    def fitted(self, positions: Array, edge_target: Array) -> Array:
        """(V, 3) positions with the gradients of the given ones, but rod edges like `edge_target` (R, 3)."""
        f = np.einsum("tic,tik->tck", positions[self._triangles], self._b)
        return self.solve(f, edge_target, positions, positions.mean(axis=0))

    def path(self, state: State, move: Array, turn: Array) -> tuple[Callable[[float], State], float]:
        """Curve of states with slope `move` (V, 3), `turn` (R,), and the longest step along it."""
        f = np.einsum("tic,tik->tck", state.positions[self._triangles], self._b)
        df = np.einsum("tic,tik->tck", move[self._triangles], self._b)
        spin = triangle_spin(f, df)
        rate = df - np.cross(spin[:, None, :], f.transpose(0, 2, 1)).transpose(0, 2, 1)
        e = state.positions[self._edges[:, 1]] - state.positions[self._edges[:, 0]]
        de = move[self._edges[:, 1]] - move[self._edges[:, 0]]
        t = tangents(state.positions, self._edges)
        edge_spin = np.cross(t, de) / np.linalg.norm(e, axis=1, keepdims=True)
        edge_rate = (de * t).sum(axis=1, keepdims=True) * t
        centre, drift = state.positions.mean(axis=0), move.mean(axis=0)

        def at(a: float) -> State:
            target = rotated(a * spin, (f + a * rate).transpose(0, 2, 1)).transpose(0, 2, 1)
            edge_target = rotated(a * edge_spin, (e + a * edge_rate)[:, None, :])[:, 0, :]
            positions = self.solve(target, edge_target, state.positions + a * move, centre + a * drift)
            return carried(state, self._edges, positions, a * turn)

        fastest = max(
            np.sqrt((spin**2).sum(axis=1).max()),
            np.sqrt((edge_spin**2).sum(axis=1).max(initial=0.0)),
            np.abs(turn).max(initial=0.0),
        )
        return at, LARGEST_TURN / max(fastest, 1e-30)


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
    return np.cross(n, turned) + 0.5 * (n * curl).sum(axis=1, keepdims=True) * n


def rotated(spin: Array, vectors: Array) -> Array:
    """Vectors (E, k, 3) turned by exp(spin), spin (E, 3) rad (Rodrigues)."""
    angle = np.sqrt((spin**2).sum(axis=1))[:, None, None]
    sinc = np.sinc(angle / np.pi)
    versine = 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2
    w = np.broadcast_to(spin[:, None, :], vectors.shape)
    first = np.cross(w, vectors)
    return vectors + sinc * first + versine * np.cross(w, first)
