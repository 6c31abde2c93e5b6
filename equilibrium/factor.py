"""One small interface to sparse factorisations of symmetric matrices.

A backend keeps what depends on the pattern alone between factorisations, and says whether the matrix was positive
definite: a Newton step needs to know, and some solvers accept an indefinite matrix silently.
"""

from __future__ import annotations

import copy
import ctypes
import functools
import importlib.metadata
import importlib.util
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol, runtime_checkable

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from equilibrium.sparse_pattern import Floats, Ints, SparsePattern

# entries of a triangle below which a second thread waits more than it works; one thread also adds in one order, so that
# small problems give the same digits on every run
FEW = 1_000_000
SMALL = 200_000  # entries of a triangle below which nested dissection takes longer than it saves
SHARE = 0.5  # of the machine's memory that a factorisation may take


class BackendError(ValueError):
    """The factorisation asked for is not installed; one line."""


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


@functools.cache
def _pardiso_library() -> Any:
    """A solver that is never used itself: looking for MKL's library on the disk takes a tenth of a second and more."""
    with _mkl_shown():
        from pypardiso import PyPardisoSolver

        return PyPardisoSolver(mtype=2)


@contextmanager
def _mkl_shown() -> Iterator[None]:
    """Tell pypardiso where MKL is, if pip knows: else it looks through the whole environment, twice."""
    name = "PYPARDISO_MKL_RT"
    try:
        files = importlib.metadata.files("mkl") or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    path = next((str(file.locate()) for file in files if "mkl_rt" in file.name), None)
    if path is None or name in os.environ or not os.path.exists(path):
        yield
        return
    os.environ[name] = path
    try:
        yield
    finally:
        del os.environ[name]


def _at(array: Any, kind: Any) -> Any:
    """Pointer to an array's data, which keeps the array alive."""
    return array.ctypes.data_as(ctypes.POINTER(kind))


class PardisoFactor:
    """MKL PARDISO through pypardiso: Cholesky, stopped by the first pivot that is not positive."""

    name = "pardiso"

    def __init__(self, pattern: SparsePattern) -> None:
        self._threads = 1 if pattern.nnz < FEW else 0
        self._solver = copy.copy(_pardiso_library())
        self._solver.pt = np.zeros_like(self._solver.pt)
        self._solver.iparm = np.zeros_like(self._solver.iparm)
        # the lower triangle by columns is the upper triangle by rows, which is what PARDISO reads; it counts from 1
        self._size = pattern.size
        self._starts, self._columns = (
            _at(part.astype(np.int32) + 1, ctypes.c_int32) for part in (pattern.indptr, pattern.indices)
        )
        self._data = np.ones(pattern.nnz)
        self._solver.set_iparm(1, 1)
        self._solver.set_iparm(2, 0 if pattern.nnz < SMALL else 2)  # minimum degree, nested dissection
        self._solver.set_iparm(8, 0)
        # the two-level factorisation is a few percent faster and misses negative pivots of unconnected dofs
        self._solver.set_iparm(24, 0)
        self._call(11, np.zeros(pattern.size))

    def _call(self, phase: int, b: Floats) -> Floats:
        self._solver.set_phase(phase)
        # of this Python thread alone; 0 is what the user has set, for all calls the same
        threads = self._solver.libmkl.MKL_Set_Num_Threads_Local
        before = threads(self._threads)
        try:
            return self._pardiso(b)
        finally:
            threads(before)

    def _pardiso(self, b: Floats) -> Floats:
        """pypardiso's own call makes the index arrays anew every time."""
        from pypardiso.pardiso_wrapper import PyPardisoError

        solver, x, error = self._solver, np.zeros_like(b), ctypes.c_int32(0)
        kind, phase, size, columns, silent = (
            ctypes.byref(ctypes.c_int32(number))
            for number in (solver.mtype, solver.phase, self._size, b.size // len(b) if b.size else 1, solver.msglvl)
        )
        one = ctypes.byref(ctypes.c_int32(1))
        solver._mkl_pardiso(
            _at(solver.pt, solver._pt_type[0]), one, one, kind, phase, size, _at(self._data, ctypes.c_double),
            self._starts, self._columns, _at(solver.perm, ctypes.c_int32), columns, _at(solver.iparm, ctypes.c_int32),
            silent, _at(b, ctypes.c_double), _at(x, ctypes.c_double), ctypes.byref(error),
        )  # fmt: skip
        if error.value:
            raise PyPardisoError(error.value)
        return np.ascontiguousarray(x)

    def factorise(self, data: Floats) -> bool:
        from pypardiso.pardiso_wrapper import PyPardisoError

        if not np.isfinite(data).all():
            return False
        self._data = np.ascontiguousarray(data, dtype=float)
        try:
            self._call(22, np.zeros(self._size))
        except PyPardisoError as error:
            if error.value == -4:
                return False
            raise
        return True

    def solve(self, b: Floats) -> Floats:
        return self._call(33, np.asfortranarray(b, dtype=float))

    @property
    def memory_mb(self) -> float:
        """What the factor takes, known since its pattern was analysed."""
        kilobytes = [self._solver.get_iparm(i) for i in (15, 16, 17)]
        return max(kilobytes[0], kilobytes[1] + kilobytes[2]) / 1024.0

    def close(self) -> None:
        self._solver.free_memory(everything=True)


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
        del self._factor


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
        low = self._pattern.lower(data)
        full = (low + sp.tril(low, -1).T).tocsc()
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
    from equilibrium.multigrid import MultigridFactor

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
