"""A state of the exact model: positions of the vertices, directors of the rod edges and frames of the joints."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asterism.equilibrium.arrays import Array


@dataclass(frozen=True)
class State:
    """Positions, directors and frames. The energy depends on these alone, so states can be saved and restarted."""

    positions: Array  # (V, 3) mm
    directors: Array  # (R, 3) unit normal on the plastic side of every rod edge, orthogonal to the edge
    # (J, 3, 3) rotation of every joint; its rows are the images of the printed x, y and z axes.
    frames: Array = field(default_factory=lambda: np.empty((0, 3, 3)))

    @property
    def packed(self) -> Array:
        """(3 V + 3 R + 9 J,) positions, then directors, then frames."""
        return np.concatenate([self.positions.ravel(), self.directors.ravel(), self.frames.ravel()])

    def rotated(self, rotation: Array, shift: Array) -> State:
        """The state moved rigidly: `x @ rotation.T + shift` for positions."""
        return State(self.positions @ rotation.T + shift, self.directors @ rotation.T, self.frames @ rotation.T)


def edge_tangents(positions: Array, edges: Array) -> Array:
    """(R, 3) unit tangents of edges (R, 2) between positions (V, 3)."""
    e = positions[edges[:, 1]] - positions[edges[:, 0]]
    return np.asarray(e / np.sqrt((e * e).sum(axis=1, keepdims=True)))


def moved_state(state: State, edges: Array, positions: Array, turn: Array, spin: Array | None = None) -> State:
    """The state moved to new positions: parallel transport carries the directors along, then they rotate by `turn`.

    The frames of the joints rotate by `spin` alone.

    Complex numbers work as well, so that complex steps give derivatives.

    Parameters
    ----------
    edges : (R, 2) vertices of the rod edges.
    positions : (V, 3) mm.
    turn : (R,) rad, rotation of each director about its edge.
    spin : (J, 3) rad, rotation vector of each joint; by default they do not rotate.

    An edge along x is laid along z; its director follows, then rotates by 90 degrees:

    >>> edges, flat = np.array([[0, 1]]), State(np.array([[0, 0, 0], [1, 0, 0.0]]), np.array([[0, 0, 1.0]]))
    >>> upright = np.array([[0, 0, 0], [0, 0, 1.0]])
    >>> moved_state(flat, edges, upright, np.array([0.0])).directors.round(6) + 0.0
    array([[-1.,  0.,  0.]])
    >>> moved_state(flat, edges, upright, np.array([np.pi / 2])).directors.round(6) + 0.0
    array([[ 0., -1.,  0.]])
    """
    t1 = edge_tangents(positions, edges)
    d = parallel_transport(state.directors, edge_tangents(state.positions, edges), t1)
    d = np.cos(turn)[:, None] * d + np.sin(turn)[:, None] * np.cross(t1, d)
    frames = state.frames if spin is None else rotate_vectors(spin, state.frames)
    return State(positions, orthonormal_to_tangents(d, t1), frames)


def parallel_transport(directors: Array, before: Array, after: Array) -> Array:
    """(R, 3) directors after parallel transport from the unit tangents `before` (R, 3) to the unit tangents `after`."""
    along = (directors * after).sum(axis=1) / (1.0 + (before * after).sum(axis=1))
    return orthonormal_to_tangents(directors - along[:, None] * (before + after), after)


def orthonormal_to_tangents(directors: Array, along: Array) -> Array:
    """(R, 3) directors made orthogonal to the unit tangents `along` (R, 3) and of unit length."""
    d = directors - (directors * along).sum(axis=1, keepdims=True) * along
    return np.asarray(d / np.sqrt((d * d).sum(axis=1, keepdims=True)))


def rotate_vectors(spin: Array, vectors: Array) -> Array:
    """Vectors (E, k, 3) rotated by `exp(spin)`, spin (E, 3) rad.

    >>> rotate_vectors(np.array([[0, 0, np.pi / 2]]), np.array([[[1.0, 0, 0]]])).round(6) + 0.0
    array([[[0., 1., 0.]]])
    """
    sinc, versine, w = _rodrigues(spin)
    first = np.cross(w, vectors)
    return np.asarray(vectors + sinc * first + versine * np.cross(w, first))


def rotation_remainder(spin: Array, vectors: Array, change: Array) -> Array:
    """`exp(spin) (v + c) - (v + spin x v + c)` for vectors v and their changes c (E, k, 3), spin (E, 3) rad.

    This is the difference of a rotating step and a straight step. Its rounding error is relative to this difference.
    """
    sinc, versine, w = _rodrigues(spin)
    first, more = np.cross(w, vectors), np.cross(w, change)
    return np.asarray((sinc - 1.0) * first + sinc * more + versine * np.cross(w, first + more))


def _rodrigues(spin: Array) -> tuple[Array, Array, Array]:
    """sinc, versine and w (E, 1, 3) of Rodrigues' formula `exp(w) v = v + sinc w x v + versine w x (w x v)`."""
    angle = np.sqrt((spin**2).sum(axis=1))[:, None, None]
    return np.sinc(angle / np.pi), 0.5 * np.sinc(angle / (2.0 * np.pi)) ** 2, spin[:, None, :]
