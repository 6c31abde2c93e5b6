"""One thread for the dense linear algebra of numpy and scipy; sparse factorisations keep their threads.

OpenBLAS starts all its threads even for 2 x 2 matrices, such as a triangle's barycentric coordinates. On a processor
that other programs use as well, each such call waits for all threads, and milliseconds become seconds.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import Any

from threadpoolctl import ThreadpoolController


class _Nesting:
    """Number of active `one_blas_thread` contexts, and the limit that the last one lifts."""

    lock = Lock()
    count = 0
    limit: Any = None


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Limit OpenBLAS to one thread; a context manager and a decorator.

    The number of threads belongs to the process. The first Python thread that enters sets the limit, and the last one
    that leaves restores the former number.
    """
    with _Nesting.lock:
        _Nesting.count += 1
        if _Nesting.count == 1:
            _Nesting.limit = _openblas().limit(limits=1)
    try:
        yield
    finally:
        with _Nesting.lock:
            _Nesting.count -= 1
            if _Nesting.count == 0:
                _Nesting.limit.restore_original_limits()


@cache
def _openblas() -> ThreadpoolController:
    """The copies of OpenBLAS in this process, searched once (it takes milliseconds), after both are loaded."""
    import scipy.linalg  # noqa: F401 (scipy loads its own copy, numpy another)

    return ThreadpoolController().select(internal_api="openblas")
