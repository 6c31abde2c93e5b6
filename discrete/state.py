"""A configuration of the exact model: positions and the rods' directors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from discrete.elements import Array


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


def tangents(positions: Array, edges: Array) -> Array:
    """(R, 3) unit vectors along the edges (R, 2)."""
    e = positions[edges[:, 1]] - positions[edges[:, 0]]
    return e / np.sqrt((e * e).sum(axis=1, keepdims=True))


def carried(state: State, edges: Array, positions: Array, turn: Array) -> State:
    """The state moved to `positions`: directors follow by parallel transport, then turn by `turn` (R,) rad.

    Works with complex numbers, so that derivatives along it can be taken by complex steps.
    """
    t0, t1 = tangents(state.positions, edges), tangents(positions, edges)
    along = (state.directors * t1).sum(axis=1) / (1.0 + (t0 * t1).sum(axis=1))
    d = state.directors - along[:, None] * (t0 + t1)
    d = np.cos(turn)[:, None] * d + np.sin(turn)[:, None] * np.cross(t1, d)
    d = d - (d * t1).sum(axis=1, keepdims=True) * t1
    return State(positions, d / np.sqrt((d * d).sum(axis=1, keepdims=True)))
