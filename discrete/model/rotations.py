"""Rotations of many vectors at once, by rotation vectors."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Array


def rotate_vectors(spin: Array, vectors: Array) -> Array:
    """Vectors (E, k, 3) rotated by `exp(spin)`, spin (E, 3) rad.

    Examples
    --------
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
