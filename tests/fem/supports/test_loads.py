"""Resultants of dead loads."""

import numpy as np
import pytest

from asterism.fem.elements.argyris import Argyris
from asterism.fem.elements.deformation import affine
from asterism.fem.supports.loads import area_load
from tests.fem.meshes import rectangle


def test_resultants_and_moments() -> None:
    """The work of a load on every affine motion: its resultant and its moments."""
    space = Argyris(rectangle(3, 2, 3.0, 2.0, amount=0.2))

    def work(loads: np.ndarray, matrix: object, offset: tuple[float, ...] = (0.0, 0.0, 0.0)) -> float:
        return float(np.sum(loads * space.interpolate(affine(matrix, offset).jets)))

    weight = area_load(space, (0.0, 0.0, -0.5))
    assert work(weight, np.zeros((3, 2)), (1.0, 2.0, 3.0)) == pytest.approx(-0.5 * 6 * 3)
    assert work(weight, [[0.0, 0], [0, 0], [0.7, -0.2]]) == pytest.approx(-0.5 * 6 * (0.7 * 1.5 - 0.2 * 1.0))
    linear = area_load(space, lambda p: np.column_stack([p[:, 0], 0 * p[:, 0], 0 * p[:, 0]]))
    assert work(linear, [[1.0, 0], [0, 0], [0, 0]]) == pytest.approx(9.0 * 2)
