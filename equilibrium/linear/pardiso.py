"""MKL's PARDISO through pypardiso, as a `equilibrium.linear.factor.Factor`."""

from __future__ import annotations

import copy
import ctypes
import functools
import importlib.metadata
import os
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from equilibrium.linear.sparse_pattern import Floats, SparsePattern

# entries of a triangle below which a second thread waits more than it works; one thread also adds in one order, so that
# small problems give the same digits on every run
FEW = 1_000_000
SMALL = 200_000  # entries of a triangle below which nested dissection takes longer than it saves


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
        # MKL's memory is not Python's; at the end of the process it goes by itself
        self._release = weakref.finalize(self, self._solver.free_memory, everything=True)
        self._release.atexit = False
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
        self._release()
