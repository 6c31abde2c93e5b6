"""Slopes at nodes are those of scipy's interpolators, which take longer to import."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.interpolate import Akima1DInterpolator, CubicSpline, PchipInterpolator

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.hermite_grid import SlopeRule, node_slopes

STEPS = hnp.arrays(float, st.integers(3, 8), elements=st.floats(0.1, 10.0))
# whole numbers give equal secants and secants of zero
VALUES = st.one_of(st.floats(-100.0, 100.0, allow_subnormal=False), st.integers(-2, 2).map(float))


def scipy_slopes(nodes: Floats, values: Floats, axis: int, rule: SlopeRule) -> Floats:
    if rule == "monotone":
        return np.asarray(PchipInterpolator(nodes, values, axis=axis).derivative()(nodes))
    if rule == "spline":
        return np.asarray(CubicSpline(nodes, values, axis=axis)(nodes, 1))
    return np.asarray(Akima1DInterpolator(nodes, values, axis=axis, method="makima").derivative()(nodes))


@pytest.mark.slow
@pytest.mark.parametrize("rule", ["monotone", "smooth", "spline"])
@settings(deadline=None, max_examples=60)
@given(steps=STEPS, data=st.data())
def test_slopes_are_those_of_scipy(rule: SlopeRule, steps: Floats, data: st.DataObject) -> None:
    nodes = np.cumsum(steps)
    if len(nodes) == 3 and rule == "smooth":
        rule = "monotone"  # three nodes have a parabola with the other rule
    values = data.draw(hnp.arrays(float, (2, len(nodes), 3), elements=VALUES))
    expected = scipy_slopes(nodes, values, 1, rule)
    np.testing.assert_allclose(node_slopes(nodes, values, 1, rule), expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("rule", ["monotone", "smooth", "spline"])
@pytest.mark.parametrize("count", [2, 3, 5])
def test_straight_lines_have_their_slope(rule: SlopeRule, count: int) -> None:
    nodes = np.arange(count) ** 1.5
    np.testing.assert_allclose(node_slopes(nodes, 2.0 - 3.0 * nodes, 0, rule), -3.0, rtol=1e-12)
