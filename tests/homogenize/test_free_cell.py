"""Cells on free meshes: the same checks as on aligned ones, and both meshes of the same star against each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import block_diag

from asterism.discrete.energies.bending.hinges import hinge_coefficients
from asterism.discrete.energies.elements import Elements
from asterism.discrete.model.state import State
from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.rolling import roll_cell, rolled_state, unrolled_flat_cell
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from tests.discrete.plain import plain_energies
from tests.homogenize.cells import EDGE, design, full, shaken
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.stability import cell_stability, unfolded_hessian
from tests.homogenize.test_cell_symmetry import _moved

FIVE = {"lattice": {"arms": 5}}
KINDS = pytest.mark.parametrize("tube", [False, True], ids=["flat", "tube"])


def five(length: float = 7.0, thickness: float = 0.4, **more: Any) -> UnitCell:
    return UnitCell(design(length, thickness, **(FIVE | more)), EDGE)


@pytest.fixture(scope="module")
def relaxed() -> tuple[UnitCell, FlatCell]:
    cell = five()
    return cell, relax_flat_cell(cell)


def bent(cell: UnitCell, flat: FlatCell, tube: bool) -> State:
    """A state away from equilibrium."""
    cell.set_flat()
    state = rolled_state(cell, unrolled_flat_cell(flat, 0.3), 0.06, 0.3) if tube else flat.state
    return shaken(cell, state, 0.05)


@KINDS
def test_gradient_and_hessian_are_the_energys(relaxed: tuple[UnitCell, FlatCell], tube: bool) -> None:
    """V1: complex step for the gradient, second differences for the Hessian along a path."""
    cell, flat = relaxed
    state = bent(cell, flat, tube)
    direction = np.random.default_rng(7).normal(size=len(cell.free))
    path = cell.path(state, direction)[0]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Elements, "energies", plain_energies)
        slope = sum(part.energies(path(1e-30j).packed).sum().imag / 1e-30 for part in cell.parts.values())
    assert cell.gradient(state) @ direction == pytest.approx(slope, rel=1e-11)
    hessian = full(cell.pattern.lower(cell.hessian(state, 0.0)))
    second = (cell.energy(path(1e-4)) + cell.energy(path(-1e-4)) - 2.0 * cell.energy(state)) / 1e-8
    assert direction @ hessian @ direction == pytest.approx(second, rel=1e-4)


def test_elements_with_two_images_of_one_point() -> None:
    """On the coarsest meshes; the Hessian against that of the unfolded points, folded by a matrix."""
    cell = UnitCell(design(7.0, 0.4, lattice={"arms": 5, "orientation_deg": 7}, fabric={"bending": "consistent"}), 6.5)
    torus, rods = cell.mesh, len(cell.edges)
    assert any(len(np.unique(row)) < len(row) for part in cell.parts.values() for row in part.dofs)
    cell.set_release(0.6)
    cell.set_flat()
    state = shaken(cell, cell.printed_state(), 0.1)
    fold = np.zeros((len(torus.base), torus.n_base + 2))
    fold[np.arange(len(torus.base)), torus.base] = 1.0
    fold[:, torus.n_base :] = torus.image
    fold = block_diag(np.kron(fold, np.eye(3)), np.eye(rods))
    whole = (fold.T @ unfolded_hessian(cell, state).toarray() @ fold)[np.ix_(cell.free, cell.free)]
    found = full(cell.pattern.lower(cell.hessian(state, 0.0)))
    np.testing.assert_allclose(found, whole, atol=1e-11 * np.abs(whole).max())


@KINDS
def test_the_sheet_may_be_moved(relaxed: tuple[UnitCell, FlatCell], tube: bool) -> None:
    """V2: turns in space, or about the tube's axis, and shifts along it change nothing."""
    cell, flat = relaxed
    state = bent(cell, flat, tube)
    cos, sin = np.cos(1.3), np.sin(1.3)
    turn = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])
    n = cell.mesh.n_base
    x = state.positions @ turn.T
    if tube:
        x[n:] = state.positions[n:]
    x[:n, 0] += 11.0
    assert cell.energy(State(x, state.directors @ turn.T)) == pytest.approx(cell.energy(state), rel=1e-12)


@pytest.mark.parametrize("lattice", [{"arms": 5}, {"arms": 8, "kind": "square"}, {"orientation_deg": 20}])
def test_without_arms_it_is_the_fabric(lattice: dict[str, Any]) -> None:
    """Also next to the points where arms would be: those of short ones stay in the mesh."""
    bare = solve_cell(design(0.0, lattice=lattice), EDGE, (0.0, 0.5))
    np.testing.assert_allclose(bare.rest_metric, 1.35**-2 * np.eye(2), atol=1e-9)
    assert bare.lam == pytest.approx(1.0 / 1.35, abs=1e-8)
    np.testing.assert_array_equal(bare.natural_curvature, 0.0)
    short = relax_flat_cell(UnitCell(design(1.0, 0.2, lattice=lattice), EDGE)).stretch
    assert 0.0 < short - bare.lam < 0.01


@KINDS
def test_uniform_sheets_have_their_closed_form(tube: bool) -> None:
    """Bare fabric on the mesh of a five-armed star; on the cylinder its hinges' and triangles' energies, one by one."""
    cell = five()
    fabric, n = cell.design.fabric, cell.mesh.n_base
    mu, lam = fabric.modulus_mpa / 2.6, fabric.modulus_mpa * 0.3 / 0.91
    if tube:
        curvature, hoop, axial = 0.05, 0.8, 0.7
        cell.set_tube(curvature)
        turn = curvature * cell.printed[:, 1]
        radius = hoop / curvature
        every = np.column_stack([axial * cell.printed[:, 0], radius * np.sin(turn), radius * np.cos(turn)])
        macro = np.column_stack([axial * cell.cell_vectors[:, 0], np.zeros((2, 2))])
    else:
        deformation = np.array([[0.8, 0.07], [0.02, 0.93], [0.1, -0.2]])
        every, macro = cell.printed @ deformation.T, cell.cell_vectors @ deformation.T
    state = State(np.vstack([every[:n], macro]), cell.printed_state().directors)
    np.testing.assert_allclose(cell.images.unfold(state.positions), every, atol=1e-11)
    found = {name: sum(v for key, v in cell.energies(state).items() if key.startswith(name)) for name in
             ("membrane", "hinges")}  # fmt: skip
    corner, place = cell.printed[cell.mesh.triangles] / 1.35, every[cell.mesh.triangles]
    rest = np.swapaxes(corner[:, 1:] - corner[:, :1], 1, 2)
    gradient = np.swapaxes(place[:, 1:] - place[:, :1], 1, 2) @ np.linalg.inv(rest)
    metric = np.swapaxes(gradient, 1, 2) @ gradient
    log = 0.5 * np.log(np.linalg.det(metric))
    density = 0.5 * mu * (np.trace(metric, axis1=1, axis2=2) - 2.0 - 2.0 * log) + 0.5 * lam * log**2
    expected = fabric.thickness_mm * (density * 0.5 * np.linalg.det(rest)).sum()
    assert found["membrane"] == pytest.approx(expected, rel=1e-10)
    if not tube:  # all triangles have the same strain
        same = fabric.thickness_mm * density[0] * cell.area / 1.35**2
        assert found["membrane"] == pytest.approx(same, rel=1e-10)
        assert found["hinges"] == pytest.approx(0.0, abs=1e-12)
        return
    a, b, left, right = every[cell.mesh.hinges].swapaxes(0, 1)
    one, two = np.cross(b - a, left - a), np.cross(right - a, b - a)
    cosine = (one * two).sum(axis=1) / np.linalg.norm(one, axis=1) / np.linalg.norm(two, axis=1)
    stiff = hinge_coefficients(cell.mesh.hinges, cell.printed, fabric.bending_tensor.d11)
    bending = (np.ravel(stiff) * 4.0 * (1.0 - cosine) / (1.0 + cosine)).sum()
    assert found["hinges"] == pytest.approx(bending, rel=1e-8)


@pytest.mark.parametrize(("length", "lattice"), [(7.0, {"arms": 5}), (6.0, {"arms": 8, "kind": "square"}),
                                                 (10.0, {"orientation_deg": 10})])  # fmt: skip
def test_stars_in_any_direction_have_equilibria(length: float, lattice: dict[str, Any]) -> None:
    """A flat one, a stable natural tube, curled with the plastic outside, and a stiffness."""
    cell = UnitCell(design(length, 0.4, lattice=lattice), EDGE)
    flat = relax_flat_cell(cell)
    assert 1.0 / 1.35 < flat.stretch < 1.0
    assert flat.bump[0] > 0.0
    natural = trace_tubes(cell, flat, 0.2).natural
    assert natural is not None and natural.curvature > 0.0
    cell.set_tube(natural.curvature, 0.2)
    eigenvalues = cell_stability(cell, natural.state)
    assert eigenvalues.cell > 0.0 and eigenvalues.supercell > 0.0
    stiffness = effective_stiffness(cell, flat).stiffness
    assert np.linalg.eigvalsh(stiffness[:3, :3])[0] > 0.0


def test_a_star_turned_onto_itself_responds_alike() -> None:
    one, other = (relax_flat_cell(five(lattice={"arms": 5, "orientation_deg": angle})) for angle in (3.0, 75.0))
    np.testing.assert_allclose(one.deformation, other.deformation, rtol=1e-10)


@KINDS
def test_two_cells_have_twice_the_energy_and_no_forces(tube: bool) -> None:
    cell = five()
    flat = relax_flat_cell(cell)
    two = UnitCell(design(7.0, 0.4, **FIVE), EDGE, repeat=(2, 1))
    state, energy, error = flat.state, flat.energy, flat.gradient_norm
    if tube:
        found = roll_cell(cell, unrolled_flat_cell(flat, 0.3), 0.05, 0.3)
        state, energy, error = found.state, found.energy, found.gradient_norm
        two.set_tube(0.05, 0.3)
    moved = _moved(cell, state, two, np.eye(2))
    assert two.energy(moved) == pytest.approx(2.0 * energy * cell.area, rel=1e-11)
    assert np.linalg.norm(two.gradient(moved)) < 4.0 * error + 1e-9


@pytest.mark.parametrize("thickness", [pytest.param(0.4, marks=pytest.mark.slow), 0.6])
def test_free_and_aligned_meshes_agree(monkeypatch: pytest.MonkeyPatch, thickness: float) -> None:
    """Three-armed stars, edges of 1.92 mm: within what another mesh makes of it."""
    star = design(10.0, thickness)
    aligned = solve_cell(star, 1.92, (0.0, np.pi / 6))
    monkeypatch.setattr("asterism.homogenize.cell.unit_cell.aligned_lines", lambda lattice: None)
    free = solve_cell(star, 1.92, (0.0, np.pi / 6))
    assert free.lam == pytest.approx(aligned.lam, rel=2e-3)
    np.testing.assert_allclose(free.natural_curvature, aligned.natural_curvature, rtol=0.04)
    np.testing.assert_allclose(free.bending, aligned.bending, rtol=0.06)


def test_triangles_that_bend_with_their_neighbours_repeat_too() -> None:
    """Consistent bending: two cells have twice the energy, whatever their state."""
    fabric = {"fabric": {"bending": "consistent"}}
    one = five(**fabric)
    two = UnitCell(design(7.0, 0.4, **FIVE, **fabric), EDGE, repeat=(1, 2))
    state = shaken(one, one.printed_state(), 0.2)
    moved = _moved(one, state, two, np.eye(2))
    for name in ("plate", "folds"):
        single, both = (
            sum(part.energies(at.packed).sum() for part_name, part in cell.parts.items() if part_name.startswith(name))
            for cell, at in ((one, state), (two, moved))
        )
        assert single > 0.0 and both == pytest.approx(2.0 * single, rel=1e-11)
