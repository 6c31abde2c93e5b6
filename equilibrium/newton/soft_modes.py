"""The softest modes of an equilibrium, measured so that they do not depend on the unknowns."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from equilibrium.linear.factor import Factor
from equilibrium.linear.sparse_pattern import Floats

GUARD = 1  # a further vector in every block: multiple eigenvalues need as many vectors as they count
SETTLED = 1e-5  # relative change of the eigenvalues at which they are taken: the next one is its square, about
BLOCKS = 60  # at most, where rounding keeps them from settling; ten are many
NOTHING = 1e-20  # square of a length that is rounding, over that of a unit vector


class Mass(Protocol):
    """A symmetric matrix, or what acts like one."""

    def __matmul__(self, vectors: Floats) -> Floats:
        """Times vectors (size, k)."""


def soft_modes(mass: Mass, factor: Factor, rigid: Floats, count: int) -> tuple[Floats, Floats]:
    """(k,) smallest eigenvalues of `H v = value M v` and their modes (size, k), `v M v = 1`, rigid motions left out.

    By a block Lanczos method with the inverse of H (Golub and Underwood 1977), every block kept orthogonal to all.

    Parameters
    ----------
    mass : (size, size) M, positive definite.
    factor : holds H, positive definite, stiffened where it stops the rigid motions (an isostatic support).
    rigid : (size, r) motions that H maps to zero; r may be 0.
    count : modes wanted; fewer come back if there are fewer.
    """
    size, motions = rigid.shape
    count = min(count, size - motions)
    if count < 1:
        return np.empty(0), np.empty((size, 0))
    block = _unit(np.random.default_rng(0).standard_normal((size, count + GUARD)))
    least = NOTHING * float((block * (mass @ block)).sum(axis=0).max())
    # vectors of length 1 in M, the rigid motions first; their images M v; and what the forces M v do to the sheet
    vectors, images = _orthonormal(rigid, mass @ rigid, least)
    solved = np.empty((size, 0))
    values, turn = np.empty(0), np.empty((0, 0))
    for _ in range(BLOCKS):
        block = _unit(block)
        for _ in range(2):  # once leaves too much of what is nearly parallel
            block = block - vectors @ (images.T @ block)
        block, image = _orthonormal(block, mass @ block, least)
        if not block.shape[1]:  # these are all that there are
            break
        vectors, images = np.hstack([vectors, block]), np.hstack([images, image])
        # forces that do no work on rigid motions leave the support alone
        block = factor.solve(image)
        solved = np.hstack([solved, block])
        before = values
        inverse, turn = np.linalg.eigh(images[:, motions:].T @ solved)
        values, turn = 1.0 / inverse[: -count - 1 : -1], turn[:, : -count - 1 : -1]
        if len(values) == len(before) and np.abs(values - before).max() <= SETTLED * abs(values[-1]):
            break
    return values, vectors[:, motions:] @ turn


def _unit(vectors: Floats) -> Floats:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=0), np.finfo(float).tiny)


def _orthonormal(vectors: Floats, images: Floats, least: float) -> tuple[Floats, Floats]:
    """Combinations of vectors v (size, k) with `v M v = 1`, and their images M v; those below `least` are left out."""
    square, turn = np.linalg.eigh(vectors.T @ images)
    kept = square > least
    turn = turn[:, kept] / np.sqrt(square[kept])
    return vectors @ turn, images @ turn
