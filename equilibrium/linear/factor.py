"""One small interface to sparse factorisations of symmetric matrices.

A backend keeps what depends on the pattern alone between factorisations, and says whether the matrix was positive
definite: a Newton step needs to know, and some solvers accept an indefinite matrix silently.
"""

from __future__ import annotations

import functools
import importlib.util
import os
from collections.abc import Callable
from typing import Protocol, runtime_checkable

import numpy as np
from scipy.sparse.linalg import splu

from equilibrium.errors import BackendError
from equilibrium.linear.pardiso import PardisoFactor
from equilibrium.linear.sparse_pattern import Floats, Ints, SparsePattern

SHARE = 0.5  # of the machine's memory that a factorisation may take


class Factor(Protocol):
    """A factorisation that reuses its pattern."""

    name: str

    def factorise(self, data: Floats) -> bool:
        """Factorise the matrix with these lower-triangle entries; False if it is not positive definite."""

    def solve(self, b: Floats) -> Floats:
        """Solve with the matrix just accepted, b (size,) or (size, k); meaningless after a refused one."""

    def close(self) -> None:
        """Give the memory back."""


@runtime_checkable
class Iterative(Factor, Protocol):
    """What stands in for a factorisation by iterating: it has to be asked for a proof, and told what it coarsens."""

    def near_nullspace(self, nodes: Ints, modes: Floats) -> None:
        """Nodes (size,) whose unknowns stay together, and modes (size, k) that the matrices nearly map to zero."""

    def solve(self, b: Floats, tolerance: float = ...) -> Floats:
        """To this relative residual; raises NotPositiveDefinite on meeting negative curvature."""

    def proves_definite(self) -> bool:
        """True only if the last matrix is known to be positive definite; `factorise` says what it has not refuted."""

    def product(self, v: Floats) -> Floats:
        """Last matrix times v (size,)."""

    def precondition(self, b: Floats) -> Floats:
        """Positive definite approximation of the inverse times b (size,)."""


class CholmodFactor:
    """CHOLMOD through scikit-sparse, if the user has it (GPL, not a dependency)."""

    name = "cholmod"

    def __init__(self, pattern: SparsePattern) -> None:
        from sksparse.cholmod import analyze

        self._pattern = pattern
        structure = pattern.lower(np.ones(pattern.nnz))
        structure.data[pattern.diagonal] = pattern.size
        self._factor = analyze(structure, mode="supernodal")

    def factorise(self, data: Floats) -> bool:
        from sksparse.cholmod import CholmodNotPositiveDefiniteError

        if not np.isfinite(data).all():
            return False
        try:
            self._factor.cholesky_inplace(self._pattern.lower(data))
        except CholmodNotPositiveDefiniteError:
            return False
        return True

    def solve(self, b: Floats) -> Floats:
        return self._factor(b)

    def close(self) -> None:
        self._factor = None


class SuperLUFactor:
    """SuperLU from scipy in its symmetric mode: everywhere, slower, and the ordering is not reused.

    Without row exchanges the factors are L D L^T, and the signs of D are the inertia.
    """

    name = "superlu"

    def __init__(self, pattern: SparsePattern) -> None:
        self._pattern = pattern

    def factorise(self, data: Floats) -> bool:
        if not np.isfinite(data).all():
            return False
        full = self._pattern.full(data)
        try:
            lu = splu(full, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError:  # exactly singular
            return False
        if not np.array_equal(lu.perm_r, lu.perm_c) or lu.U.diagonal().min() <= 0.0:
            return False
        self._lu = lu
        return True

    def solve(self, b: Floats) -> Floats:
        return self._lu.solve(np.asarray(b, dtype=float))

    def close(self) -> None:
        self._lu = None


def _multigrid(pattern: SparsePattern) -> Factor:
    from equilibrium.linear.multigrid import MultigridFactor

    return MultigridFactor(pattern)


BACKENDS: dict[str, Callable[[SparsePattern], Factor]] = {
    "pardiso": PardisoFactor,
    "cholmod": CholmodFactor,
    "superlu": SuperLUFactor,
    "amg": _multigrid,
}
_MODULES = {"pardiso": "pypardiso", "cholmod": "sksparse", "superlu": "scipy", "amg": "pyamg"}


@functools.cache
def _installed(module: str) -> bool:
    return importlib.util.find_spec(module) is not None


def available() -> list[str]:
    """Names of the backends that are installed: factorisations, fastest first, then multigrid."""
    return [name for name, module in _MODULES.items() if _installed(module)]


def make_factor(pattern: SparsePattern, backend: str = "auto") -> Factor:
    """A factorisation for this pattern.

    Raises
    ------
    BackendError
        The backend is unknown or not installed.
    """
    check_backend(backend)
    if backend != "auto":
        return BACKENDS[backend](pattern)
    for name in available():
        try:
            return BACKENDS[name](pattern)
        except (ImportError, OSError):  # a package without its shared library
            continue
    raise BackendError("backend: no sparse factorisation is installed")


def make_solver(pattern: SparsePattern, backend: str = "auto") -> Factor:
    """As `make_factor`, but `auto` is multigrid where a factorisation would take too large a part of the memory.

    Measured up to 300000 vertices (benchmarks/results/large.md), PARDISO is the faster one wherever it fits. Memory of
    another factorisation is not known before it is made; without PARDISO, ask for `amg` on large sheets.
    """
    factor = make_factor(pattern, backend)
    if backend != "auto" or getattr(factor, "memory_mb", 0.0) < SHARE * physical_memory_mb():
        return factor
    factor.close()
    return _multigrid(pattern)


def physical_memory_mb() -> float:
    """Of this machine; 8 GB where it does not say."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2.0**20
    except (AttributeError, ValueError, OSError):
        return 8192.0


def check_backend(backend: str) -> None:
    """Raise BackendError if this backend cannot be used here."""
    if backend != "auto" and backend not in available():
        raise BackendError(f"backend: {backend!r} is not available; use auto or {' or '.join(available())}")
