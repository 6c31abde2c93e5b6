"""V1 and V2 for the mapped cell, flat and as a tube; supercells; images that are exact."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.discrete.energies.elements import Elements
from asterism.discrete.model.state import State
from asterism.homogenize.cell.flat_cell import relax_flat_cell, with_orthogonal_directors
from asterism.homogenize.cell.rolling import UnrolledCell, roll_cell, rolled_state, unroll, unrolled_flat_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from tests.discrete.plain import plain_energies
from tests.homogenize.cells import EDGE, design, full, relaxed, shaken
from tests.homogenize.stability import cell_stability

KINDS = pytest.mark.parametrize("tube", [False, True], ids=["flat", "tube"])
RNG = np.random.default_rng(5)


@pytest.fixture
def bumpy(request):
    """A cell, flat or a tube, and a state of it away from equilibrium."""
    cell, flat = relaxed(10.0, 0.4)
    if request.param:
        state = rolled_state(cell, unrolled_flat_cell(flat, 0.3), 0.06, 0.3)
    else:
        cell.set_flat()
        state = flat.state
    return cell, shaken(cell, state, 0.05)


BOTH = pytest.mark.parametrize("bumpy", [False, True], ids=["flat", "tube"], indirect=True)


@BOTH
def test_gradient_by_complex_step(bumpy, monkeypatch):
    monkeypatch.setattr(Elements, "energies", plain_energies)
    cell, state = bumpy
    direction = RNG.normal(size=len(cell.free))
    path = cell.path(state, direction)[0]
    expected = sum(part.energies(path(1e-30j).packed).sum().imag / 1e-30 for part in cell.parts.values())
    assert cell.gradient(state) @ direction == pytest.approx(expected, rel=1e-11)


@BOTH
def test_hessian_by_differences_of_the_energy(bumpy):
    """Along a path that moves rods and fabric; the blended one is semidefinite."""
    cell, state = bumpy
    hessian = full(cell.pattern.lower(cell.hessian(state, 0.0)))
    direction = RNG.normal(size=len(cell.free))
    step = 1e-4
    path = cell.path(state, direction)[0]
    second = (cell.energy(path(step)) + cell.energy(path(-step)) - 2.0 * cell.energy(state)) / step**2
    assert direction @ hessian @ direction == pytest.approx(second, rel=1e-4)
    convex = full(cell.pattern.lower(cell.hessian(state, 1.0)))
    values = np.linalg.eigvalsh(convex)
    assert values[0] > -1e-10 * values[-1]


@KINDS
@pytest.mark.parametrize("bending", ["paper", "consistent"])
def test_hessian_is_the_slope_of_the_gradient(tube, bending):
    """Without rods there is no holonomy: every entry can be compared."""
    cell = UnitCell(design(0.0, fabric={"bending": bending}), EDGE)
    state = cell.printed_state()
    if tube:
        sheet = UnrolledCell(state, 1.0)
        state = rolled_state(cell, sheet, 0.06, 0.0)
    state = shaken(cell, state, 0.1)
    hessian = full(cell.pattern.lower(cell.hessian(state, 0.0)))
    columns = []
    for direction in np.eye(len(cell.free)):
        path = cell.path(state, direction)[0]
        columns.append((cell.gradient(path(1e-6)) - cell.gradient(path(-1e-6))) / 2e-6)
    assert np.abs(hessian - np.array(columns)).max() < 1e-7 * np.abs(hessian).max()


def test_flat_energy_does_not_know_where_it_is():
    cell, flat = relaxed(10.0, 0.4)
    cell.set_flat()
    state = shaken(cell, flat.state, 0.05)
    q, r = np.linalg.qr(RNG.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r)) * np.sign(np.linalg.det(q * np.sign(np.diag(r))))
    x = state.positions @ q.T
    x[: cell.mesh.n_base] += [3.0, -20.0, 7.0]
    assert cell.energy(State(x, state.directors @ q.T)) == pytest.approx(cell.energy(state), rel=1e-12)


def test_tube_energy_does_not_know_its_turn_and_place_on_the_axis():
    cell, flat = relaxed(10.0, 0.4)
    state = shaken(cell, rolled_state(cell, unrolled_flat_cell(flat, 0.3), 0.06, 0.3), 0.05)
    cos, sin = np.cos(1.3), np.sin(1.3)
    q = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])
    x = state.positions @ q.T
    x[: cell.mesh.n_base, 0] += 11.0
    x[cell.mesh.n_base :] = state.positions[cell.mesh.n_base :]
    assert cell.energy(State(x, state.directors @ q.T)) == pytest.approx(cell.energy(state), rel=1e-12)


@KINDS
def test_uniform_sheets_have_their_closed_form(tube):
    """A flat sheet of any uniform strain; a cylinder whose triangles are all alike."""
    bare = design(0.0)
    fabric = bare.fabric
    mu, lam = fabric.modulus_mpa / 2.6, fabric.modulus_mpa * 0.3 / 0.91
    cell = UnitCell(bare, EDGE)
    if not tube:
        deformation = np.array([[0.8, 0.07], [0.02, 0.93], [0.1, -0.2]])
        x = np.vstack([cell.printed[: cell.mesh.n_base], cell.cell_vectors]) @ deformation.T
        state = State(x, np.empty((0, 3)))
        metric = 1.35**2 * deformation.T @ deformation
        log = 0.5 * np.log(np.linalg.det(metric))
        density = 0.5 * mu * (np.trace(metric) - 2.0 - 2.0 * log) + 0.5 * lam * log**2
        expected = fabric.thickness_mm * density * cell.area / 1.35**2
        assert cell.energy(state) == pytest.approx(expected, rel=1e-12)
        return
    # around y: every triangle has corners (0, y0), (a, y1), ... on the same cylinder; two triangles stand for all
    curvature, hoop, axial = 0.05, 0.8, 0.7
    cell.set_tube(curvature)
    radius = hoop / curvature
    n, k = cell.mesh.n_base, round(np.sqrt(cell.mesh.n_base))
    step = cell.cell_vectors / k

    def at(printed):
        turn = curvature * printed[..., 1]
        place = [axial * printed[..., 0], radius * np.sin(turn), radius * np.cos(turn)]
        return np.stack(place, axis=-1)

    positions = np.vstack([at(cell.printed[:n]), np.column_stack([axial * cell.cell_vectors[:, 0], np.zeros((2, 2))])])
    energies = cell.energies(State(positions, np.empty((0, 3))))
    membrane = sum(value for name, value in energies.items() if name.startswith("membrane"))
    hinges = sum(value for name, value in energies.items() if name.startswith("hinges"))
    expected = 0.0
    for corners in (np.array([0 * step[0], step[0], step[1]]), np.array([step[0], step[0] + step[1], step[1]])):
        flat, bent = (corners[1:] - corners[0]).T / 1.35, (at(corners)[1:] - at(corners)[0]).T
        gradient = bent @ np.linalg.inv(flat)
        metric = gradient.T @ gradient
        log = 0.5 * np.log(np.linalg.det(metric))
        density = 0.5 * mu * (np.trace(metric) - 2.0 - 2.0 * log) + 0.5 * lam * log**2
        expected += n * fabric.thickness_mm * density * 0.5 * np.linalg.det(flat)
    assert membrane == pytest.approx(expected, rel=1e-10)
    stiff = fabric.modulus_mpa * fabric.thickness_mm**3 / (24.0 * 0.91) * 3.0 * 2.0 / np.sqrt(3.0)
    expected = 0.0
    for a, b, left, right in (
        (0 * step[0], step[0], step[1], step[0] - step[1]),
        (0 * step[0], step[1], step[1] - step[0], step[0]),
        (step[0], step[1], 0 * step[0], step[0] + step[1]),
    ):
        one = np.cross(at(b) - at(a), at(left) - at(a))
        two = np.cross(at(right) - at(a), at(b) - at(a))
        cosine = one @ two / np.linalg.norm(one) / np.linalg.norm(two)
        expected += n * stiff * 4.0 * (1.0 - cosine) / (1.0 + cosine)  # (2 tan(theta/2))^2
    assert hinges == pytest.approx(expected, rel=1e-8)


def test_supercell_has_four_times_the_energy_and_no_forces():
    one, flat = relaxed(10.0, 0.4)
    one.set_flat()
    four = UnitCell(design(10.0, 0.4), EDGE, repeat=(2, 2))
    base = one.mesh.n_base
    cell = np.repeat([[0, 0], [0, 1], [1, 0], [1, 1]], base, axis=0)
    images = flat.state.positions[base:]
    positions = np.vstack([np.tile(flat.state.positions[:base], (4, 1)) + cell @ images, 2.0 * images])
    state = State(positions, np.tile(flat.state.directors, (4, 1)))
    assert four.energy(state) == pytest.approx(4.0 * one.energy(flat.state), rel=1e-12)
    assert np.linalg.norm(four.gradient(state)) < 1e-5
    # the four sectors of one cell are the supercell's whole spectrum
    low = full(four.pattern.lower(four.hessian(state, 0.0)))
    modes = four.rigid_modes(state)
    keep = np.linalg.svd(modes, full_matrices=True)[0][:, modes.shape[1] :]
    smallest = np.linalg.eigvalsh(keep.T @ low @ keep)[0]
    found = cell_stability(one, flat.state)
    assert (found.supercell > 0.0) == (smallest > 0.0)
    assert found.supercell <= found.cell


def test_moment_is_the_slope_of_the_energy():
    cell, flat = relaxed(10.0, 0.4)
    step = 1e-4
    ahead, here, behind = (
        roll_cell(cell, unrolled_flat_cell(flat, 0.2), 0.03 + side * step, 0.2) for side in (1, 0, -1)
    )
    assert here.moment == pytest.approx((ahead.energy - behind.energy) / (2.0 * step), rel=1e-4)


def test_rolling_and_unrolling_give_the_state_back():
    cell, flat = relaxed(10.0, 0.4)
    tube = roll_cell(cell, unrolled_flat_cell(flat, 0.4), 0.08, 0.4)
    again = rolled_state(cell, unroll(cell, tube), 0.08, 0.4)
    np.testing.assert_allclose(again.positions, tube.state.positions, atol=1e-9)
    np.testing.assert_allclose(again.directors, tube.state.directors, atol=1e-9)


def test_the_same_start_gives_the_same_digits():
    found = [relax_flat_cell(UnitCell(design(7.0, 0.3), EDGE)) for _ in range(2)]
    np.testing.assert_array_equal(found[0].state.positions, found[1].state.positions)


def test_cells_that_cannot_be_are_refused():
    with pytest.raises(ValueError, match=r"arms of the stars at .* overlap"):
        UnitCell(design(12.0, lattice={"arms": 4}), EDGE)
    with pytest.raises(ValueError, match="length_mm must be a number"):
        UnitCell(design(stars={"length_mm": {"formula": "4 + 0.1*r"}}), EDGE)
    with pytest.raises(ValueError, match="weight"):
        UnitCell(design(gravity={"on": True}, fabric={"modulus_mpa": 7.0}), EDGE)
    for change in ({"remove": True}, {"length_mm": 2.0}, {"thickness_mm": 0.3}, {"width_mm": 1.0}):
        override = [{"star": 3, "branch": "down"}, {"star": 1, **change}]
        with pytest.raises(ValueError, match=r"^stars.override\[1\] must not change a star"):
            UnitCell(design(stars={"length_mm": 10.0, "override": override}), EDGE)


def test_cells_of_uneven_stretch_are_released_from_the_beginning():
    """Paper's hinges follow the shape of the fabric at rest, before any release is set."""
    cell = UnitCell(design(7.0, 0.4, fabric={"stretch": [1.1, 1.6]}), EDGE)
    state = shaken(cell, cell.printed_state(), 0.1)
    before = cell.energy(state)
    cell.set_release(1.0)
    assert cell.energy(state) == before


def test_stars_have_the_sizes_that_are_printed():
    """Of layers and lines; the side that a star starts to is found, not asked for."""
    stars = {"length_mm": 10.0, "thickness_mm": 0.37, "override": [{"star": 0, "branch": "down"}]}
    layers = {"first_layer_mm": 0.3, "layer_mm": 0.2, "line_mm": 0.5}
    layout = UnitCell(design(stars={**stars, "rounding": layers}), EDGE).model.layout
    np.testing.assert_allclose(layout.arm_thickness, 0.3)
    np.testing.assert_allclose(layout.arm_width, 1.0)


def test_triangles_that_bend_with_their_neighbours_repeat_too():
    """Consistent bending of a distorted mesh: the supercell's energy is four times the cell's, whatever its state."""
    fabric = {"fabric": {"bending": "consistent"}}
    one, four = (UnitCell(design(9.0, 0.4, **fabric), EDGE, repeat=(n, n)) for n in (1, 2))
    assert len(one.parts["plate of images"]) and len(one.model.parts["plate"]) == len(one.mesh.triangles)
    count = one.mesh.n_base
    state = shaken(one, one.printed_state(), 0.2)
    base, images = state.positions[:count], state.positions[count:]
    lattice = np.repeat([[0, 0], [0, 1], [1, 0], [1, 1]], count, axis=0)
    positions = np.vstack([np.tile(base, (4, 1)) + lattice @ images, 2.0 * images])
    whole = State(positions, np.tile(state.directors, (4, 1)))
    for name in ("plate", "folds"):
        single, all_four = (
            sum(part.energies(at.packed).sum() for part_name, part in cell.parts.items() if part_name.startswith(name))
            for cell, at in ((one, state), (four, whole))
        )
        assert single > 0.0 and all_four == pytest.approx(4.0 * single, rel=1e-12)


def test_directors_stay_orthogonal():
    cell, flat = relaxed(10.0, 0.4)
    cell.set_flat()
    state = with_orthogonal_directors(cell, shaken(cell, flat.state))
    x = cell.images.unfold(state.positions)
    along = x[cell.edges[:, 1]] - x[cell.edges[:, 0]]
    assert np.abs((along * state.directors).sum(axis=1)).max() < 1e-12
