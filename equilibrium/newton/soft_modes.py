"""The softest modes of an equilibrium, measured with a mass matrix: independent of the choice of unknowns."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor

GUARD_VECTORS = 1  # further vectors in every block, for multiple eigenvalues
EIGENVALUE_TOLERANCE = 1e-5  # relative change between blocks; the change after it is about its square
MAX_BLOCKS = 60  # usually fewer than ten; rounding errors can prevent convergence
ZERO_LENGTH_SQUARED = 1e-20  # of a vector that consists of rounding errors, over that of a unit vector


class MassOperator(Protocol):
    """A symmetric positive definite matrix, or an operator that acts like one."""

    def __matmul__(self, vectors: Floats) -> Floats:
        """Product (size, k) with vectors (size, k)."""


def softest_modes(mass: MassOperator, factor: Factor, rigid: Floats, count: int) -> tuple[Floats, Floats]:
    """Smallest eigenvalues (k,) of `H v = value M v` and their modes (size, k), with `v M v = 1`.

    Block Lanczos with the inverse of H (Golub and Underwood 1977); every block is orthogonal to all earlier ones.

    Parameters
    ----------
    mass : M (size, size), positive definite.
    factor : holds H on an isostatic support, positive definite (see `minimise.is_definite_on_support`).
    rigid : (size, r) motions that H maps to zero, left out of the modes; r may be 0.
    count : number of modes; the result has fewer if the problem has fewer.

    Examples
    --------
    >>> from asterism.equilibrium.linear.backends import make_factor
    >>> from asterism.equilibrium.linear.sparse_pattern import SparsePattern
    >>> pattern = SparsePattern([np.array([[0, 1], [1, 2]])], 3, np.arange(1, 3))  # the first unknown is held
    >>> data = pattern.assemble([np.array([[1.0, -1.0, 1.0], [1.0, -1.0, 1.0]])])
    >>> factor = make_factor(pattern, "superlu")
    >>> factor.factorise(data)
    True
    >>> values, modes = softest_modes(np.eye(2), factor, np.empty((2, 0)), 2)
    >>> values.round(4).tolist()
    [0.382, 2.618]
    """
    size, motions = rigid.shape
    count = min(count, size - motions)
    if count < 1:
        return np.empty(0), np.empty((size, 0))
    block = _unit(np.random.default_rng(0).standard_normal((size, count + GUARD_VECTORS)))
    zero = ZERO_LENGTH_SQUARED * float((block * (mass @ block)).sum(axis=0).max())
    # vectors v with v M v = 1, the rigid motions first; their images M v; and the displacements H^-1 M v
    vectors, images = _orthonormal(rigid, mass @ rigid, zero)
    solved = np.empty((size, 0))
    values, turn = np.empty(0), np.empty((0, 0))
    for _ in range(MAX_BLOCKS):
        block = _unit(block)
        for _ in range(2):  # one projection leaves too much of nearly parallel vectors
            block = block - vectors @ (images.T @ block)
        block, image = _orthonormal(block, mass @ block, zero)
        if not block.shape[1]:  # the whole space is used up
            break
        vectors, images = np.hstack([vectors, block]), np.hstack([images, image])
        # forces that do no work on rigid motions cause no reactions of the support
        block = factor.solve(image)
        solved = np.hstack([solved, block])
        previous = values
        inverse, turn = np.linalg.eigh(images[:, motions:].T @ solved)
        values, turn = 1.0 / inverse[: -count - 1 : -1], turn[:, : -count - 1 : -1]
        if len(values) == len(previous) and np.abs(values - previous).max() <= EIGENVALUE_TOLERANCE * abs(values[-1]):
            break
    return values, np.asarray(vectors[:, motions:] @ turn)


def _unit(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=0), np.finfo(float).tiny))


def _orthonormal(vectors: Floats, images: Floats, zero: float) -> tuple[Floats, Floats]:
    """Orthonormal combinations of vectors v (size, k), `v M v = 1`, and their images M v; zero vectors are left out."""
    square, turn = np.linalg.eigh(vectors.T @ images)
    kept = square > zero
    turn = turn[:, kept] / np.sqrt(square[kept])
    return vectors @ turn, images @ turn
