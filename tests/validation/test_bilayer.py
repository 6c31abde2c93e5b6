"""V13: two layers that want different lengths, against the energy of the strip itself and in both conventions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature


def strip_curvature(h1: float, h2: float, ratio: float, mismatch: float) -> float:
    """Curvature of least energy of two bonded layers: plane sections, layer 2 shrinks by `mismatch`.

    `min over (e, k) of sum E_i int_i (e + k z - e_i)^2 dz`, integrated exactly by Gauss points; layer 1 lies at z > 0.
    """
    nodes, weights = np.polynomial.legendre.leggauss(2)
    rows, wanted = [], []
    for modulus, low, high, strain in ((ratio, 0.0, h1, 0.0), (1.0, -h2, 0.0, -mismatch)):
        half = 0.5 * (high - low)
        z, w = low + half * (1.0 + nodes), np.sqrt(modulus * half * weights)
        rows += [np.column_stack([w, w * z])]
        wanted += [w * strain]
    return float(np.linalg.lstsq(np.concatenate(rows), np.concatenate(wanted))[0][1])


@given(h1=st.floats(0.1, 2.0), h2=st.floats(0.1, 2.0), ratio=st.floats(1.0, 1e4), stretch=st.floats(1.01, 3.0))
def test_timoshenko_is_the_strip_of_least_energy(h1, h2, ratio, stretch):
    """And its sign: the fabric below shrinks, the strip bends around it, its ends go down."""
    plastic = Plastic(modulus_ratio=ratio, rest_curvature="timoshenko")
    found = float(rest_curvature(h1, Fabric(stretch=stretch, thickness_mm=h2), plastic))
    expected = strip_curvature(h1, h2, ratio, 0.5 * (1.0 - 1.0 / stretch**2))
    assert expected > 0.0
    assert found == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(("h1", "rough"), [(0.3, 0.045), (0.4, 0.025), (0.6, 0.01)])
def test_equation_1_is_the_stiff_limit_of_equation_11(h1, rough):
    """Eq. (11) is twice Timoshenko's; Eq. (1) its leading term in E2/E1, a little above it for the paper's strips."""
    eq_1 = float(rest_curvature(h1, Fabric(), Plastic()))
    eq_11 = 2.0 * float(rest_curvature(h1, Fabric(), Plastic(rest_curvature="timoshenko")))
    assert eq_11 < eq_1 < (1.0 + rough) * eq_11
    stiff = {"modulus_ratio": 1e7}
    eq_1 = float(rest_curvature(h1, Fabric(), Plastic(**stiff)))
    eq_11 = 2.0 * float(rest_curvature(h1, Fabric(), Plastic(**stiff, rest_curvature="timoshenko")))
    assert eq_1 == pytest.approx(eq_11, rel=2e-5)


@pytest.mark.parametrize(("h1", "rough"), [(0.3, 0.08), (0.4, 0.045), (0.6, 0.02)])
def test_same_strips_in_both_conventions(h1, rough):
    """What the paper fitted with E1/E2 = 3200 and Eq. (1) is to Timoshenko a strip of about 1600, best if thick."""
    paper = float(rest_curvature(h1, Fabric(), Plastic(modulus_ratio=3200.0)))
    strip = float(rest_curvature(h1, Fabric(), Plastic(modulus_ratio=1600.0, rest_curvature="timoshenko")))
    assert (1.0 - rough) * paper < strip < paper
