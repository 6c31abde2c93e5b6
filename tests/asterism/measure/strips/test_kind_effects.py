"""What kinds have in common, against the full covariance matrix of a random effect."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from asterism.measure.strips.kind_effects import KindEffects, effect_sizes, fit_kind_effects, variance_factor

KIND = np.repeat(np.arange(6), (3, 4, 5, 3, 4, 2))
FIRST = KIND < 3


def _problem(seed: int, effect: float) -> tuple[np.ndarray, ...]:
    """Readings of six kinds, three with fabric; two parameters, and other variances from reading to reading."""
    rng = np.random.default_rng(seed)
    slope = np.array([3.0, 2.0, 1.2, 0.0, 0.0, 0.0])[KIND]
    jacobian = np.column_stack([slope, np.ones(len(KIND))])
    variance = rng.uniform(0.5, 2.0, len(KIND)) * 0.05**2
    values = jacobian @ [1.0, 0.3] + np.sqrt(variance) * rng.standard_normal(len(KIND))
    values += effect * (slope * rng.standard_normal(6)[KIND])
    return values, jacobian, variance, effect_sizes(slope, ~FIRST)


def _together(variance: np.ndarray, shared: np.ndarray) -> np.ndarray:
    return np.diag(variance) + np.where(KIND[:, None] == KIND, shared[:, None], 0.0)


def test_larger_variances_do_what_a_shared_error_does() -> None:
    values, jacobian, variance, sizes = _problem(0, 0.2)
    shared = KindEffects(0.2, 0.07).variance(sizes)
    inverse = np.linalg.inv(_together(variance, shared))
    weight = 1 / (variance * variance_factor(KIND, variance, shared))
    np.testing.assert_allclose(jacobian.T @ inverse @ jacobian, (jacobian * weight[:, None]).T @ jacobian, rtol=1e-10)
    np.testing.assert_allclose(jacobian.T @ inverse @ values, jacobian.T @ (weight * values), rtol=1e-10)


@pytest.mark.parametrize("marks", [0.0, 0.1])
@pytest.mark.parametrize("seed", range(5))
def test_effects_are_those_of_restricted_maximum_likelihood(seed: int, marks: float) -> None:
    """`marks`: by which rounding is known to move whole kinds."""
    values, jacobian, variance, sizes = _problem(seed, 0.2)
    residual = values - jacobian @ [1.0, 0.3]
    found = KindEffects()
    for _ in range(30):
        found = fit_kind_effects(KIND, residual, jacobian, variance, np.full(len(KIND), marks), sizes, found)

    def minus_log(one: KindEffects) -> float:
        matrix = _together(variance, one.variance(sizes) + marks**2)
        inverse = np.linalg.inv(matrix)
        information = jacobian.T @ inverse @ jacobian
        off = residual - jacobian @ np.linalg.solve(information, jacobian.T @ inverse @ residual)
        return float(np.linalg.slogdet(matrix)[1] + np.linalg.slogdet(information)[1] + off @ inverse @ off)

    for which in ("with_fabric", "peeled"):
        mine = getattr(found, which)
        best = minimize_scalar(
            lambda x, which=which: minus_log(KindEffects(**(vars(found) | {which: x}))), bounds=(0, 1), method="bounded"
        )
        if mine:
            assert mine == pytest.approx(best.x, rel=1e-3, abs=1e-5)
        else:
            assert best.x < 1e-4


def test_kinds_that_are_needed_for_the_parameters_have_nothing_in_common() -> None:
    values, jacobian, variance, sizes = _problem(0, 0.5)
    some = KIND < 2  # two kinds, two parameters
    found = fit_kind_effects(
        KIND[some], values[some], jacobian[some], variance[some], np.zeros(some.sum()), sizes[:, some], KindEffects()
    )
    assert found == KindEffects()


def test_what_the_fabric_does_is_nothing_to_peeled_strips() -> None:
    np.testing.assert_array_equal(
        effect_sizes(np.array([0.02, 0.03]), np.array([False, True])), [[0.02, 0.0], [0.0, 1.0]]
    )
