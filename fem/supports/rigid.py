"""Rigid motions that the supports of a shell leave free, and those among them that leave its energy unchanged."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints


def admissible_motions(x: Floats, shifts: Floats, columns: sp.csr_matrix, free: Ints) -> Floats:
    """(n, k) infinitesimal translations and rotations of a state x (N, 3) that satisfy the homogeneous supports.

    Parameters
    ----------
    shifts : (N,) coefficients of the function one.
    columns, free : map (3N, n) and numbers (n,) of the free unknowns, as in `fem.supports.conditions.Reduction`.
    """
    centred = x - shifts[:, None] * x[shifts != 0.0].mean(axis=0)
    centred /= np.sqrt((centred**2).mean()) + 1e-30  # scales rotations to the length of translations
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
    """Whether points (n, 3) do not lie on one line. Then fixing them prevents every rigid motion."""
    if len(points) < 3:
        return False
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(sizes[1] > 1e-3 * sizes[0])


def neutral_motions(motions: Floats, stiffness: Floats, load_gradient: Floats, min_stiffness: float) -> Floats:
    """(n, k) orthonormal combinations of orthonormal motions (n, j) along which loads do no work and stiffness is zero.

    A sheet that is fixed at one point can swing under its weight. To first order the swing does no work, but the weight
    gives it a stiffness, negative for a sheet above the point. Such a motion is not neutral and stays in the spectrum.

    Parameters
    ----------
    stiffness : (n, j) N/mm, Hessian times the motions.
    load_gradient : (n,) N, gradient of loads and moments.
    min_stiffness : N/mm, stiffness below which it counts as zero.
    """
    size = np.linalg.norm(load_gradient)
    work = motions.T @ load_gradient / size if size > 0.0 else np.zeros(motions.shape[1])
    # all rows are scaled so that the limit is 1
    # work along a unit motion over the norm of the loads, below which it counts as zero
    rows = np.concatenate([stiffness / min_stiffness, work[None] / 1e-6])
    _, values, directions = np.linalg.svd(rows, full_matrices=False)
    return np.asarray(motions @ directions[values < 1.0].T)
