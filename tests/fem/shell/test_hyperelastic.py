"""The energy of bare fabric has its derivatives, also where no surface is."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.fem.shell.hyperelastic import MIN_C, MIN_DET_C, hyperelastic


@pytest.mark.parametrize("exponents", [(1.0, 1.0), (1.6, 0.58)])
@pytest.mark.parametrize("low", [-0.15, -0.6])
def test_gradient_and_hessian_are_derivatives(low: float, exponents: tuple[float, float]) -> None:
    strains = np.random.default_rng(0).uniform(low, 0.4, (20, 3))
    det = (1.0 + 2.0 * strains[:, 0]) * (1.0 + 2.0 * strains[:, 1]) - strains[:, 2] ** 2
    assert (det < MIN_DET_C).any() == (1.0 + 2.0 * strains[:, :2] < MIN_C).any() == (low < -0.5)
    mu, lam = np.full(20, 1.3), np.full(20, 0.7)
    energy, gradient, hessian = hyperelastic(strains, mu, lam, exponents)
    assert (energy > 0.0).all()
    for k in range(3):
        step = 1e-6 * np.eye(3)[k]
        high, below = (hyperelastic(strains + sign * step, mu, lam, exponents) for sign in (1.0, -1.0))
        assert (high[0] - below[0]) / 2e-6 == pytest.approx(gradient[:, k], abs=1e-6)
        assert (high[1] - below[1]) / 2e-6 == pytest.approx(hessian[:, k], rel=1e-6, abs=1e-5)
