"""V1: gradients and Hessians of every energy, at random states and at states bent by more than 90 degrees.

Both come from complex steps through the formulas on arrays, which have no truncation error: the tolerance is rounding.
For rods the derivative of the gradient is not symmetric away from equilibrium (transporting a director around a loop
turns it); the Hessian is its symmetric part (Bergou et al. 2010).
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from asterism.equilibrium.arrays import Array
from tests.discrete.plain import full, plain_energies, plain_gradients, plain_hessians
from tests.discrete.samples import COUNT, SAMPLES, Sample

STEP = 1e-30
PLACES = pytest.mark.parametrize("bent", [False, True], ids=["random", "bent"])
ENERGIES = pytest.mark.parametrize("name", SAMPLES)


def make(name: str, bent: bool) -> Sample:
    return SAMPLES[name](np.random.default_rng(7), bent)


def relative(value: Array, reference: Array) -> float:
    """Largest error of any element over the largest entry of that element."""
    axes = tuple(range(1, reference.ndim))
    scale = np.abs(reference).max(axis=axes)
    return float((np.abs(value - reference).max(axis=axes) / scale).max())


def complex_steps(sample: Sample, n: int, function) -> Array:
    """(E, ..., n) derivatives of `function` of the configuration by every dof of each element."""
    columns = []
    for i in range(n):
        step = np.zeros((COUNT, n), dtype=complex)
        step[:, i] = 1j * STEP
        columns.append(function(sample.moved(step)).imag / STEP)
    return np.stack(columns, axis=-1)


@ENERGIES
@PLACES
def test_gradient_and_hessian(name, bent):
    sample = make(name, bent)
    n, packed = sample.elements.dofs_per_element, sample.state.packed
    expected = complex_steps(sample, n, partial(plain_energies, sample.elements))
    assert relative(sample.elements.gradients(packed), expected) < 1e-11
    derivative = complex_steps(sample, n, partial(plain_gradients, sample.elements))
    expected = 0.5 * (derivative + derivative.swapaxes(1, 2))
    assert relative(full(sample.elements.hessians(packed)), expected) < 1e-11
    if not name.startswith("rod"):
        # without directors there is no holonomy, so the derivative is symmetric
        assert relative(derivative, expected) < 1e-11


@ENERGIES
@PLACES
@pytest.mark.parametrize("blend", [0.0, 0.3, 1.0])
def test_compiled_and_plain_paths_agree(name, bent, blend):
    sample = make(name, bent)
    elements, packed = sample.elements, sample.state.packed
    compiled = [elements.energies(packed), elements.gradients(packed), elements.hessians(packed, blend)]
    plain = [plain_energies(elements, packed), plain_gradients(elements, packed)]
    plain.append(plain_hessians(elements, packed, blend))
    for one, other in zip(compiled, plain, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-12 * np.abs(other).max())


@ENERGIES
@PLACES
def test_blend_interpolates_from_exact_to_semidefinite(name, bent):
    """Blended Hessians are linear in the blend; some exact element Hessians are indefinite."""
    sample = make(name, bent)
    packed = sample.state.packed
    exact, convex = (full(sample.elements.hessians(packed, blend)) for blend in (0.0, 1.0))
    scale = np.abs(exact).max(axis=(1, 2))
    assert (np.linalg.eigvalsh(convex)[:, 0] > -1e-12 * scale).all()
    assert (np.linalg.eigvalsh(exact)[:, 0] < -1e-4 * scale).any()
    between = full(sample.elements.hessians(packed, 0.25))
    assert relative(between, 0.75 * exact + 0.25 * convex) < 1e-12


def test_blend_keeps_a_definite_membrane_as_it_is():
    """In tension the Hessian is positive semidefinite, so the blended Hessian is the exact one."""
    sample = make("membrane", False)
    grown = sample.state.packed * 1.6
    exact, convex = (full(sample.elements.hessians(grown, blend)) for blend in (0.0, 1.0))
    stable = np.linalg.eigvalsh(exact)[:, 0] > -1e-12 * np.abs(exact).max(axis=(1, 2))
    assert stable.sum() > COUNT // 2
    assert relative(convex[stable], exact[stable]) < 1e-12
