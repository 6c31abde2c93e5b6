"""Two-level multigrid in place of a factorisation: a fraction of its memory.

Aggregation (Vanek, Mandel and Brezina 1996) with the modes that the problem names, six rigid motions for a sheet. Nodes
that share an entry of the matrix are gathered around a root, some 15 vertices of a sheet together, and on each
aggregate the modes become the coarse unknowns. Gauss-Seidel sweeps smooth, and the coarse matrix, an eighth of the
size, is factorised directly. That preconditions conjugate gradients, and is positive definite by construction (forward
sweep before, backward sweep after), whatever the matrix. The prolongation itself is not smoothed: with the coarse level
solved exactly that saves a few iterations in a hundred, and takes twice the memory.

Three verdicts, in the order of their cost. A diagonal entry or a coarse matrix that is not positive proves that the
matrix is not positive definite: `factorise` says so. Negative curvature in `solve` proves it too: NotPositiveDefinite.
`proves_definite` shows the opposite.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from equilibrium.linear.conjugate_gradients import proves_definite, solved
from equilibrium.linear.sparse_pattern import Floats, Ints, SparsePattern

SMALLEST = 3000  # unknowns; below this the "coarse" level is the matrix itself
ACCURACY = 1e-10  # relative residual of a solve, unless asked for less
MAX_ITERATIONS = 2000


class MultigridFactor:
    """The interface of a factorisation, with conjugate gradients inside.

    Parameters
    ----------
    pattern : of the matrices.
    smallest : unknowns below which the matrix is factorised.

    Attributes
    ----------
    iterations : conjugate gradients' so far.
    """

    name = "amg"

    def __init__(self, pattern: SparsePattern, smallest: int = SMALLEST) -> None:
        import pyamg  # noqa: F401  # missing: said here, not in the middle of a run

        self._pattern = pattern
        self._direct = pattern.size < smallest
        self._nodes: Ints = np.arange(pattern.size)
        self._modes: Floats = np.ones((pattern.size, 1))
        self._aggregates: sp.csr_matrix | None = None
        self.iterations = 0

    def near_nullspace(self, nodes: Ints, modes: Floats) -> None:
        """Tell what the matrices nearly map to zero.

        nodes (size,): unknowns with the same number stay together, numbers from 0; modes (size, k). Without it every
        unknown is a node of its own and the mode is constant, which suits a Laplacian.
        """
        if self._aggregates is not None and not np.array_equal(nodes, self._nodes):
            self._aggregates = None
        self._nodes, self._modes = nodes, modes

    def factorise(self, data: Floats) -> bool:
        """Prepare for the matrix with these entries; False if it is known not to be positive definite."""
        from equilibrium.linear.factor import make_factor

        pattern = self._pattern
        if not np.isfinite(data).all() or (data[pattern.diagonal] <= 0.0).any():
            return False
        self._data = np.array(data)
        self._upper = pattern.lower(self._data)  # by columns; read by rows it is the upper triangle
        self.close()
        if self._direct:
            self._coarse = make_factor(pattern)
            return self._coarse.factorise(self._data)
        self._lower = self._upper.tocsr()
        self._diagonal = self._data[pattern.diagonal]
        self._prolong = self._prolongation()
        self._restrict = self._prolong.T.tocsr()
        galerkin = sp.tril(self._restrict @ self._times(self._prolong), format="csc")
        galerkin.sort_indices()
        self._coarse = make_factor(SparsePattern.of_lower(galerkin))
        return self._coarse.factorise(galerkin.data)

    def solve(self, b: Floats, tolerance: float = ACCURACY) -> Floats:
        """Solve to a relative residual, b (size,) or (size, k).

        Raises
        ------
        NotPositiveDefinite
            The matrix is not positive definite after all.
        """
        if self._direct:
            return self._coarse.solve(b)
        if b.ndim == 2:
            return np.column_stack([self.solve(column, tolerance) for column in b.T])
        x, spent = solved(self.product, self.precondition, np.asarray(b, dtype=float), tolerance, MAX_ITERATIONS)
        self.iterations += spent
        return x

    def proves_definite(self) -> bool:
        """True: the matrix is positive definite, but for one chance in 1e9 of the random start."""
        if self._direct:
            return True
        # the sweeps alone bound the preconditioner: M <= G G^T, G = (D + L) D^-1/2
        g = abs(self._lower @ sp.diags(self._diagonal**-0.5))
        bound = float(g.sum(axis=0).max() * g.sum(axis=1).max())
        return proves_definite(self.product, self.precondition, self._pattern.size, bound)

    def product(self, v: Floats) -> Floats:
        """Matrix times v (size,)."""
        return self._times(v)

    def precondition(self, b: Floats) -> Floats:
        """(size,) b through a sweep forwards, the coarse solution of what it leaves, and a sweep backwards."""
        from pyamg.amg_core import gauss_seidel

        b = np.ascontiguousarray(b, dtype=float)
        if self._direct:
            return self._coarse.solve(b)
        lower, upper, n = self._lower, self._upper, len(b)
        x = np.zeros(n)
        gauss_seidel(lower.indptr, lower.indices, lower.data, x, b, 0, n, 1)
        # after the forward sweep (D + L) x = b, so b - A x is the upper triangle's part alone
        x += self._prolong @ self._coarse.solve(self._restrict @ (self._diagonal * x - upper.T @ x))
        rest = b + self._diagonal * x - lower @ x
        gauss_seidel(upper.indptr, upper.indices, upper.data, x, rest, n - 1, -1, -1)
        return x

    def close(self) -> None:
        """Give the memory back."""
        if hasattr(self, "_coarse"):
            self._coarse.close()

    def _times(self, v: sp.csr_matrix | Floats) -> sp.csr_matrix | Floats:
        scaled = (self._diagonal * v.T).T if isinstance(v, np.ndarray) else sp.diags(self._diagonal) @ v
        return self._lower @ v + self._upper.T @ v - scaled

    def _prolongation(self) -> sp.csr_matrix:
        """(size, coarse) the modes on every aggregate, orthonormal there."""
        from pyamg.aggregation import fit_candidates
        from pyamg.aggregation.aggregate import standard_aggregation

        if self._aggregates is None:
            n = self._pattern.size
            member = sp.csr_matrix((np.ones(n, dtype=bool), (np.arange(n), self._nodes)))
            entries = (np.ones(self._pattern.nnz, dtype=bool), self._pattern.indices, self._pattern.indptr)
            low = sp.csc_matrix(entries, shape=(n, n))
            graph = member.T @ low @ member
            graph = (graph + graph.T).tocsr()
            self._aggregates = (member @ standard_aggregation(graph)[0]).tocsr().astype(float)
        tentative, _ = fit_candidates(self._aggregates, self._modes)
        tentative = tentative.tocsr()
        # where an aggregate has fewer unknowns than modes, the rest of its columns are zero
        used = np.flatnonzero(np.bincount(tentative.indices, np.abs(tentative.data), tentative.shape[1]))
        return tentative if len(used) == tentative.shape[1] else tentative[:, used]
