"""Rigid motions that the supports of a shell leave free, and those among them that leave its energy unchanged."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem.elements.tabulation import Floats, Ints

MIN_WORK = 1e-6  # part of the norm of the loads: smaller work along a unit motion is zero


def admissible_motions(x: Floats, shifts: Floats, columns: sp.csr_matrix, free: Ints) -> Floats:
    """(n, k) infinitesimal translations and rotations of a state x (N, 3) that satisfy the homogeneous supports.

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
    """Whether points (n, 3) are not on one line: fixing them stops every rigid motion."""
    if len(points) < 3:
        return False
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(sizes[1] > 1e-3 * sizes[0])


def neutral_motions(motions: Floats, stiffness: Floats, push: Floats, least: float) -> Floats:
    """(n, k) orthonormal: the combinations of orthonormal motions (n, j) without work and without stiffness.

    A sheet that hangs from a point can swing. To first order the swing does no work, but weight gives it a stiffness,
    negative if the sheet is upside down. Such a motion is not neutral: it stays in the spectrum.

    Parameters
    ----------
    stiffness : (n, j) N/mm, the Hessian times the motions.
    push : (n,) N, the gradient of loads and moments.
    least : N/mm, smaller stiffnesses are zero.
    """
    size = np.linalg.norm(push)
    work = motions.T @ push / size if size > 0.0 else np.zeros(motions.shape[1])
    # both rows are scaled such that 1 is the limit
    rows = np.concatenate([stiffness / least, work[None] / MIN_WORK])
    _, values, directions = np.linalg.svd(rows, full_matrices=False)
    return np.asarray(motions @ directions[values < 1.0].T)
