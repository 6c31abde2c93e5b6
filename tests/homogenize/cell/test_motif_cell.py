"""Cells of motifs: meshes, larger cells, and stars written as rods.

Closed forms for lines and grids: rest metric, membrane, bending, twist, shear of a rigid frame.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from asterism.discrete.energies.rods.network import torsion_constant
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.free_cell_mesh import motif_cell_mesh
from asterism.homogenize.cell.motif_responses import CellComparison, compare_with_larger_cell, rod_bending
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.rolling import roll_cell, unrolled_flat_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import MeshError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.rods.motif_graph import motif_graph
from tests.homogenize.cells import TURN, relaxed_cell
from tests.homogenize.cells import design as star_design
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.motifs import Pattern, diamonds, grid, honeycomb, motif_design, moved, parallel, stars, waves

EDGE = 3.0


@pytest.mark.slow
@settings(max_examples=2, deadline=None, derandomize=True)
@given(x=st.floats(-30.0, 30.0), y=st.floats(-30.0, 30.0))
def test_results_do_not_depend_on_where_the_motif_is_in_its_lattice(x: float, y: float) -> None:
    expected = relaxed_cell("diamonds")[1]
    flat = relax_flat_cell(UnitCell(motif_design(moved(diamonds(), (x, y))), EDGE))
    assert flat.energy == pytest.approx(expected.energy, rel=1e-7)
    np.testing.assert_allclose(flat.deformation, expected.deformation, atol=1e-6)


@pytest.mark.parametrize("name", ["grid", "diamonds"])
def test_the_linear_cell_is_that_of_slightly_curved_tubes(name: str) -> None:
    """The second derivative for a cylinder is the slope of the moment, by the print's curvature `hoop k`."""
    cell, flat = relaxed_cell(name)
    linear = effective_stiffness(cell, flat)
    around = np.array([-np.sin(TURN), np.cos(TURN)])
    form = np.array([around[0] ** 2, around[1] ** 2, 2.0 * around[0] * around[1]])
    a, b, d = linear.stiffness[:3, :3], linear.stiffness[:3, 3:], linear.stiffness[3:, 3:]
    condensed = d - b.T @ np.linalg.solve(a, b)
    ahead, behind = (roll_cell(cell, unrolled_flat_cell(flat, TURN), side * 1e-3, TURN) for side in (1, -1))
    hoop = 0.5 * (ahead.hoop + behind.hoop)
    assert 0.5 * (ahead.moment + behind.moment) / hoop == pytest.approx(linear.moment @ form, rel=1e-3)
    assert (ahead.moment - behind.moment) / 2e-3 / hoop**2 == pytest.approx(form @ condensed @ form, rel=1e-3)


@pytest.mark.slow
def test_stars_written_as_rods_are_stars() -> None:
    """Pairs and a joint are the same up to the mesh; 0.1 % in stretch, 0.5 % in the mean natural curvature."""
    results = []
    for design in (star_design(10.0, 0.4), motif_design(stars(10.0), 0.4)):
        cell = UnitCell(design, 1.5)
        flat = relax_flat_cell(cell)
        tubes = [trace_tubes(cell, flat, angle).natural for angle in (0.0, np.pi / 6)]
        results.append((flat, np.mean([tube.contracted_curvature for tube in tubes if tube is not None])))
    (star, star_curvature), (rods, curvature) = results
    np.testing.assert_allclose(rods.deformation, star.deformation, atol=1e-3)
    assert rods.stretch == pytest.approx(star.stretch, rel=1e-3)
    assert curvature == pytest.approx(star_curvature, rel=5e-3)


@pytest.mark.parametrize("pattern", [parallel(), grid(), diamonds(), pytest.param(honeycomb(), marks=pytest.mark.slow)])
def test_meshes_follow_the_rods(pattern: Pattern) -> None:
    design = motif_design(pattern)
    assert design.rods is not None
    motif = motif_graph(design.rods, design.lattice)
    mesh = motif_cell_mesh(motif, 2.0)
    length = sum(np.linalg.norm(np.diff(mesh.points[rod], axis=0), axis=1).sum() for rod in mesh.rods)
    assert length == pytest.approx(sum(rod.length for rod in motif.rods), rel=0.01)
    assert mesh.area == pytest.approx(abs(np.linalg.det(motif.vectors)))
    np.testing.assert_allclose(mesh.points[0], 0.0, atol=1e-12)


@pytest.mark.parametrize(("kind", "aside"), [("square", 0.05), ("triangular", 0.03)])
def test_a_line_that_ends_beside_a_copy_of_another_is_refused_with_its_place(kind: str, aside: float) -> None:
    lattice = {"kind": kind, "spacing_mm": 10.0}
    one, other = np.asarray(Lattice.model_validate(lattice).vectors)
    ends = [one.tolist(), (other + aside * one).tolist()]
    rods = {"motif": [{"line_mm": [[0, 0], end], "width_mm": 1.0} for end in ends], "thickness_mm": 0.4}
    design = Design.from_dict({"rods": rods, "lattice": lattice, "border": {"rings": 1}})
    with pytest.raises(MeshError, match=r"two lines touch at \(.*\) mm: move the end of one away"):
        motif_cell_mesh(motif_graph(design.rods, design.lattice), 1.0)


def compared(pattern: Pattern) -> CellComparison:
    design = motif_design(pattern)
    return compare_with_larger_cell(design, 3.5, relax_flat_cell(UnitCell(design, 3.5)))


@pytest.mark.slow
@pytest.mark.parametrize("pattern", [diamonds(), waves()])
def test_diamonds_and_waves_repeat_cell_by_cell(pattern: Pattern) -> None:
    comparison = compared(pattern)
    assert comparison.reason is None
    assert abs(comparison.excess) < 1e-6
    np.testing.assert_allclose(comparison.larger_stretches, comparison.stretches, atol=1e-5)


@pytest.mark.slow
def test_a_connected_honeycomb_has_no_law_of_one_cell() -> None:
    comparison = compared(honeycomb())
    assert comparison.excess > 0.1 and comparison.reason is not None
    assert comparison.stretches.min() > 0.99 and comparison.larger_stretches.min() < 0.8
    assert comparison.reason.startswith("the motif has no law of one cell: 2 x 2 cells relax to ")


@pytest.mark.slow
@pytest.mark.parametrize("pattern", [parallel(5.0), diamonds()], ids=["lines", "diamonds"])
def test_rods_in_fabric_too_soft_to_count_are_the_linear_cell(pattern: Pattern) -> None:
    """In all entries: the fabric has no tension, so that the cell can be cut anywhere."""
    design = stiff(pattern)
    cell = UnitCell(design, 1.5)
    flat = relax_flat_cell(cell)
    expected = effective_stiffness(cell, flat).stiffness[3:, 3:]
    np.testing.assert_allclose(rod_bending(design, flat.deformation), expected, atol=0.012 * expected.max())


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

    def mixed(a: np.ndarray, b: np.ndarray) -> float:
        return energy(rest.x + a + b) - energy(rest.x + a - b) - energy(rest.x - a + b) + energy(rest.x - a - b)

    # by the strain, which is half the metric's change
    expected = 1e8 * np.array([[mixed(a, b) for b in 1e-4 * np.eye(2)] for a in 1e-4 * np.eye(2)])
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
