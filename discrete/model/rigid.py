"""Infinitesimal rigid motions of a state, in the coordinates of the dofs."""

from __future__ import annotations

import numpy as np

from discrete.model.state import State, edge_tangents
from equilibrium.arrays import Array


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
    modes = np.zeros((3 * n + n_twists + 3 * n_joints, 6))
    t = edge_tangents(state.positions, edges)
    for i, axis in enumerate(np.eye(3)):
        modes[: 3 * n, i] = np.tile(axis, n)
        modes[: 3 * n, 3 + i] = np.cross(axis, x).ravel() / size
        modes[3 * n : 3 * n + n_twists, 3 + i] = t @ axis / size
        modes[3 * n + n_twists :, 3 + i] = np.tile(axis, n_joints) / size
    blocked = modes[held]
    if len(blocked):
        gram = blocked.T @ blocked
        values, vectors = np.linalg.eigh(gram)
        modes = modes @ vectors[:, values < 1e-12 * len(blocked)]
    return modes[free]


def rigid_modes(state: State, edges: Array, held: Array, free: Array) -> Array:
    """(free, k) orthonormal basis of `rigid_motions`."""
    return np.linalg.qr(rigid_motions(state, edges, held, free))[0]
