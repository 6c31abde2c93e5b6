"""V11: Saint-Venant torsion of rectangles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asterism.discrete.energies.rods.network import torsion_constant


@pytest.mark.parametrize(("ratio", "beta"), [(1.0, 0.140577), (2.0, 0.228682), (4.0, 0.280813), (10.0, 0.312325)])
def test_textbook_table(ratio, beta):
    """J = beta a b^3 (Timoshenko and Goodier, section 109)."""
    b = 0.37
    assert torsion_constant(np.array(ratio * b), np.array(b)) / (ratio * b**4) == pytest.approx(beta, abs=1e-6)


def test_thin_strip():
    """a b^3/3 (1 - 0.630249 b/a), the limit of the series."""
    a, b = np.array(1000.0), np.array(1.0)
    assert torsion_constant(a, b) == pytest.approx(a / 3.0 * (1.0 - 0.6302498 / a), rel=1e-9)


@given(st.floats(0.05, 20.0), st.floats(0.05, 20.0), st.floats(0.1, 10.0))
def test_symmetric_homogeneous_and_below_the_polar_moment(a, b, scale):
    j = torsion_constant(np.array(a), np.array(b))
    assert torsion_constant(np.array(b), np.array(a)) == pytest.approx(j, rel=1e-14)
    assert torsion_constant(np.array(scale * a), np.array(scale * b)) == pytest.approx(scale**4 * j, rel=1e-12)
    assert 0.0 < j < a * b * (a * a + b * b) / 12.0
