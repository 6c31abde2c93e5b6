"""Sites of a lattice."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.lattice import Lattice

steps = st.floats(-40.0, 40.0)


# equilateral but for rounding, as users type it
@pytest.mark.slow
@example((11.0, -18.4), (21.43486742963367, 0.3262794416288255))
@given(st.tuples(steps, steps), st.tuples(steps, steps))
@settings(max_examples=20)
def test_nearest_site_is_the_nearest_of_all(first: tuple[float, float], second: tuple[float, float]) -> None:
    """Whatever the basis: also a slanted one, whose own cells reach far beyond their neighbours."""
    try:
        lattice = Lattice(kind="custom", vectors_mm=(first, second), origin_mm=(3.0, -2.0))
    except ValueError:
        assume(False)
    points = np.random.default_rng(0).uniform(-80.0, 80.0, (100, 2))
    places = lattice.sites
    sites = places.place(places.cells_within(points.min(axis=0) - 120.0, points.max(axis=0) + 120.0))
    least = np.linalg.norm(points[:, None] - sites, axis=2).min(axis=1)
    assert np.allclose(np.linalg.norm(places.place(places.nearest(points)) - points, axis=1), least)


@pytest.mark.parametrize("basis", [[[17, 0], [0, 17]], [[14, 0], [4, 21]], [[15, 7.5], [0, 18]], [[14, 0], [7, 13]]])
def test_every_basis_becomes_the_same_kind(basis: Floats) -> None:
    """The shortest, not obtuse and counterclockwise; and the same pairs of neighbours are found in it."""
    cells = np.array([[i, j] for i in range(-1, 2) for j in range(-1, 2)])
    for steps in ([[1, 0], [0, 1]], [[0, 1], [1, 0]], [[1, 0], [0, -1]], [[-1, 1], [0, 1]], [[2, 1], [1, 1]]):
        first, second = (np.array(steps) @ basis).tolist()
        lattice = Lattice(kind="custom", vectors_mm=(tuple(first), tuple(second)))
        a, b = lattice.vectors
        assert a @ b > -1e-9 * (a @ a) and np.linalg.det(lattice.vectors) > 0
        assert sorted(np.linalg.norm(lattice.vectors, axis=1)) == pytest.approx(sorted(np.linalg.norm(basis, axis=1)))
        own = np.rint(cells @ basis @ np.linalg.inv(lattice.vectors)).astype(np.int64)
        links = lattice.sites.place(own)[lattice.sites.neighbours(own)]
        ahead = np.round(links[:, 1] - links[:, 0], 6)
        assert len(links) and ((ahead[:, 0] > 0) | ((ahead[:, 0] == 0) & (ahead[:, 1] > 0))).all()
