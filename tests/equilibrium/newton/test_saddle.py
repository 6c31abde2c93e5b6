"""The way down from a saddle, to a side that rounding does not choose."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.newton.certificate import leave_saddle
from tests.equilibrium.newton.test_minimise import Analytic


def wells(tilt: float) -> Analytic:
    """Minima at about (+-1, 0), the right one lower for a positive tilt."""
    return Analytic(
        lambda x: x[0] ** 4 - 2.0 * x[0] ** 2 - tilt * x[0] ** 3 + x[1] ** 2,
        lambda x: [4.0 * x[0] ** 3 - 4.0 * x[0] - 3.0 * tilt * x[0] ** 2, 2.0 * x[1]],
        lambda x: [[12.0 * x[0] ** 2 - 4.0 - 6.0 * tilt * x[0], 0.0], [0.0, 2.0]],
        2,
    )


@pytest.mark.parametrize("tilt", [0.2, -0.2])
def test_it_leads_to_the_lower_side(tilt: float) -> None:
    for way in (1.0, -1.0):
        end = leave_saddle(wells(tilt), np.zeros(2), np.array([way, 0.0]), 2.0)
        assert end[0] * tilt > 0.0


def test_of_equal_sides_it_is_always_the_same_one() -> None:
    ends = [
        leave_saddle(wells(tilt), np.zeros(2), np.array([way, 0.0]), 2.0)[0]
        for way in (1.0, -1.0)
        for tilt in (0.0, 1e-9, -1e-9, 1e-3, -1e-3)
    ]
    assert np.abs(ends) == pytest.approx(1.0)
    assert len({*np.sign(ends)}) == 1


def test_no_unknown_moves_further_than_allowed() -> None:
    end = leave_saddle(wells(0.2), np.zeros(2), np.array([0.1, 0.02]), 0.25)
    assert np.abs(end).max() == pytest.approx(0.25)
