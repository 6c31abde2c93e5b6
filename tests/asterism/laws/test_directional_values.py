"""Values along directions turn with the sheet, and a tube has the curvature of least bending energy."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.tensor_forms import TO_VOIGT, SheetTensors
from asterism.laws.law_picture import stretch_axes, values_along


def sheet(seed: int = 3) -> SheetTensors:
    random = np.random.default_rng(seed)
    factors = random.normal(size=(2, 3, 3))
    stiffness = np.zeros((1, 6, 6))
    for part, factor in zip((slice(0, 3), slice(3, 6)), factors, strict=True):
        stiffness[0, part, part] = factor @ factor.T + np.eye(3)
    return SheetTensors(np.array([[0.9, 1.1, 0.15]]), stiffness, random.normal(0.0, 0.02, (1, 3)))


def unit(angle: float) -> Floats:
    return np.array([[np.cos(angle), np.sin(angle)]])


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.0])
def test_a_tube_has_the_least_bending_energy_among_all_curvatures_along_its_direction(angle: float) -> None:
    tensors = sheet()
    (x, y) = unit(angle)[0]
    form, rest = np.array([x * x, y * y, 2.0 * x * y]), tensors.curvature[0] * TO_VOIGT
    bending = tensors.stiffness[0, 3:, 3:]

    def energy(curvature: float) -> float:
        apart = -curvature * form - rest
        return float(0.5 * apart @ bending @ apart)

    rolled = float(values_along(tensors, unit(angle))["rolled"][0, 0])
    step = 1e-3
    assert energy(rolled) < min(energy(rolled - step), energy(rolled + step))
    assert energy(rolled + step) == pytest.approx(energy(rolled - step), rel=1e-9)


def test_stretches_are_lengths_of_the_flat_sheet_and_stretch_axes_have_the_extreme_ones() -> None:
    tensors = sheet()
    metric = np.array([[0.9, 0.15], [0.15, 1.1]])
    angles = np.linspace(0.0, np.pi, 721)
    axes = np.stack([np.cos(angles), np.sin(angles)], -1)
    stretches = values_along(tensors, axes)["stretch"][0]
    assert stretches == pytest.approx(np.sqrt(np.einsum("na,ab,nb->n", axes, metric, axes)))
    smaller, larger = values_along(tensors, stretch_axes(tensors.metric))["stretch"][0]
    assert smaller == pytest.approx(stretches.min(), rel=1e-5)
    assert larger == pytest.approx(stretches.max(), rel=1e-5)


def test_axes_of_a_sheet_that_contracts_evenly_are_x_and_y() -> None:
    assert stretch_axes(np.array([[0.81, 0.81, 0.0]])).tolist() == [[[1.0, 0.0], [0.0, 1.0]]]


def test_stiffnesses_along_x_are_the_first_components() -> None:
    tensors = sheet()
    values = values_along(tensors, np.array([[1.0, 0.0]]))
    assert values["membrane"][0, 0] == pytest.approx(tensors.stiffness[0, 0, 0])
    assert values["bending"][0, 0] == pytest.approx(tensors.stiffness[0, 3, 3])
