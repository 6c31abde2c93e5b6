"""One thread for dense algebra, and the old number afterwards."""

from __future__ import annotations

from contextlib import ExitStack

import pytest

from asterism.equilibrium.threads import _openblas, one_blas_thread


def threads() -> list[int]:
    return [library["num_threads"] for library in _openblas().info()]


def test_threads_come_back_when_the_last_one_leaves() -> None:
    """Two Python threads may be within at once, and leave in the order in which they came."""
    if not threads():
        pytest.skip("numpy and scipy do not use OpenBLAS here")
    with _openblas().limit(limits=2):
        before = threads()
        first, second = ExitStack(), ExitStack()
        first.enter_context(one_blas_thread())
        second.enter_context(one_blas_thread())
        assert set(threads()) == {1}
        first.close()
        assert set(threads()) == {1}
        second.close()
        assert threads() == before
