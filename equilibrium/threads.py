"""One thread for the dense algebra of numpy and scipy; sparse factorisations keep theirs.

Their OpenBLAS wakes all its threads for matrices of two by two (a triangle's barycentric coordinates), and where other
programs use the processor too, each such call waits for its turn: milliseconds become seconds.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import Any

from threadpoolctl import ThreadpoolController


class _Within:
    """How many are within `one_blas_thread`, and what brings the threads back."""

    lock = Lock()
    count = 0
    limit: Any = None


_within = _Within()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Within it, and as a decorator, OpenBLAS works alone; when the last one is left it has the threads it had.

    The number of threads is the process's: where several Python threads are within, the first one in takes it down.
    """
    with _within.lock:
        _within.count += 1
        if _within.count == 1:
            _within.limit = _openblas().limit(limits=1)
    try:
        yield
    finally:
        with _within.lock:
            _within.count -= 1
            if _within.count == 0:
                _within.limit.restore_original_limits()


@cache
def _openblas() -> ThreadpoolController:
    """The copies of OpenBLAS in this process; to find them takes milliseconds, so it is done once both are there."""
    import scipy.linalg  # noqa: F401 (brings a copy of its own beside numpy's)

    return ThreadpoolController().select(internal_api="openblas")
