"""VALIDATION V1 and V2 for mapped cells, flat and as tubes, of stars and of motifs: derivatives, rigid motions,
other pieces of the lattice, and supercells. Cells on free meshes; both meshes of a star against each other."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.linalg import block_diag
from scipy.spatial import cKDTree

from asterism.discrete.energies.elements import Elements
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.flat_cell import FlatCell, relax_flat_cell, with_orthogonal_directors
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.rolling import roll_cell, rolled_state, unroll, unrolled_flat_cell
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from tests.discrete.plain import plain_energies
from tests.homogenize.cells import EDGE, TURN, cell_of, design, relaxed, relaxed_cell, shaken, state_away
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.motifs import grid, motif_design
from tests.homogenize.stability import cell_stability, reduction_matrix, unfolded_hessian

TUBES = pytest.mark.parametrize("tube", [False, True], ids=["flat", "tube"])
NAMES = pytest.mark.parametrize(
    "name",
    ["three", "five", "grid", "diamonds", *(pytest.param(n, marks=pytest.mark.slow) for n in ("honeycomb", "waves"))],
)
THIRD = np.array([[-0.5, -np.sqrt(0.75)], [np.sqrt(0.75), -0.5]])
MIRROR = np.diag([-1.0, 1.0])


@NAMES
@TUBES
def test_derivatives(name: str, tube: bool) -> None:
    """Complex step for the gradient, second differences along a path for the Hessian, which blended is semidefinite."""
    cell, state = state_away(name, tube)
    assert len(state.frames) == len(cell.joint_vertices)
    direction = np.random.default_rng(5).normal(size=len(cell.free))
    path = cell.path(state, direction)[0]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Elements, "energies", plain_energies)
        slope = sum(part.energies(path(1e-30j).packed).sum().imag / 1e-30 for part in cell.parts.values())
    assert cell.gradient(state) @ direction == pytest.approx(slope, rel=1e-10)
    step = 1e-4
    second = (cell.energy(path(step)) + cell.energy(path(-step)) - 2.0 * cell.energy(state)) / step**2
    hessian = cell.pattern.full(cell.hessian(state, 0.0)).toarray()
    assert direction @ hessian @ direction == pytest.approx(second, rel=1e-4)
    convex = np.linalg.eigvalsh(cell.pattern.full(cell.hessian(state, 1.0)).toarray())
    assert convex[0] > -1e-10 * convex[-1]


@NAMES
def test_rigid_motions_have_no_energy(name: str) -> None:
    rng = np.random.default_rng(1)
    cell, state = state_away(name, tube=False)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    turned = state.rotated(rotation, np.zeros(3))
    turned.positions[: cell.mesh.n_base] += [3.0, -20.0, 7.0]
    assert cell.energy(turned) == pytest.approx(cell.energy(state), rel=1e-12)
    flat = relaxed_cell(name)[1]
    stiffness = cell.pattern.product(cell.hessian(flat.state, 0.0), cell.rigid_modes(flat.state))
    assert np.abs(stiffness).max() < 1e-6 * np.abs(cell.hessian(flat.state, 0.0)).max()

    cell, state = state_away(name, tube=True)
    cos, sin = np.cos(1.3), np.sin(1.3)
    rotation = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])
    turned = state.rotated(rotation, np.zeros(3))
    turned.positions[: cell.mesh.n_base, 0] += 11.0
    turned.positions[cell.mesh.n_base :] = state.positions[cell.mesh.n_base :]
    assert cell.energy(turned) == pytest.approx(cell.energy(state), rel=1e-12)


def _on_lattice(known: Array, asked: Array, vectors: Array) -> tuple[Array, Array]:
    """Which of the known printed points lies under each asked one (n, 2), and how many lattice vectors (n, 2) away."""
    inverse = np.linalg.inv(vectors)
    parts = [points @ inverse % 1.0 for points in (known, asked)]
    tree = cKDTree(np.where(parts[0] >= 1.0, 0.0, parts[0]), boxsize=1.0)
    distance, index = tree.query(np.where(parts[1] >= 1.0, 0.0, parts[1]))
    assert distance.max() < 1e-6
    return index, np.round((asked - known[index]) @ inverse)


def _turns(cell: UnitCell, count: Array) -> Array:
    """(n, 3, 3) of the images that many lattice vectors away."""
    if cell.curvature is None:
        return np.broadcast_to(np.eye(3), (len(count), 3, 3))
    phi = cell.curvature * (count @ cell.cell_vectors @ cell.turn[1])
    turn = np.zeros((len(count), 3, 3))
    turn[:, 0, 0] = 1.0
    turn[:, 1, 1] = turn[:, 2, 2] = np.cos(phi)
    turn[:, 1, 2], turn[:, 2, 1] = np.sin(phi), -np.sin(phi)
    return turn


def _moved(one: UnitCell, state: State, other: UnitCell, symmetry: Array) -> State:
    """The sheet of a state of `one`, its print moved by a symmetry (2, 2), as a state of the cell `other`."""
    n, vectors = one.mesh.n_base, one.cell_vectors
    macro = state.positions[n:]
    index, count = _on_lattice(one.printed[:n], other.printed[: other.mesh.n_base] @ symmetry, vectors)
    base = np.einsum("nij,nj->ni", _turns(one, count), state.positions[index]) + count @ macro
    images = np.round(other.cell_vectors @ symmetry @ np.linalg.inv(vectors)) @ macro
    middles = [cell.printed[cell.edges].mean(axis=1) for cell in (one, other)]
    index, count = _on_lattice(middles[0], middles[1] @ symmetry, vectors)
    directors = np.einsum("nij,nj->ni", _turns(one, count), state.directors[index])
    space = np.diag([np.linalg.det(symmetry), 1.0, 1.0])  # the plastic's normal mirrors like a position
    return State(np.vstack([base, images]) @ space, directors @ space)


@pytest.mark.parametrize("symmetry", [np.eye(2), THIRD, MIRROR, THIRD @ MIRROR], ids=["same", "turn", "mirror", "both"])
def test_a_moved_print_has_the_same_energy_and_forces(symmetry: Array) -> None:
    """Of any state: every point, triangle, hinge and rod edge takes another one's place."""
    cell, flat = relaxed(10.0, 0.4)
    cell.set_flat()
    state = shaken(cell, flat.state, 0.05)
    moved = _moved(cell, state, cell, symmetry)
    for name, energy in cell.energies(state).items():
        if " of images" not in name:  # which elements reach across the border changes
            both = [sum(v for key, v in cell.energies(s).items() if key.startswith(name)) for s in (state, moved)]
            assert both[1] == pytest.approx(both[0], rel=1e-10), name
            assert energy > 0.0
    forces = [cell.full_gradient(s)[: 3 * cell.mesh.n_base].reshape(-1, 3) for s in (state, moved)]
    sizes = [np.sort(np.linalg.norm(force, axis=1)) for force in forces]
    np.testing.assert_allclose(sizes[1], sizes[0], rtol=1e-8, atol=1e-10 * sizes[0].max())


@pytest.mark.parametrize(("name", "repeat"), [("three", (2, 2)), ("three", (1, 3)), ("five", (2, 1))])
def test_a_tube_of_several_cells_is_the_same_tube(name: str, repeat: tuple[int, int]) -> None:
    cell, flat = relaxed_cell(name)
    tube = roll_cell(cell, unrolled_flat_cell(flat, 0.3), 0.05, 0.3)
    several = cell_of(name, repeat)
    several.set_tube(0.05, 0.3)
    state = _moved(cell, tube.state, several, np.eye(2))
    count = repeat[0] * repeat[1]
    assert several.energy(state) == pytest.approx(count * tube.energy * cell.area, rel=1e-11)
    assert several.moment(state) == pytest.approx(tube.moment, rel=1e-6)
    assert np.linalg.norm(several.gradient(state)) < 2 * count * tube.gradient_norm + 1e-9


@pytest.mark.parametrize("name", ["three", "diamonds"])
def test_supercells_have_four_times_the_energy_and_no_forces(name: str) -> None:
    one, flat = relaxed_cell(name)
    one.set_flat()
    four = cell_of(name, (2, 2))
    cells, n = np.array([[0, 0], [0, 1], [1, 0], [1, 1]]), one.mesh.n_base
    images = flat.state.positions[n:]
    positions = np.vstack([*(flat.state.positions[:n] + cell @ images for cell in cells), 2.0 * images])
    state = State(positions, np.tile(flat.state.directors, (4, 1)), np.tile(flat.state.frames, (4, 1, 1)))
    assert four.energy(state) == pytest.approx(4.0 * one.energy(flat.state), rel=1e-12)
    assert np.linalg.norm(four.gradient(state)) < 1e-5
    # the waves of one cell are those of the supercell
    inner = reduction_matrix(four.images, np.ones(len(four.mesh.base)), len(four.edges))
    values = np.linalg.eigvalsh((inner.T @ unfolded_hessian(four, state) @ inner).toarray())
    stability = cell_stability(one, flat.state)
    assert stability.supercell <= stability.cell
    assert np.abs(values / stability.supercell - 1.0).min() < 1e-6


@pytest.mark.parametrize(("name", "repeat"), [("three", (2, 2)), ("five", (1, 2))])
def test_triangles_that_bend_with_their_neighbours_repeat_too(name: str, repeat: tuple[int, int]) -> None:
    """Consistent bending: several cells have as many times the energy of one, whatever their state."""
    fabric = {"fabric": {"bending": "consistent"}}
    one, several = cell_of(name, **fabric), cell_of(name, repeat, **fabric)
    assert len(one.parts["plate of images"]) and len(one.model.parts["plate"]) == len(one.mesh.triangles)
    state = shaken(one, one.printed_state(), 0.2)
    moved = _moved(one, state, several, np.eye(2))
    for part in ("plate", "folds"):
        energies = [
            sum(each.energies(at.packed).sum() for key, each in cell.parts.items() if key.startswith(part))
            for cell, at in ((one, state), (several, moved))
        ]
        assert energies[0] > 0.0 and energies[1] == pytest.approx(np.prod(repeat) * energies[0], rel=1e-11)


@pytest.mark.parametrize("name", ["three", "grid", "diamonds"])
def test_moment_is_the_slope_of_the_energy(name: str) -> None:
    """Images of joints turn with the tube; unrolled and rolled again it is the same."""
    cell, flat = relaxed_cell(name)
    step = 1e-4
    ahead, here, behind = (
        roll_cell(cell, unrolled_flat_cell(flat, TURN), 0.02 + side * step, TURN) for side in (1, 0, -1)
    )
    assert here.moment == pytest.approx((ahead.energy - behind.energy) / (2.0 * step), rel=1e-4)
    again = rolled_state(cell, unroll(cell, here), 0.02, TURN)
    np.testing.assert_allclose(again.positions, here.state.positions, atol=1e-9)
    np.testing.assert_allclose(again.directors, here.state.directors, atol=1e-9)
    np.testing.assert_allclose(again.frames, here.state.frames, atol=1e-6)


LINES = grid()[0]
WEIGHT = {"gravity": {"on": True}, "fabric": {"modulus_mpa": 7.0}}


@pytest.mark.parametrize(
    ("star", "message"),
    [
        (lambda: design(12.0, lattice={"arms": 4}), r"arms of the stars at .* overlap"),
        (lambda: design(stars={"length_mm": {"formula": "4 + 0.1*r"}}), "length_mm must be a number"),
        (lambda: design(**WEIGHT), "weight"),
        *((lambda change=change: overridden(change), r"^stars.override\[1\] must not change a star")
          for change in ({"remove": True}, {"length_mm": 2.0}, {"thickness_mm": 0.3}, {"width_mm": 1.0})),
        (lambda: motif_design(grid(), rods={"draw": LINES}), r"^rods\.motif: is missing"),
        (lambda: motif_design(grid(), rods={"motif": LINES, "draw": LINES}), r"^rods: must have a motif alone"),
        (lambda: motif_design(grid(), stars={"length_mm": 3.0}), r"^rods: must stand alone in a unit cell"),
        (lambda: motif_design(grid(), {"formula": "0.3 + 0.001*r"}), r"^rods\.thickness_mm: must be a number"),
        (lambda: motif_design(grid(), **WEIGHT), "weight"),
    ],
)  # fmt: skip
def test_cells_that_cannot_be_are_refused(star: Callable[[], Design], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        UnitCell(star(), EDGE)


def overridden(change: dict[str, Any]) -> Design:
    """The first of both changes is none of a size."""
    override = [{"star": 3, "branch": "down"}, {"star": 1, **change}]
    return design(stars={"length_mm": 10.0, "override": override})


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


def test_directors_stay_orthogonal():
    cell, flat = relaxed(10.0, 0.4)
    cell.set_flat()
    state = with_orthogonal_directors(cell, shaken(cell, flat.state))
    x = cell.images.unfold(state.positions)
    along = x[cell.edges[:, 1]] - x[cell.edges[:, 0]]
    assert np.abs((along * state.directors).sum(axis=1)).max() < 1e-12


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
    found = cell.pattern.full(cell.hessian(state, 0.0)).toarray()
    np.testing.assert_allclose(found, whole, atol=1e-11 * np.abs(whole).max())


@pytest.mark.slow
@pytest.mark.parametrize("lattice", [{"arms": 5}, {"arms": 8, "kind": "square"}, {"orientation_deg": 20}])
def test_without_arms_it_is_the_fabric(lattice: dict[str, Any]) -> None:
    """Also next to the points where arms would be: those of short ones stay in the mesh."""
    bare = solve_cell(design(0.0, lattice=lattice), EDGE, (0.0, 0.5))
    np.testing.assert_allclose(bare.rest_metric, 1.35**-2 * np.eye(2), atol=1e-9)
    assert bare.lam == pytest.approx(1.0 / 1.35, abs=1e-8)
    np.testing.assert_array_equal(bare.natural_curvature, 0.0)
    short = relax_flat_cell(UnitCell(design(1.0, 0.2, lattice=lattice), EDGE)).stretch
    assert 0.0 < short - bare.lam < 0.01


@pytest.mark.slow
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


COARSE_EDGE = 5.0


def flat(size: float, stiff: float) -> FlatCell:
    """Of a cell with `size` times the paper's lengths and `stiff` times its moduli."""
    data = {
        "fabric": {"thickness_mm": 0.8 * size, "modulus_mpa": 7.1875 * stiff},
        "lattice": {"spacing_mm": size * float(DEFAULT_SPACING_MM)},
        "stars": {"length_mm": 8.5 * size, "thickness_mm": 0.3 * size, "width_mm": 1.2 * size},
        "border": {"rings": 0, "tip_margin_mm": 0.5 * size},
    }
    return relax_flat_cell(UnitCell(Design.from_dict(data), COARSE_EDGE * size))


@pytest.mark.slow
@pytest.mark.parametrize("size, stiff", [(8.0, 1.0), (1.0, 1e4), (0.3, 1e-3)])
def test_a_cell_of_every_size_and_stiffness_is_the_paper_s(size: float, stiff: float) -> None:
    one, other = flat(1.0, 1.0), flat(size, stiff)
    assert one.bump[0] > 0.0
    assert other.bump == pytest.approx(size * one.bump, rel=1e-6)
    assert other.energy == pytest.approx(stiff * size * one.energy, rel=1e-8)
    np.testing.assert_allclose(other.deformation, one.deformation, atol=1e-8)
    assert abs(other.iterations - one.iterations) <= 2
