"""Fabric under large strains is that of the exact model."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.energies.membrane import Membrane
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields
from asterism.previews.point_pins import MIN_DET_C, stretched_fabric

THICKNESS, MODULUS, POISSON, LAM = 0.8, 7.0, 0.3, 0.74
# per printed area and strain in printed coordinates
STIFFNESS = isotropic(THICKNESS * MODULUS / (1.0 - POISSON**2) / LAM**2, 0.5, POISSON)
FIELDS = Fields(Density(STIFFNESS), (LAM**2, LAM**2, 0.0))


def density(bare: float = 1.0, count: int = 1) -> Density:
    stiffness = np.broadcast_to(STIFFNESS, (1, count, 6, 6))
    fields = Fields(FIELDS.density, np.broadcast_to([LAM**2, LAM**2, 0.0], (1, count, 3)))
    return Density(stiffness, term=stretched_fabric(fields, stiffness, np.full((1, count), bare)))


def strain_of(shape: np.ndarray) -> np.ndarray:
    """(6,) of a flat sheet whose printed unit vectors become the columns of (2, 2)."""
    metric = shape.T @ shape - LAM**2 * np.eye(2)
    return np.array([0.5 * metric[0, 0], 0.5 * metric[1, 1], metric[0, 1], 0.0, 0.0, 0.0])


@pytest.mark.parametrize("stretch", [(0.6, 0.7), (0.74, 0.74), (1.0, 0.6), (3.0, 0.5), (2.0, 2.0)])
def test_the_energy_is_that_of_the_exact_models_triangles(stretch: tuple[float, float]) -> None:
    turn = np.radians(25.0)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shape = rotation @ np.diag(stretch) @ rotation.T
    printed = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]])
    triangle = Membrane(np.array([[0, 1, 2]]), LAM * printed, THICKNESS, MODULUS, POISSON)
    flat = np.column_stack([printed @ shape.T, np.zeros(3)])
    exact = float(triangle.energies(flat.ravel())[0]) / 0.4  # its printed area
    assert density()(strain_of(shape)[None, None])[0][0, 0] == pytest.approx(exact, rel=1e-9, abs=1e-12)


@pytest.mark.slow
def test_small_strains_are_the_laws() -> None:
    e = 1e-4 * np.random.default_rng(0).normal(size=(1, 20, 6))
    plain = Density(STIFFNESS)
    assert density(count=20)(e)[0] == pytest.approx(plain(e)[0], rel=2e-3)
    assert density(count=20)(e)[2] == pytest.approx(plain(e)[2], rel=5e-3, abs=1e-2)
    assert density(0.0, 20)(1e3 * e)[0] == pytest.approx(plain(1e3 * e)[0], rel=1e-12)


def test_stresses_and_stiffnesses_are_derivatives_also_where_no_surface_is() -> None:
    e = 0.15 * np.random.default_rng(3).normal(size=(1, 60, 6))
    law, step = density(0.6, e.shape[1]), 1e-5
    det = (1.0 + 2.0 * e[..., 0] / LAM**2) * (1.0 + 2.0 * e[..., 1] / LAM**2) - (e[..., 2] / LAM**2) ** 2
    assert (det < MIN_DET_C).any() and (det > MIN_DET_C).any()
    _, stress, stiffness = law(e)
    for k in range(6):
        by = np.zeros(6)
        by[k] = step
        up, down = law(e + by), law(e - by)
        assert (up[0] - down[0]) / (2.0 * step) == pytest.approx(stress[..., k], rel=1e-5, abs=1e-5)
        assert (up[1] - down[1]) / (2.0 * step) == pytest.approx(stiffness[..., k], rel=1e-4, abs=1e-4)
