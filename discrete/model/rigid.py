"""Infinitesimal rigid motions of a state, in the coordinates of the dofs."""

from __future__ import annotations

import numpy as np

from asterism.discrete.model.state import State, edge_tangents
from asterism.equilibrium.arrays import Array


def rigid_motions(state: State, edges: Array, held: Array, free: Array) -> Array:
    """(free, k) linearly independent rigid motions that move no held dof, k from 0 to 6.

    A rotation `w` of the body twists an edge with tangent t by `w . t` relative to parallel transport, and spins joints
    by `w`.

    Parameters
    ----------
    edges : (R, 2) vertices of the rod edges.
    held : (3 V + R + 3 J,) bool, dofs that do not move.
    free : indices of the other dofs.
    """
    n = len(state.positions)
    x = state.positions - state.positions.mean(axis=0)
    size = np.sqrt((x**2).sum(axis=1).mean()) + 1e-30  # scales rotations to the length of translations
    n_twists, n_joints = len(edges), len(state.frames)
    # one motion a row: short rows of a large array are slow
    modes = np.zeros((6, 3 * n + n_twists + 3 * n_joints))
    moves, twists = modes[:, : 3 * n].reshape(6, n, 3), modes[:, 3 * n : 3 * n + n_twists]
    spins = modes[:, 3 * n + n_twists :].reshape(6, n_joints, 3)
    twists[3:] = edge_tangents(state.positions, edges).T / size
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        moves[i, :, i] = 1.0
        # the cross product of axis i and the position
        moves[3 + i, :, j], moves[3 + i, :, k] = -x[:, k] / size, x[:, j] / size
        spins[3 + i, :, i] = 1.0 / size
    blocked = modes[:, held]
    if blocked.shape[1]:
        values, vectors = np.linalg.eigh(blocked @ blocked.T)
        modes = vectors[:, values < 1e-12 * blocked.shape[1]].T @ modes
    return modes[:, free].T


def rigid_modes(state: State, edges: Array, held: Array, free: Array) -> Array:
    """(free, k) orthonormal basis of `rigid_motions`."""
    return np.linalg.qr(rigid_motions(state, edges, held, free))[0]
