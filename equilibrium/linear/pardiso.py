"""MKL's PARDISO through pypardiso, as an `equilibrium.linear.factor.Factor`."""

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

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


@functools.cache
def _pardiso_library() -> Any:
    """A solver to copy from, made once: the search for the MKL library on the disk takes 0.1 s or more."""
    with _mkl_path_set():
        from pypardiso import PyPardisoSolver

        solver = PyPardisoSolver(mtype=2)
    # Indices of 32 bits and Intel's calling convention, as pypardiso calls it, whatever MKL_INTERFACE_LAYER names:
    # conda's activation names a layer that pip's MKL lacks, and MKL would end the process at its first call.
    solver.libmkl.MKL_Set_Interface_Layer(0)
    return solver


@contextmanager
def _mkl_path_set() -> Iterator[None]:
    """Set the path of MKL for pypardiso if pip lists it; otherwise pypardiso searches the whole environment twice."""
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
    """Pointer to the data of an array; the pointer keeps the array alive."""
    return array.ctypes.data_as(ctypes.POINTER(kind))


class PardisoFactor:
    """Cholesky factorisation by MKL PARDISO; it stops at the first pivot that is not positive.

    `pattern`: sparsity pattern of the matrices, analysed at once.
    """

    name = "pardiso"

    def __init__(self, pattern: SparsePattern) -> None:
        # a second thread of a smaller lower triangle mostly waits; one thread also adds in a fixed order, so that small
        # problems give the same digits in every run
        self._threads = 1 if pattern.nnz < 1_000_000 else 0
        self._solver = copy.copy(_pardiso_library())
        self._solver.pt = np.zeros_like(self._solver.pt)
        self._solver.iparm = np.zeros_like(self._solver.iparm)
        # PARDISO reads the upper triangle by rows, which is the lower one by columns; its indices start at 1
        self._size = pattern.size
        self._starts, self._columns = (
            _at(part.astype(np.int32) + 1, ctypes.c_int32) for part in (pattern.indptr, pattern.indices)
        )
        self._data = np.ones(pattern.nnz)
        self._solver.set_iparm(1, 1)
        # ordering: 0 is minimum degree, 2 nested dissection
        self._solver.set_iparm(2, 0 if pattern.nnz < 200_000 else 2)
        self._solver.set_iparm(8, 0)
        # no two-level factorisation: it is a few percent faster, but misses negative pivots of unconnected dofs
        self._solver.set_iparm(24, 0)
        # arguments that stay: a preview calls the solver sixty times
        self._one, self._kind, self._order, self._silent = (
            ctypes.byref(ctypes.c_int32(number)) for number in (1, self._solver.mtype, pattern.size, 0)
        )
        self._handle, self._permutation, self._parameters = (
            _at(self._solver.pt, self._solver._pt_type[0]),
            _at(self._solver.perm, ctypes.c_int32),
            _at(self._solver.iparm, ctypes.c_int32),
        )
        self._values = _at(self._data, ctypes.c_double)
        # MKL owns the memory; the end of the process frees it without our call
        self._release = weakref.finalize(self, self._solver.free_memory, everything=True)
        self._release.atexit = False
        self._call(11, np.zeros(pattern.size))

    def _call(self, phase: int, b: Floats) -> Floats:
        """One call of PARDISO; the call in pypardiso would build the index arrays again every time."""
        one, x, error = self._one, np.zeros_like(b), ctypes.c_int32(0)
        columns = ctypes.c_int32(b.size // len(b) if b.size else 1)
        # for this Python thread only; 0 restores the number that the user has set
        threads = self._solver.libmkl.MKL_Set_Num_Threads_Local
        before = threads(self._threads)
        try:
            self._solver._mkl_pardiso(
                self._handle, one, one, self._kind, ctypes.byref(ctypes.c_int32(phase)), self._order, self._values,
                self._starts, self._columns, self._permutation, ctypes.byref(columns), self._parameters, self._silent,
                _at(b, ctypes.c_double), _at(x, ctypes.c_double), ctypes.byref(error),
            )  # fmt: skip
        finally:
            threads(before)
        if error.value:
            from pypardiso.pardiso_wrapper import PyPardisoError

            raise PyPardisoError(error.value)
        return np.ascontiguousarray(x)

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`."""
        from pypardiso.pardiso_wrapper import PyPardisoError

        if not np.isfinite(data).all():
            return False
        self._data = np.ascontiguousarray(data, dtype=float)
        self._values = _at(self._data, ctypes.c_double)
        try:
            self._call(22, np.zeros(self._size))
        except PyPardisoError as error:
            if error.value == -4:
                return False
            raise
        return True

    def solve(self, b: Floats) -> Floats:
        """As in `Factor`."""
        return self._call(33, np.asfortranarray(b, dtype=float))

    @property
    def memory_mb(self) -> float:
        """Memory of the factor, MB; known from the analysis of the pattern."""
        kilobytes = [self._solver.get_iparm(i) for i in (15, 16, 17)]
        return float(max(kilobytes[0], kilobytes[1] + kilobytes[2])) / 1024.0

    def close(self) -> None:
        """As in `Factor`."""
        self._release()
