"""What natural tubes say beyond their curvature: membrane stiffness, relief; and the mean of two meshes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.linear_response import flat_membrane_stiffness, tube_membrane_stiffness
from asterism.homogenize.cell.rolling import heights_over_mean_surface, roll_cell, unrolled_flat_cell
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.homogenize.law.anisotropy import isotropic_constants
from asterism.pattern.design.lattice import Lattice
from tests.homogenize.cells import EDGE, MOTIFS, design, relaxed
from tests.homogenize.law.test_anisotropy import turned
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.motifs import motif_design

CELLS = {
    "bare": lambda: UnitCell(design(0.0, 0.6), EDGE),
    "stars": lambda: UnitCell(design(10.0, 0.6), EDGE),
    **{name: lambda name=name: UnitCell(motif_design(MOTIFS[name]), 2.5) for name in ("grid", "diamonds", "waves")},
}


@pytest.mark.parametrize(
    "name", ["bare", "stars", *(pytest.param(n, marks=pytest.mark.slow) for n in ("grid", "diamonds", "waves"))]
)
def test_membrane_of_hardly_curved_tubes_is_that_of_the_flat_cell(name: str) -> None:
    cell = CELLS[name]()
    flat = relax_flat_cell(cell)
    expected = effective_stiffness(cell, flat)
    np.testing.assert_allclose(
        flat_membrane_stiffness(cell, flat), expected.stiffness[:3, :3], rtol=1e-7, atol=1e-7 * expected.stiffness.max()
    )
    moment = abs(expected.moment).max() / flat.stretch**2  # a fixed moment's share
    found = tube_membrane_stiffness(cell, roll_cell(cell, unrolled_flat_cell(flat, 0.3), 1e-5, 0.3))
    np.testing.assert_allclose(found, expected.stiffness[:3, :3], atol=1e-4 * found.max() + 1e-3 * moment)


def test_membrane_of_a_tube_says_what_a_dead_pull_does() -> None:
    """Equilibria of the tube pulled along its axis, all else free: the strains of `E = (F^T F - I)/2` follow the
    compliance, where F takes the print to the tube laid flat, which is sheared."""
    cell, flat = relaxed(10.0, 0.4)
    tube = roll_cell(cell, unrolled_flat_cell(flat, 0.2), 0.04, 0.2)
    turn = turned(cell.angle)  # in the tube's axes of those in the print's
    compliance = turn @ np.linalg.inv(tube_membrane_stiffness(cell, tube)) @ turn.T
    n, pull = cell.mesh.n_base, 1e-3
    slopes = cell.turn @ np.linalg.inv(cell.cell_vectors)
    ends = []
    for sign in (1.0, -1.0):
        force = np.zeros(3 * (n + 2) + len(cell.edges))
        force[3 * n : 3 * (n + 2) : 3] = sign * pull * cell.area * tube.axial * slopes[0]
        state = tube.state
        for _ in range(4):
            hessian = cell.pattern.full(cell.hessian(state, 0.0)).toarray()
            step = np.linalg.solve(hessian, force[cell.free] - cell.gradient(state))
            state = cell.path(state, step)[0](1.0)
        assert np.abs(cell.gradient(state) - force[cell.free]).max() < 1e-8
        radius = cell.weights @ np.hypot(*state.positions[:n, 1:].T)
        axial, shear = slopes @ state.positions[n:, 0]
        places = np.array([[axial, shear], [0.0, radius * tube.curvature]])
        ends.append(_strain(places.T @ places / 2.0))
    assert abs(shear) > 1e-3
    np.testing.assert_allclose((np.array(ends[0]) - ends[1]) / (2.0 * pull), compliance[:, 0], rtol=1e-4)


def _strain(form: np.ndarray) -> list[float]:
    return [form[0, 0], form[1, 1], 2.0 * form[0, 1]]


@given(st.lists(st.floats(-2.0, 2.0), min_size=12, max_size=12), st.integers(0, 5))
@settings(max_examples=20)
def test_reliefs_are_found_again_and_have_the_symmetry_of_the_star(amplitudes: list[float], turns: int) -> None:
    waves = CorrugationWaves.of(Lattice())
    cell = relaxed(10.0, 0.4, 1.44)[0]
    offsets = cell.printed[: cell.mesh.n_base] - cell.printed[cell.mesh.star_vertices[0]]
    field = waves(offsets) @ amplitudes
    found = waves.amplitudes(offsets, field, cell.weights)
    np.testing.assert_allclose(waves(offsets) @ found, field - cell.weights @ field, atol=0.05)
    angle = 2.0 * np.pi * turns / 3.0
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    np.testing.assert_allclose(waves(offsets @ rotation.T), waves(offsets), atol=1e-12)
    np.testing.assert_allclose(waves(offsets + np.asarray(Lattice().vectors)[0]), waves(offsets), atol=1e-9)


@pytest.mark.parametrize(
    ("arms", "kind"), [(3, "triangular"), (6, "triangular"), (4, "square"), (5, "triangular"), (3, "square")]
)
def test_waves_are_orthogonal_over_a_cell(arms: int, kind: str) -> None:
    """On a fine grid of the lattice: no mean, none counted twice, none missing up to the longest."""
    lattice = Lattice.model_validate({"arms": arms, "kind": kind})
    waves = CorrugationWaves.of(lattice)
    grid = np.stack(np.meshgrid(np.arange(24), np.arange(24)), axis=-1).reshape(-1, 2) / 24.0
    values = waves(grid @ np.asarray(lattice.vectors))
    assert np.abs(values.mean(axis=0)).max() < 1e-12
    gram = values.T @ values / len(values)
    assert np.abs(gram - np.diag(np.diag(gram))).max() < 1e-12 and np.diag(gram).min() > 0.01
    assert len(waves) == (12 if arms == 3 and kind == "triangular" else {4: 7, 6: 6, 5: 36, 3: 28}[arms])


@pytest.mark.slow
def test_the_relief_of_a_sample_is_near_its_flat_cell_and_its_tubes() -> None:
    found = solve_cell(design(10.0, 0.4), 1.44)
    waves = CorrugationWaves.of(Lattice())
    cell, flat = relaxed(10.0, 0.4, 1.44)
    curvature = float((found.natural_curvature * found.natural_hoop).mean())
    tube = roll_cell(cell, unrolled_flat_cell(flat, 0.0), curvature, 0.0)
    offsets = cell.printed[: cell.mesh.n_base] - cell.printed[cell.mesh.star_vertices[0]]
    lying, more = found.relief
    rolled = lying + found.natural_curvature.mean() * more
    z = flat.state.positions[: cell.mesh.n_base, 2]
    centre = (waves(np.zeros((1, 2))) @ np.array([lying, rolled]).T)[0]
    for real, amplitudes in ((z - cell.weights @ z, lying), (heights_over_mean_surface(cell, tube), rolled)):
        left = real - waves(offsets) @ amplitudes
        assert np.sqrt(cell.weights @ left**2) < 0.6 * np.sqrt(cell.weights @ real**2)
    assert centre[0] == pytest.approx(found.centre_offset_mm, rel=0.05)
    assert centre[1] == pytest.approx(found.natural_centre_offset_mm.mean(), rel=0.05)


def test_the_nearest_isotropic_tensor() -> None:
    plane = np.array([[3.0, 1.0, 0.0], [1.0, 3.0, 0.0], [0.0, 0.0, 1.0]])
    assert isotropic_constants(plane) == pytest.approx((3.0, 1.0))
    stiffer = plane + np.diag([1.0, 0.0, 0.0])
    assert isotropic_constants(stiffer) == pytest.approx((3.375, 1.125))
    # they do not depend on the axes; strains turn as forms do
    turn = turned(0.4)
    assert isotropic_constants(turn.T @ stiffer @ turn) == pytest.approx(isotropic_constants(stiffer))


def test_amplitudes_are_of_heights_over_their_mean_and_weights_count_as_often_as_they_say() -> None:
    waves, rng = CorrugationWaves.of(Lattice()), np.random.default_rng(3)
    offsets, heights, times = rng.uniform(-9.0, 9.0, (90, 2)), rng.normal(size=90), rng.integers(1, 5, 90)
    found = waves.amplitudes(offsets, heights, times.astype(float))
    assert np.allclose(waves.amplitudes(offsets, heights + 7.0, times.astype(float)), found)
    several = waves.amplitudes(np.repeat(offsets, times, axis=0), np.repeat(heights, times), np.ones(times.sum()))
    assert np.allclose(several, found)
