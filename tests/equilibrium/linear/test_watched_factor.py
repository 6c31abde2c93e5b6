"""A watched factor is the factor, and its watch can end the work."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.previews.solve import WatchedFactor


def test_watch_is_called_and_may_raise() -> None:
    pattern = SparsePattern([np.array([[0, 1], [1, 2]])], 3, np.arange(3))
    data = pattern.assemble([np.array([[2.0, -1.0, 2.0], [2.0, -1.0, 2.0]])])
    calls: list[int] = []
    factor = make_factor(pattern, "superlu")
    watched = WatchedFactor(factor, lambda: calls.append(len(calls)))
    assert watched.name == factor.name and watched.factorise(data)
    b = np.arange(3.0)
    assert np.array_equal(watched.solve(b), factor.solve(b)) and len(calls) == 2

    def stop() -> None:
        raise KeyboardInterrupt

    watched.watch = stop
    with pytest.raises(KeyboardInterrupt):
        watched.factorise(data)
    watched.close()
