"""One thread for the dense algebra of numpy and scipy; sparse factorisations keep theirs.

Their OpenBLAS wakes all its threads for matrices of two by two (a triangle's barycentric coordinates), and where other
programs use the processor too, each such call waits for its turn: milliseconds become seconds.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from threadpoolctl import ThreadpoolController


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Within it, and as a decorator, OpenBLAS works alone; afterwards it has the threads it had."""
    with _openblas().limit(limits=1):
        yield


@cache
def _openblas() -> ThreadpoolController:
    """The copies of OpenBLAS in this process; to find them takes milliseconds, so it is done once both are there."""
    import scipy.linalg  # noqa: F401 (brings a copy of its own beside numpy's)

    return ThreadpoolController().select(internal_api="openblas")
