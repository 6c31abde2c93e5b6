"""The registry of sparse solvers: one line for each backend, and the functions that choose among them.

A new backend needs a file with its class (see `equilibrium.linear.factor.Factor`) and a line in `BACKENDS`.
"""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import BackendError
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.linear.multigrid import MultigridFactor
from asterism.equilibrium.linear.pardiso import PardisoFactor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


class CholmodFactor:
    """Supernodal Cholesky factorisation; scikit-sparse is GPL software and no dependency, users install it.

    `pattern`: sparsity pattern of the matrices, analysed at once.
    """

    name = "cholmod"

    def __init__(self, pattern: SparsePattern) -> None:
        from sksparse.cholmod import analyze

        self._pattern = pattern
        structure = pattern.lower(np.ones(pattern.nnz))
        structure.data[pattern.diagonal] = pattern.size
        self._factor = analyze(structure, mode="supernodal")

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`."""
        from sksparse.cholmod import CholmodNotPositiveDefiniteError

        if not np.isfinite(data).all():
            return False
        try:
            self._factor.cholesky_inplace(self._pattern.lower(data))
        except CholmodNotPositiveDefiniteError:
            return False
        return True

    def solve(self, b: Floats) -> Floats:
        """As in `Factor`."""
        return np.asarray(self._factor(b))

    def close(self) -> None:
        """As in `Factor`."""
        self._factor = None


class SuperLUFactor:
    """SuperLU in its symmetric mode: available everywhere, but slower, and every matrix is ordered anew.

    Without row exchanges the factors are L D L^T, and the signs of D are the inertia of the matrix.

    `pattern`: sparsity pattern of the matrices.
    """

    name = "superlu"

    def __init__(self, pattern: SparsePattern) -> None:
        self._pattern = pattern
        self._lu: Any = None

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`."""
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
        """As in `Factor`."""
        return np.asarray(self._lu.solve(np.asarray(b, dtype=float)))

    def close(self) -> None:
        """As in `Factor`."""
        self._lu = None


@dataclass(frozen=True)
class Backend:
    """A sparse solver.

    It has the name that users write, and needs a Python package. `auto` never takes an iterative one for a
    factorisation.
    """

    name: str
    package: str
    make: Callable[[SparsePattern], Factor]
    iterative: bool = False

    @property
    def installed(self) -> bool:
        """The package can be imported."""
        return importlib.util.find_spec(self.package) is not None


def _make_multigrid(pattern: SparsePattern) -> Factor:
    return MultigridFactor(pattern, make_factor)


# factorisations first, the fastest at the top
BACKENDS = {
    backend.name: backend
    for backend in (
        Backend("pardiso", "pypardiso", PardisoFactor),
        Backend("cholmod", "sksparse", CholmodFactor),
        Backend("superlu", "scipy", SuperLUFactor),
        Backend("amg", "pyamg", _make_multigrid, iterative=True),
    )
}


def available() -> list[str]:
    """Names of the installed backends: factorisations from the fastest on, then multigrid.

    >>> "superlu" in available()
    True
    """
    return [backend.name for backend in BACKENDS.values() if backend.installed]


def make_factor(pattern: SparsePattern, backend: str = "auto") -> Factor:
    """Solver for matrices of a sparsity pattern.

    Raises `BackendError` if the backend is unknown or not installed.

    Parameters
    ----------
    pattern : of the matrices.
    backend : a name in `BACKENDS`, or `auto`: the fastest factorisation that is installed.

    A chain of two springs between three unknowns, on a soft foundation:

    >>> import numpy as np
    >>> from asterism.equilibrium.linear.sparse_pattern import SparsePattern
    >>> pattern = SparsePattern([np.array([[0, 1], [1, 2]])], 3, np.arange(3))
    >>> data = pattern.assemble([np.array([[1.0, -1.0, 1.0], [1.0, -1.0, 1.0]])])
    >>> data[pattern.diagonal] += 1.0
    >>> factor = make_factor(pattern, "superlu")
    >>> factor.factorise(data)
    True
    >>> factor.solve(np.array([1.0, 0.0, 0.0])).round(3).tolist()
    [0.625, 0.25, 0.125]
    """
    check_backend(backend)
    if backend != "auto":
        try:
            return BACKENDS[backend].make(pattern)
        except (ImportError, OSError) as error:  # a package without its shared library
            raise BackendError(f"backend: {backend!r} is not available: {error}") from None
    for candidate in BACKENDS.values():
        if candidate.iterative or not candidate.installed:
            continue
        try:
            return candidate.make(pattern)
        except (ImportError, OSError):  # a package without its shared library
            continue
    raise BackendError("backend: no sparse factorisation is installed")


def make_solver(pattern: SparsePattern, backend: str = "auto") -> Factor:
    """As `make_factor`, but `auto` chooses multigrid if a factorisation needs too much memory.

    PARDISO is faster wherever it fits in memory (measured up to 300 000 vertices, `python -m benchmarks.large`). Only
    PARDISO reports its memory beforehand. Without PARDISO, ask for `amg` on large sheets.
    """
    factor = make_factor(pattern, backend)
    # beyond half of the machine's memory the solver iterates
    if backend != "auto" or getattr(factor, "memory_mb", 0.0) < 0.5 * physical_memory_mb():
        return factor
    factor.close()
    return _make_multigrid(pattern)


def physical_memory_mb() -> float:
    """Memory of this machine, MB; 8192 MB where the system does not report it."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2.0**20
    except (AttributeError, ValueError, OSError):
        return 8192.0


def check_backend(backend: str) -> None:
    """Raise `BackendError` if a backend is unknown or not installed."""
    if backend != "auto" and backend not in available():
        raise BackendError(f"backend: {backend!r} is not available; use auto or {' or '.join(available())}")
