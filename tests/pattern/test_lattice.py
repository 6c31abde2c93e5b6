"""Sites of a lattice."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from pattern.lattice import Lattice

steps = st.floats(-40.0, 40.0)


# equilateral but for rounding, as users type it
@example((11.0, -18.4), (21.43486742963367, 0.3262794416288255))
@given(st.tuples(steps, steps), st.tuples(steps, steps))
@settings(max_examples=50, deadline=None)
def test_nearest_site_is_the_nearest_of_all(first: tuple[float, float], second: tuple[float, float]) -> None:
    """Whatever the basis: also a slanted one, whose own cells reach far beyond their neighbours."""
    try:
        lattice = Lattice(kind="custom", vectors_mm=(first, second), origin_mm=(3.0, -2.0))
    except ValueError:
        assume(False)
    points = np.random.default_rng(0).uniform(-80.0, 80.0, (100, 2))
    sites = lattice.place(lattice.cells_within(points.min(axis=0) - 120.0, points.max(axis=0) + 120.0))
    least = np.linalg.norm(points[:, None] - sites, axis=2).min(axis=1)
    assert np.allclose(np.linalg.norm(lattice.place(lattice.nearest(points)) - points, axis=1), least)
