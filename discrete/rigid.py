"""Rigid motions of a state."""

from __future__ import annotations

import numpy as np

from discrete.elements import Array
from discrete.state import State, tangents


def rigid_modes(state: State, edges: Array, held: Array, free: Array) -> Array:
    """(free, k) orthonormal infinitesimal rigid motions that move no held dof (k from 0 to 6).

    Turning the body by `w` turns an edge with tangent t by `w . t` beyond what parallel transport does.
    """
    n = len(state.positions)
    x = state.positions - state.positions.mean(axis=0)
    modes = np.zeros((3 * n + len(edges), 6))
    t = tangents(state.positions, edges)
    for i, axis in enumerate(np.eye(3)):
        modes[: 3 * n, i] = np.tile(axis, n)
        modes[: 3 * n, 3 + i] = np.cross(axis, x).ravel() / 10.0
        modes[3 * n :, 3 + i] = t @ axis / 10.0
    blocked = modes[held]
    if len(blocked):
        _, size, rows = np.linalg.svd(blocked, full_matrices=True)
        rank = int((size > 1e-8 * max(size[0], 1.0)).sum())
        modes = modes @ rows[rank:].T
    return np.linalg.qr(modes[free])[0]
