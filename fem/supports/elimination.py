"""Elimination of linear equations: the solutions of `A x = b` are `x = T q + c`, where q are some of the unknowns."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import qr
from scipy.sparse.csgraph import connected_components

from asterism.equilibrium.arrays import Floats, Ints

COEFFICIENT_DIGITS = 10  # decimals of coefficients scaled to a maximum of 1; equal blocks are then solved once
MIN_PIVOT = 1e-9  # over the largest pivot; a smaller one belongs to a redundant equation


@dataclass(frozen=True)
class Elimination:
    """x = map q + constant.

    Attributes
    ----------
    map : (n, len(free)); rows of the free unknowns are those of the identity.
    constant : (n, k), one column for each right-hand side.
    free : numbers of the unknowns that are kept, sorted.
    """

    map: sp.csr_matrix
    constant: Floats
    free: Ints


class Contradiction(ValueError):
    """The equations have no solution; `row` is the worst equation and `miss` its residual."""

    def __init__(self, row: int, miss: float) -> None:
        super().__init__(f"equation {row} is off by {miss:.3g}")
        self.row, self.miss = row, miss


def eliminate(matrix: sp.csr_matrix, right: Floats, tolerance: float) -> Elimination:
    """Solve equations `matrix x = right` for as many unknowns as they determine.

    Blocks of equations that share unknowns are solved separately, by QR with column pivoting.

    Parameters
    ----------
    matrix : (R, n) coefficients.
    right : (R, k) right-hand sides.
    tolerance : largest residual of a redundant equation, scaled to a largest coefficient of 1.

    Raises
    ------
    Contradiction
        The equations have no solution.

    Examples
    --------
    `x0 + x1 = 2`, twice, leaves x1 and x2 free:

    >>> solved = eliminate(sp.csr_matrix([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0]]), np.array([[2.0], [4.0]]), 1e-9)
    >>> solved.free.tolist()
    [1, 2]
    >>> (solved.map @ np.array([0.5, 7.0]) + solved.constant[:, 0]).round(6)
    array([1.5, 0.5, 7. ])
    """
    matrix = sp.csr_matrix(matrix)
    matrix.sum_duplicates()
    largest = abs(matrix).max(axis=1).toarray().ravel() if matrix.shape[0] else np.empty(0)
    empty = largest == 0.0
    wrong = empty & ~(np.abs(right).max(axis=1) <= tolerance)  # nan too
    if wrong.any():
        row = int(wrong.argmax())
        raise Contradiction(row, float(np.abs(right[row]).max()))
    scale = np.where(empty, 1.0, largest)
    matrix = sp.csr_matrix(sp.diags_array(1.0 / scale) @ matrix)
    matrix.data = np.round(matrix.data, COEFFICIENT_DIGITS)
    matrix.eliminate_zeros()
    right = right / scale[:, None]
    size = matrix.shape[1]
    constant = np.zeros((size, right.shape[1]))
    eliminated = np.zeros(size, dtype=bool)
    rows_out: list[Ints] = []
    columns_out: list[Ints] = []
    entries_out: list[Floats] = []
    equal_blocks: dict[tuple[int, bytes], list[tuple[Ints, Ints]]] = {}  # such as the components of a vector
    for rows, columns, block in _blocks(matrix):
        equal_blocks.setdefault((len(rows), block.tobytes()), []).append((rows, columns))
    for (height, entries), places in equal_blocks.items():
        rows, columns = (np.array(part) for part in zip(*places, strict=True))  # a block in each row
        solved = _solve(np.frombuffer(entries).reshape(height, -1))
        given = right[rows]
        miss = np.abs(given - solved.q @ (solved.q.T @ given)).max(axis=2)
        if not miss.max() <= tolerance:  # nan too
            worst = np.unravel_index(miss.argmax(), miss.shape)
            raise Contradiction(int(rows[worst]), float(miss[worst]))
        pivots = columns[:, solved.pivots]
        eliminated[pivots] = True
        constant[pivots] = solved.given @ given
        rows_out.append(pivots[:, solved.row].ravel())
        columns_out.append(columns[:, solved.column].ravel())
        entries_out.append(np.tile(solved.weight, len(rows)))
    free = np.flatnonzero(~eliminated)
    number = np.full(size, -1)
    number[free] = np.arange(len(free))
    rows_out.append(free)
    columns_out.append(free)
    entries_out.append(np.ones(len(free)))
    where = (np.concatenate(rows_out), number[np.concatenate(columns_out)])
    mapping = sp.csr_matrix((np.concatenate(entries_out), where), shape=(size, len(free)))
    return Elimination(mapping, constant, free)


@dataclass(frozen=True)
class _Solved:
    """A block of equations, solved: `x[pivots] = given @ right + W x`, W with entries (row, column, weight).

    The columns of `q` are an orthonormal basis of the range of the block.
    """

    q: Floats
    given: Floats
    pivots: Ints
    row: Ints
    column: Ints
    weight: Floats


def _solve(block: Floats) -> _Solved:
    """Solve a block by QR with column pivoting."""
    q, r, order = qr(block, mode="economic", pivoting=True, check_finite=False)
    rank = int(np.sum(np.abs(np.diag(r)) > MIN_PIVOT * abs(r[0, 0])))
    q = q[:, :rank]
    solved = np.linalg.solve(r[:rank, :rank], np.hstack([q.T, -r[:rank, rank:]]))
    given, weights = solved[:, : len(block)], solved[:, len(block) :]
    i, j = np.nonzero(np.abs(weights) >= 10.0**-COEFFICIENT_DIGITS)
    return _Solved(q, given, order[:rank], i, order[rank:][j], weights[i, j])


def _blocks(matrix: sp.csr_matrix) -> Iterator[tuple[Ints, Ints, Floats]]:
    """Rows, columns and dense entries of the diagonal blocks of a matrix, after a permutation."""
    count = matrix.shape[0]
    entries = matrix.tocoo()
    graph = sp.coo_matrix((np.ones(entries.nnz), (entries.row, count + entries.col)), shape=(sum(matrix.shape),) * 2)
    kinds, label = connected_components(graph, directed=False)
    order = np.argsort(label, kind="stable")  # rows first within a block
    ends = np.searchsorted(label[order], np.arange(kinds + 1))
    place = np.empty_like(order)
    place[order] = np.arange(len(order)) - ends[label[order]]
    of_block = np.argsort(label[entries.row], kind="stable")
    stops = np.searchsorted(label[entries.row][of_block], np.arange(kinds + 1))
    i, j, values = place[entries.row[of_block]], place[count + entries.col[of_block]], entries.data[of_block]
    for kind in np.flatnonzero(np.diff(stops)):
        members = order[ends[kind] : ends[kind + 1]]
        height = int(np.searchsorted(members, count))
        block = np.zeros((height, len(members) - height))
        part = slice(stops[kind], stops[kind + 1])
        block[i[part], j[part] - height] = values[part]
        yield members[:height], members[height:] - count, block
