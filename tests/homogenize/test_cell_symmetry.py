"""VALIDATION V2 for the mapped cell: the same sheet on another piece of the lattice, turned, or in a mirror."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.rolling import roll_cell, unrolled_flat_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from tests.homogenize.cells import EDGE, design, relaxed, shaken

THIRD = np.array([[-0.5, -np.sqrt(0.75)], [np.sqrt(0.75), -0.5]])
MIRROR = np.diag([-1.0, 1.0])


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


@pytest.mark.parametrize("repeat", [(2, 2), (1, 3)])
def test_a_tube_of_several_cells_is_the_same_tube(repeat: tuple[int, int]) -> None:
    cell, flat = relaxed(10.0, 0.4)
    tube = roll_cell(cell, unrolled_flat_cell(flat, 0.3), 0.05, 0.3)
    several = UnitCell(design(10.0, 0.4), EDGE, repeat=repeat)
    several.set_tube(0.05, 0.3)
    state = _moved(cell, tube.state, several, np.eye(2))
    count = repeat[0] * repeat[1]
    assert several.energy(state) == pytest.approx(count * tube.energy * cell.area, rel=1e-11)
    assert several.moment(state) == pytest.approx(tube.moment, rel=1e-6)
    assert np.linalg.norm(several.gradient(state)) < 2 * count * tube.gradient_norm + 1e-9
