"""Rigid motions that the conditions of a shell leave free."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem.elements.tabulation import Floats, Ints

PUSHED = 1e-6  # of the loads: a smaller share of them does no work


def admissible_motions(x: Floats, shifts: Floats, columns: sp.csr_matrix, free: Ints) -> Floats:
    """(n, k) infinitesimal shifts and turns of a state x (N, 3) that the map of the free unknowns can follow.

    Parameters
    ----------
    shifts : (N,) coefficients of the function one.
    columns, free : the map (3N, n), and which components are its unknowns, as in `fem.supports.conditions.Reduction`.
    """
    centred = x - shifts[:, None] * x[shifts != 0.0].mean(axis=0)
    centred /= np.sqrt((centred**2).mean()) + 1e-30  # turns and shifts of about the same length
    motions = np.zeros((*x.shape, 6))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        motions[:, i, i] = shifts
        motions[:, j, 3 + i], motions[:, k, 3 + i] = -centred[:, k], centred[:, j]
    motions = motions.reshape(x.size, 6)
    reduced = motions[free]
    if columns.shape[1] == x.size:
        return reduced
    _, blocked, rows = np.linalg.svd(motions - columns @ reduced, full_matrices=False)
    return np.asarray(reduced @ rows[blocked < 1e-9 * np.sqrt(x.size)].T)


def span_a_plane(points: Floats) -> bool:
    """Whether points (n, 3) are not all on one line: holding them stops every rigid motion."""
    if len(points) < 3:
        return False
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(sizes[1] > 1e-3 * sizes[0])


def neutral_motions(motions: Floats, stiffness: Floats, push: Floats, least: float) -> Floats:
    """(n, k) orthonormal motions among orthonormal ones (n, j) that nothing pushes along and nothing resists.

    A sheet that hangs from a point swings: to first order that is a rigid motion without work, but its weight gives it
    a stiffness, negative where it stands on its head. Such a motion has to stay in the spectrum.

    Parameters
    ----------
    stiffness : (n, j) N/mm, the Hessian times the motions.
    push : (n,) N, the gradient of loads and moments.
    least : N/mm, a stiffness that is rounding, or the gradient's own.
    """
    size = np.linalg.norm(push)
    work = motions.T @ push / size if size > 0.0 else np.zeros(motions.shape[1])
    # a stiffness of one stands for a push worth the name
    rows = np.concatenate([stiffness / least, work[None] / PUSHED])
    _, values, directions = np.linalg.svd(rows, full_matrices=False)
    return np.asarray(motions @ directions[values < 1.0].T)
