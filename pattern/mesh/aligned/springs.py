"""A network of springs with some of its points given: every other point is the weighted mean of its neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from asterism.equilibrium.arrays import Floats, Ints

# small weight that keeps points in place if no path connects them to a known point
HOLDING_WEIGHT = 1e-9
# largest connected piece that is solved as a dense system
MAX_DENSE_POINTS = 64


def means_of_neighbours(edges: Ints, stiff: Floats, known: NDArray[np.bool_], values: Floats) -> Floats:
    """Values (n, 2), given at `known` points, continued to the others.

    Parameters
    ----------
    edges, stiff : (E, 2) pairs of points, each once, and (E,) the weight of each pair.
    """
    result = np.where(known[:, None], values, 0.0)
    free = np.flatnonzero(~known)
    if not len(free):
        return result
    number = np.full(len(known), -1)
    number[free] = np.arange(len(free))
    own, other = (np.concatenate([edges[:, k], edges[:, 1 - k]]) for k in (0, 1))
    pull = np.concatenate([stiff, stiff])
    of_free = ~known[own]
    row, to, pull = number[own[of_free]], other[of_free], pull[of_free]
    diagonal = np.bincount(row, pull, len(free)).astype(np.float64) + HOLDING_WEIGHT
    given = known[to]
    pulled = [np.bincount(row[given], pull[given] * v[to[given]], len(free)) for v in result.T]
    right = np.column_stack(pulled).astype(np.float64)
    inner = ~given
    row, column = row[inner], number[to[inner]]
    entries = -pull[inner]
    between = csc_array((entries, (row, column)), shape=(len(free), len(free)))
    pieces, piece = connected_components(between, directed=False)
    if np.bincount(piece).max() <= MAX_DENSE_POINTS:
        result[free] = _by_pieces(pieces, piece, diagonal, row, column, entries, right)
        return result
    every = np.arange(len(free))
    matrix = csc_array((np.r_[entries, diagonal], (np.r_[row, every], np.r_[column, every])), shape=between.shape)
    factor = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    result[free] = factor.solve(right)
    return result


def _by_pieces(
    pieces: int, piece: Ints, diagonal: Floats, row: Ints, column: Ints, entries: Floats, right: Floats
) -> Floats:
    """(n, 2) solution of a system that falls into pieces, all pieces of a size together."""
    size = np.bincount(piece, minlength=pieces)
    order = np.argsort(piece, kind="stable")
    place = np.empty(len(piece), dtype=np.int64)  # of a point in its piece
    place[order] = np.arange(len(piece)) - np.repeat(np.cumsum(size) - size, size)
    out = np.empty_like(right)
    for one in np.unique(size):
        which = np.flatnonzero(size == one)
        number = np.full(pieces, -1)
        number[which] = np.arange(len(which))
        own = order[number[piece[order]] >= 0]
        matrix = np.zeros((len(which), one, one))
        matrix[number[piece[own]], place[own], place[own]] = diagonal[own]
        inside = number[piece[row]] >= 0
        i, j = row[inside], column[inside]
        matrix[number[piece[i]], place[i], place[j]] = entries[inside]
        out[own] = np.linalg.solve(matrix, right[own].reshape(len(which), one, 2)).reshape(-1, 2)
    return out
