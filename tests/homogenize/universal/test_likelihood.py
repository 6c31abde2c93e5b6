"""The likelihood of scattered cells, and a scatter that varies over the range."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.universal.kriging import Covariance, likely_covariance, negative_log_likelihood


def test_the_gradient_is_that_of_the_likelihood() -> None:
    rng = np.random.default_rng(0)
    places, arms = rng.random((30, 3)), 0.2 + rng.random(30)
    values = arms * np.sin(3.0 * places[:, 0] + places[:, 1]) + 0.05 * rng.normal(size=30)
    parameters = np.array([-0.2, 0.3, 0.8, -5.0, 1.0, -2.0, 0.5])
    gradient = negative_log_likelihood(parameters, places, arms, values)[1]
    for number in range(len(parameters)):
        step = 1e-5 * np.eye(len(parameters))[number]
        ends = [negative_log_likelihood(parameters + sign * step, places, arms, values)[0] for sign in (-1.0, 1.0)]
        assert gradient[number] == pytest.approx((ends[1] - ends[0]) / 2e-5, rel=1e-5, abs=1e-5)


def test_the_likelihood_is_that_of_a_normal_distribution() -> None:
    rng = np.random.default_rng(1)
    places, arms, values = rng.random((12, 2)), 0.2 + rng.random(12), rng.normal(size=12)
    losses = []
    for parameters in (np.array([0.1, -0.3, -2.0, 1.0, 2.0]), np.array([0.5, 0.2, -1.0, -2.0, 0.0])):
        covariance = Covariance(np.exp(parameters[:2]), np.exp(parameters[2]), parameters[3:]).matrix(places, arms)
        variance = values @ np.linalg.solve(covariance, values) / len(values)
        minus_log_density = 0.5 * (np.linalg.slogdet(variance * covariance)[1] + 12.0)
        losses.append((negative_log_likelihood(parameters, places, arms, values)[0], minus_log_density))
    (one, plain_one), (other, plain_other) = losses
    assert one - other == pytest.approx(plain_one - plain_other, rel=1e-9)


def test_scatter_that_varies_is_found() -> None:
    rng = np.random.default_rng(2)
    places = rng.random((150, 2))
    noise = 0.3 * np.exp(-4.0 * places[:, 0])
    values = np.sin(4.0 * places[:, 1]) + noise * rng.normal(size=150)
    found = likely_covariance(places, np.ones(150), values)
    assert found.noise_slopes == pytest.approx([-8.0, 0.0], abs=1.5)
    even = likely_covariance(places, np.ones(150), values, even_noise=True)
    assert (even.noise_slopes == 0.0).all()
