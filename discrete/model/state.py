"""A configuration of the exact model: positions and the rods' directors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from discrete.energies.elements import Array


@dataclass(frozen=True)
class State:
    """Positions and directors; together they are all that the energy depends on.

    Attributes
    ----------
    positions : (V, 3) mm.
    directors : (R, 3) unit plastic normal of every rod edge, orthogonal to it.
    """

    positions: Array
    directors: Array

    @property
    def packed(self) -> Array:
        """(3 V + 3 R,) positions, then directors."""
        return np.concatenate([self.positions.ravel(), self.directors.ravel()])


def edge_tangents(positions: Array, edges: Array) -> Array:
    """(R, 3) unit vectors along the edges (R, 2)."""
    e = positions[edges[:, 1]] - positions[edges[:, 0]]
    return np.asarray(e / np.sqrt((e * e).sum(axis=1, keepdims=True)))


def moved_state(state: State, edges: Array, positions: Array, turn: Array) -> State:
    """The state moved to `positions`: directors follow by parallel transport, then turn by `turn` (R,) rad.

    Works with complex numbers, so that derivatives along it can be taken by complex steps.
    """
    t1 = edge_tangents(positions, edges)
    d = parallel_transport(state.directors, edge_tangents(state.positions, edges), t1)
    d = np.cos(turn)[:, None] * d + np.sin(turn)[:, None] * np.cross(t1, d)
    return State(positions, orthonormal_to_tangents(d, t1))


def parallel_transport(directors: Array, before: Array, after: Array) -> Array:
    """(R, 3) directors carried by parallel transport from the unit tangents `before` (R, 3) to those `after`."""
    along = (directors * after).sum(axis=1) / (1.0 + (before * after).sum(axis=1))
    return orthonormal_to_tangents(directors - along[:, None] * (before + after), after)


def orthonormal_to_tangents(directors: Array, along: Array) -> Array:
    """(R, 3) directors with what they have along the unit tangents (R, 3) taken out, again of unit length."""
    d = directors - (directors * along).sum(axis=1, keepdims=True) * along
    return np.asarray(d / np.sqrt((d * d).sum(axis=1, keepdims=True)))
