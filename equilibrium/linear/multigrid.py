"""Conjugate gradients with two-level multigrid, with the interface of a factorisation: slower, but of little memory.

Aggregation (Vanek, Mandel and Brezina 1996) with the near nullspace of the problem: the six rigid motions for a sheet.
Nodes that share a matrix entry are gathered around a root, about 15 vertices of a sheet together. On each aggregate the
modes of the near nullspace become the coarse unknowns. Gauss-Seidel sweeps smooth the error, and the coarse matrix, an
eighth of the size, is factorised directly. This two-level cycle preconditions conjugate gradients. It is positive
definite by construction for every matrix, because it sweeps forwards before and backwards after the coarse solution.
The prolongation is not smoothed: with an exact coarse solution, smoothing saves a few percent of the iterations and
doubles the memory.

Three tests for positive definiteness, in the order of their cost:

1. `factorise` refuses a matrix with a diagonal entry or a coarse matrix that is not positive.
2. `solve` raises NotPositiveDefiniteError if it meets negative curvature.
3. `proves_definite` proves that the matrix is positive definite.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern

MIN_UNKNOWNS = 3000  # smaller matrices are factorised directly, without a coarse level
MAX_ITERATIONS = 2000


class MultigridFactor:
    """Preconditioned conjugate gradients as an `IterativeFactor`.

    Parameters
    ----------
    pattern : sparsity pattern of the matrices.
    make_coarse : makes the factorisation of the coarse matrix for its pattern.
    min_unknowns : smaller matrices are factorised directly.
    """

    name = "amg"

    def __init__(
        self,
        pattern: SparsePattern,
        make_coarse: Callable[[SparsePattern], Factor],
        min_unknowns: int = MIN_UNKNOWNS,
    ) -> None:
        import pyamg  # noqa: F401  # raises ImportError before a run, not during it

        self._pattern, self._make_coarse = pattern, make_coarse
        self._direct = pattern.size < min_unknowns
        self._nodes: Ints = np.arange(pattern.size)
        self._modes: Floats = np.ones((pattern.size, 1))
        self._aggregates: sp.csr_matrix | None = None
        self.iterations = 0  # of conjugate gradients, in all solutions together

    def set_near_nullspace(self, nodes: Ints, modes: Floats) -> None:
        """Set the modes (size, k) that the matrices nearly map to zero.

        `nodes` (size,), from 0: unknowns with equal numbers stay together. By default every unknown is a node and the
        mode is constant, as a Laplacian needs it.
        """
        if self._aggregates is not None and not np.array_equal(nodes, self._nodes):
            self._aggregates = None
        self._nodes, self._modes = nodes, modes

    def factorise(self, data: Floats) -> bool:
        """Prepare for the matrix with entries `data` (nnz,); False if it is known not to be positive definite."""
        pattern = self._pattern
        if not np.isfinite(data).all() or (data[pattern.diagonal] <= 0.0).any():
            return False
        self._data = np.array(data)
        self._upper = pattern.lower(self._data)  # by columns; read by rows it is the upper triangle
        self.close()
        if self._direct:
            self._coarse = self._make_coarse(pattern)
            return self._coarse.factorise(self._data)
        self._lower = self._upper.tocsr()
        self._diagonal = self._data[pattern.diagonal]
        self._prolong = self._prolongation()
        self._restrict = self._prolong.T.tocsr()
        galerkin = sp.tril(self._restrict @ self._times(self._prolong), format="csc")
        galerkin.sort_indices()
        self._coarse = self._make_coarse(SparsePattern.from_lower(galerkin))
        return self._coarse.factorise(galerkin.data)

    def solve(self, b: Floats, tolerance: float = 1e-10) -> Floats:
        """Solution of A x = b up to a relative residual; b (size,) or (size, k).

        Raises `NotPositiveDefiniteError` if the iteration meets negative curvature.
        """
        if self._direct:
            return self._coarse.solve(b)
        if b.ndim == 2:
            return np.column_stack([self.solve(column, tolerance) for column in b.T])
        x, iterations = solve_by_conjugate_gradients(
            self.product, self.precondition, np.asarray(b, dtype=float), tolerance, MAX_ITERATIONS
        )
        self.iterations += iterations
        return x

    def proves_definite(self) -> bool:
        """True if the matrix is proven positive definite, with a failure probability of 1e-9."""
        if self._direct:
            return True
        # the sweeps alone bound the preconditioner: M <= G G^T, G = (D + L) D^-1/2
        g = abs(self._lower @ sp.diags(self._diagonal**-0.5))
        bound = float(g.sum(axis=0).max() * g.sum(axis=1).max())
        return proves_definite(self.product, self.precondition, self._pattern.size, bound)

    def product(self, v: Floats) -> Floats:
        """Product (size,) of the matrix with v (size,)."""
        return self._times(v)

    def precondition(self, b: Floats) -> Floats:
        """Two-level cycle (size,): a forward sweep, the coarse solution for the residual, a backward sweep."""
        from pyamg.amg_core import gauss_seidel

        b = np.ascontiguousarray(b, dtype=float)
        if self._direct:
            return self._coarse.solve(b)
        lower, upper, n = self._lower, self._upper, len(b)
        x = np.zeros(n)
        gauss_seidel(lower.indptr, lower.indices, lower.data, x, b, 0, n, 1)
        # after the forward sweep (D + L) x = b, so b - A x is the upper triangle's part alone
        x += self._prolong @ self._coarse.solve(self._restrict @ (self._diagonal * x - upper.T @ x))
        remainder = b + self._diagonal * x - lower @ x
        gauss_seidel(upper.indptr, upper.indices, upper.data, x, remainder, n - 1, -1, -1)
        return x

    def close(self) -> None:
        """Free the memory."""
        if hasattr(self, "_coarse"):
            self._coarse.close()

    def _times(self, v: sp.csr_matrix | Floats) -> sp.csr_matrix | Floats:
        scaled = (self._diagonal * v.T).T if isinstance(v, np.ndarray) else sp.diags(self._diagonal) @ v
        return self._lower @ v + self._upper.T @ v - scaled

    def _prolongation(self) -> sp.csr_matrix:
        """(size, coarse) the modes restricted to each aggregate, orthonormal there."""
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
        # an aggregate with fewer unknowns than modes leaves zero columns
        used = np.flatnonzero(np.bincount(tentative.indices, np.abs(tentative.data), tentative.shape[1]))
        return tentative if len(used) == tentative.shape[1] else tentative[:, used]


Operator = Callable[[Floats], Floats]

# probability that a random vector has a smaller part along a direction than `proves_definite` assumes
FAILURE_PROBABILITY = 1e-9


class NotPositiveDefiniteError(ArithmeticError):
    """The iteration met a direction whose curvature is not positive: the matrix is not positive definite."""


class ConjugateGradients:
    """Preconditioned conjugate gradients for A x = b from x = 0 (Saad 2003, algorithm 9.1).

    Parameters
    ----------
    product : v -> A v, A symmetric.
    precondition : v -> M^-1 v, M symmetric and positive definite.
    b : (size,) right-hand side.
    """

    def __init__(self, product: Operator, precondition: Operator, b: Floats) -> None:
        self._product, self._precondition = product, precondition
        self.x = np.zeros_like(b)  # (size,) the present solution and b - A x
        self.residual = b.copy()
        z = precondition(b)
        self._direction = z
        self.energy = float(b @ z)  # `r . M^-1 r` of the residual r
        self.step_length = 0.0  # of the last step; it lies between the inverses of the extreme eigenvalues of M^-1 A

    def step(self) -> None:
        """One iteration.

        Raises `NotPositiveDefiniteError` if the curvature along the next direction is not positive.
        """
        p = self._direction
        image = self._product(p)
        curvature = float(p @ image)
        if not curvature > 0.0:
            raise NotPositiveDefiniteError
        self.step_length = self.energy / curvature
        self.x += self.step_length * p
        self.residual -= self.step_length * image
        z = self._precondition(self.residual)
        energy = float(self.residual @ z)
        self._direction = z + (energy / self.energy) * p
        self.energy = energy


def solve_by_conjugate_gradients(
    product: Operator, precondition: Operator, b: Floats, tolerance: float, max_iterations: int
) -> tuple[Floats, int]:
    """Solution x (size,) with `|b - A x| <= tolerance |b|`, and the number of iterations.

    After `max_iterations` the last x is returned. It still is a descent direction of the energy with gradient -b.

    >>> A = np.array([[2.0, 1.0], [1.0, 3.0]])
    >>> x, iterations = solve_by_conjugate_gradients(A.dot, np.copy, np.array([1.0, 0.0]), 1e-12, 10)
    >>> x.round(6).tolist(), iterations
    ([0.6, -0.2], 2)
    """
    goal = tolerance * float(np.linalg.norm(b))
    if goal == 0.0:
        return np.zeros_like(b), 0
    run = ConjugateGradients(product, precondition, b)
    for k in range(1, max_iterations + 1):
        run.step()
        if np.linalg.norm(run.residual) <= goal:
            return run.x, k
    return run.x, max_iterations


def proves_definite(product: Operator, precondition: Operator, size: int, norm_bound: float, seed: int = 0) -> bool:
    """Whether A is proven positive definite, up to the probability FAILURE_PROBABILITY.

    False means that A is indefinite or that no proof was found.

    Conjugate gradients multiply the residual's part along an eigenvector of M^-1 A by `p(value)`. The polynomial p is 1
    at zero, and its roots, the Ritz values, are positive as long as all curvatures are positive. An eigenvalue that is
    not positive has p >= 1, so its part of the residual never decreases. A residual below the smallest part that a
    random right-hand side has along any direction therefore excludes such an eigenvalue. For normally distributed g
    this part is `xi^2 / |M|` in the norm `g . M^-1 g`, with a normally distributed number xi.

    Parameters
    ----------
    product, precondition : v -> A v and v -> M^-1 v; M is known to be positive definite.
    size : number of unknowns.
    norm_bound : upper bound of |M|.
    seed : of the random right-hand side.
    """
    run = ConjugateGradients(product, precondition, np.random.default_rng(seed).standard_normal(size))
    # P(|xi| < t) <= 0.8 t
    smallest_part = (FAILURE_PROBABILITY / 0.8) ** 2 / norm_bound
    shortest, first_energy = np.inf, run.energy
    try:
        for _ in range(3000):
            run.step()
            shortest = min(shortest, run.step_length)
            # a curvature that may be zero, or a residual dominated by amplified rounding errors: its energy grew by
            # more than the condition number of a useful preconditioner
            if run.step_length > shortest / 1e-10 or run.energy > 1e6 * first_energy:
                return False
            if run.energy < smallest_part:
                return True
    except NotPositiveDefiniteError:
        pass
    return False
