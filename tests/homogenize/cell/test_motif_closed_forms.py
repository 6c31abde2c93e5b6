"""Cells of lines and grids against closed forms: rest metric, membrane, bending, twist, shear of a rigid frame."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import minimize

from asterism.discrete.energies.rods.network import torsion_constant
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.motifs import Pattern, grid, motif_design, parallel

WIDTH, THICKNESS = 1.2, 0.4


def plastic_modulus(design: Design) -> float:
    return design.fabric.modulus_mpa * design.plastic.modulus_ratio


def density(design: Design, along: tuple[bool, bool], distance: float) -> Callable[[np.ndarray], float]:
    """N/mm: neo-Hookean fabric that is strained evenly, and rods along x, y or both, by the metric (xx, yy)."""
    fabric = design.fabric
    mu, lam = fabric.modulus_mpa / 2.6, fabric.modulus_mpa * 0.3 / 0.91
    stretch = float(fabric.stretch_xy[0])
    rod = plastic_modulus(design) * WIDTH * THICKNESS / distance

    def energy(metric: np.ndarray) -> float:
        log = 0.5 * np.log(metric.prod() * stretch**4)
        sheet = 0.5 * mu * (metric.sum() * stretch**2 - 2.0 - 2.0 * log) + 0.5 * lam * log**2
        rods = sum(0.5 * rod * (np.sqrt(a) - 1.0) ** 2 for a, has_rods in zip(metric, along, strict=True) if has_rods)
        return float(fabric.thickness_mm / stretch**2 * sheet + rods)

    return energy


@pytest.mark.parametrize(
    ("pattern", "along", "distance"),
    [(parallel(5.0), (True, False), 5.0), pytest.param(grid(10.0), (True, True), 10.0, marks=pytest.mark.slow)],
)
def test_rest_metric_and_membrane_of_lines_and_grids(
    pattern: Pattern, along: tuple[bool, bool], distance: float
) -> None:
    """The sheet strains evenly, hence exactly on any mesh. Across lines alone the fabric contracts uniaxially."""
    design = motif_design(pattern, THICKNESS)
    cell = UnitCell(design, 3.0)
    flat = relax_flat_cell(cell)
    energy = density(design, along, distance)
    rest = minimize(energy, [0.9, 0.9], method="Nelder-Mead", options={"xatol": 1e-12, "fatol": 1e-15, "maxiter": 2000})
    np.testing.assert_allclose(np.diag(flat.deformation) ** 2, rest.x, rtol=1e-6)
    assert abs(flat.deformation[0, 1]) < 1e-6
    step = 1e-4 * np.eye(2)
    # by the strain, which is half the metric's change
    expected = 4e8 * np.array(
        [
            [
                (energy(rest.x + a + b) - energy(rest.x + a - b) - energy(rest.x - a + b) + energy(rest.x - a - b)) / 4
                for b in step
            ]
            for a in step
        ]
    )
    membrane = effective_stiffness(cell, flat).stiffness[:2, :2]
    np.testing.assert_allclose(membrane, expected, rtol=1e-3, atol=1e-3)


def stiff(pattern: Pattern) -> Design:
    """Rods in fabric that is too soft to count, and hardly stretched."""
    plastic = {"rest_curvature": "none", "modulus_ratio": 1e5}
    return motif_design(pattern, THICKNESS, plastic=plastic, fabric={"stretch": 1.001})


@pytest.mark.parametrize(
    ("pattern", "families"), [(parallel(5.0), 1), pytest.param(grid(10.0), 2, marks=pytest.mark.slow)]
)
def test_bending_and_twist_are_those_of_the_rods(pattern: Pattern, families: int) -> None:
    """`B/d` along rods, `T/(4 d)` a family for the twist 2 K12; joints pass both on, and couple no two directions."""
    design = stiff(pattern)
    cell = UnitCell(design, 2.0)
    stiffness = effective_stiffness(cell, relax_flat_cell(cell)).stiffness[3:, 3:]
    modulus = plastic_modulus(design)
    bending = modulus * WIDTH * THICKNESS**3 / 12.0 / cell.spacing
    shear = modulus / (2.0 * (1.0 + design.plastic.poisson))
    torsion = shear * float(torsion_constant(np.array([WIDTH]), np.array([THICKNESS]))[0]) / (4.0 * cell.spacing)
    assert stiffness[0, 0] == pytest.approx(bending, rel=3e-3)
    assert stiffness[1, 1] == pytest.approx(bending if families == 2 else 0.0, rel=3e-3, abs=2e-3 * bending)
    assert stiffness[2, 2] == pytest.approx(families * torsion, rel=6e-3)
    assert abs(stiffness[0, 1]) < 2e-3 * bending


@pytest.mark.slow
def test_shear_of_a_grid_is_that_of_a_frame_with_rigid_joints() -> None:
    """`6 C/d^3` with the stiffness C in the plane (Gibson and Ashby, Cellular Solids, for square cells); the error
    falls at least 3.5-fold from 5 to 10 edges a rod."""
    design = stiff(grid(10.0))
    expected = 6.0 * plastic_modulus(design) * THICKNESS * WIDTH**3 / 12.0 / 10.0**3
    errors = []
    for edge in (2.0, 1.0):
        cell = UnitCell(design, edge)
        stiffness = effective_stiffness(cell, relax_flat_cell(cell)).stiffness
        errors.append(abs(stiffness[2, 2] / expected - 1.0))
    assert errors[1] < 0.015 and errors[0] > 3.5 * errors[1]
