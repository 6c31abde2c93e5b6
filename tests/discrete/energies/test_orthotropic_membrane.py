"""The membrane of fabric with a grain: its linear limit, stability at finite stretch, and equal moduli."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from scipy.optimize import minimize

from asterism.discrete.energies.membrane import Membrane
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.materials import Fabric
from tests.discrete.plain import full

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
KNITS = [
    Fabric(modulus_mpa=(9.0, 4.0)),
    Fabric(modulus_mpa=(4.0, 12.4), poisson=0.2),
    Fabric(modulus_mpa=(12.0, 4.0), shear_modulus_mpa=1.0),
    Fabric(modulus_mpa=(16.0, 4.0)),
]


def plane_stiffness(fabric: Fabric) -> Array:
    """(3, 3) MPa, of the strains along, across and shear, from the compliance of both moduli."""
    (along, across), mean = fabric.moduli, fabric.modulus
    both = -fabric.poisson / mean
    return np.linalg.inv([[1 / along, both, 0], [both, 1 / across, 0], [0, 0, 1 / fabric.shear_modulus]])


def energy(fabric: Fabric, deformation: Array) -> float:
    """N/mm^2, energy per volume of a square with this deformation gradient (2, 2)."""
    flat = np.column_stack([SQUARE @ deformation.T, np.zeros(4)])
    return float(Membrane(HALVES, SQUARE, fabric).energies(flat.ravel()).sum() / fabric.thickness_mm)


@pytest.mark.parametrize("fabric", KNITS)
@pytest.mark.parametrize("angle", [0.0, 45.0, 90.0, 25.0])
def test_a_strip_that_is_pulled(fabric: Fabric, angle: float) -> None:
    """Its modulus at this angle to the grain, its contraction across, and its shear where it is off the grain."""
    turned = fabric.model_copy(update={"grain_deg": -angle})
    membrane, strain = Membrane(HALVES, SQUARE, turned), 1e-4

    def of(free: Array) -> tuple[float, Array]:
        """The energy and its derivatives by the strain across and the shear."""
        deformation = np.array([[1.0 + strain, free[1]], [0.0, 1.0 + free[0]]])
        flat = np.column_stack([SQUARE @ deformation.T, np.zeros(4)]).ravel()
        force = np.zeros(12)
        np.add.at(force, membrane.dofs, membrane.gradients(flat))
        force = force.reshape(4, 3)
        return 1e6 * membrane.energies(flat).sum(), 1e6 * np.array(
            [force[:, 1] @ SQUARE[:, 1], force[:, 0] @ SQUARE[:, 1]]
        )

    relaxed = minimize(of, np.zeros(2), jac=True, method="BFGS", options={"gtol": 1e-9})
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    compliance = np.linalg.inv(plane_stiffness(fabric))
    # strains along the grain of a stress of 1 along the strip, then along the strip
    grain = compliance @ [c * c, s * s, s * c]
    along = grain @ [c * c, s * s, s * c]
    across, shear = grain @ [s * s, c * c, -s * c], grain @ [-2 * s * c, 2 * s * c, c * c - s * s]
    assert relaxed.fun / 1e6 / fabric.thickness_mm == pytest.approx(0.5 * strain**2 / along, rel=1e-3)
    np.testing.assert_allclose(relaxed.x / strain, [across / along, shear / along], atol=2e-3)


@pytest.mark.parametrize("fabric", KNITS)
def test_it_is_stable_from_half_to_double_length(fabric: Fabric) -> None:
    """Strong ellipticity: every wave a x b in the plane has energy, at any stretch and angle to the grain."""
    membrane, least = Membrane(HALVES[:1], SQUARE, fabric), np.inf
    waves = np.array([(np.cos(t), np.sin(t)) for t in np.linspace(0.0, np.pi, 25)[:-1]])
    moved = np.zeros((len(waves), len(waves), 3, 3))
    moved[..., :2] = np.einsum("vj,bj,ac->abvc", SQUARE[:3], waves, waves)
    moved = moved.reshape(-1, 9)
    for first, second, angle in product((0.5, 0.8, 1.35, 2.0), (0.5, 0.8, 1.35, 2.0), np.linspace(0.0, np.pi, 13)[:-1]):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        deformed = SQUARE @ (turn @ np.diag([first, second]) @ turn.T)
        hessian = full(membrane.hessians(np.column_stack([deformed, np.zeros(4)]).ravel()))[0]
        least = min(least, np.einsum("wi,ij,wj->w", moved, hessian, moved).min())
    assert least > 1e-3 * fabric.thickness_mm * fabric.shear_modulus / 2


def test_equal_moduli_with_a_grain_are_neo_hookean() -> None:
    """Turned axes only round differently."""
    rng = np.random.default_rng(3)
    one, two = (Fabric(modulus_mpa=moduli, grain_deg=g) for moduli, g in ((7.0, 0.0), ((7.0, 7.0), 33.0)))
    for _ in range(10):
        deformation = np.eye(2) + 0.3 * rng.normal(size=(2, 2))
        if np.linalg.det(deformation) > 0.1:
            assert energy(two, deformation) == pytest.approx(energy(one, deformation), rel=1e-12)
