"""Cells of motifs: derivatives, rigid motions, cells cut elsewhere, supercells, and stars written as rods."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.discrete.model.state import State
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.free_cell_mesh import motif_cell_mesh
from asterism.homogenize.cell.motif_responses import (
    GAUSSIAN,
    CellComparison,
    compare_with_larger_cell,
    completed_by_rods,
    rod_bending,
)
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.periodic_mesh import ImageNumbering, PeriodicMesh
from asterism.homogenize.cell.rolling import roll_cell, unrolled_flat_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import MeshError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.rods.motif_graph import motif_graph
from tests.homogenize.cell.test_motif_closed_forms import stiff
from tests.homogenize.cells import TURN, cell_of, relaxed_cell, state_away
from tests.homogenize.cells import design as star_design
from tests.homogenize.linear_cell import effective_stiffness
from tests.homogenize.motifs import Pattern, diamonds, grid, honeycomb, motif_design, moved, parallel, stars, waves

EDGE = 3.0


def recut(mesh: PeriodicMesh, points: np.ndarray, rods: np.ndarray) -> PeriodicMesh:
    """The same torus, cut elsewhere: each base point (V, 2) and each rod (R, 2) is some lattice vectors away."""
    number = ImageNumbering(mesh.n_base)

    def renamed(vertices: np.ndarray, shift: np.ndarray) -> np.ndarray:
        image = mesh.image[vertices] - points[mesh.base[vertices]] + shift
        return number(mesh.base[vertices].ravel(), *image.reshape(-1, 2).T).reshape(vertices.shape)

    here = np.zeros(2, dtype=np.int64)
    changes = {
        "triangles": renamed(mesh.triangles, here),
        "hinges": renamed(mesh.hinges, here),
        "rods": tuple(renamed(rod, shift) for rod, shift in zip(mesh.rods, rods, strict=True)),
    }
    base, image = number.unfolded()
    places = mesh.points[: mesh.n_base] + points @ mesh.cell_vectors
    return replace(mesh, points=places[base] + image @ mesh.cell_vectors, base=base, image=image, **changes)


@pytest.mark.slow
@settings(max_examples=3, deadline=None, derandomize=True)
@given(seed=st.integers(0, 1000), tube=st.booleans(), name=st.sampled_from(["grid", "diamonds", "honeycomb"]))
def test_the_energy_does_not_depend_on_where_the_cell_is_cut(seed: int, tube: bool, name: str) -> None:
    """Every point and every rod of the cell stands for itself or for an image some cells away."""
    rng = np.random.default_rng(seed)
    cell, state = state_away(name, tube)
    mesh, n = cell.mesh, cell.mesh.n_base
    points, rods = rng.integers(-2, 3, size=(n, 2)), rng.integers(-2, 3, size=(len(mesh.rods), 2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("asterism.homogenize.cell.free_cell_mesh.motif_cell_mesh", lambda *_: recut(mesh, points, rods))
        other = cell_of(name)
    if tube:
        other.set_tube(cell.curvature, cell.angle)

    def turns(image: np.ndarray) -> np.ndarray:
        angle = (cell.curvature or 0.0) * (image @ cell.cell_vectors @ cell.turn[1])
        cos, sin, zero, one = np.cos(angle), np.sin(angle), np.zeros(len(angle)), np.ones(len(angle))
        return np.array([[one, zero, zero], [zero, cos, sin], [zero, -sin, cos]]).transpose(2, 0, 1)

    axes = np.diag([1.0, 0.0, 0.0]) if tube else np.eye(3)
    x = np.einsum("uij,uj->ui", turns(points), state.positions[:n]) + points @ state.positions[n:] @ axes
    of_edge = rods[cell.model.network.rod]
    directors = np.einsum("rij,rj->ri", turns(of_edge), state.directors)
    frames = state.frames @ turns(points[cell.joint_vertices]).transpose(0, 2, 1)
    same = State(np.vstack([x, state.positions[n:]]), directors, frames)
    assert other.energy(same) == pytest.approx(cell.energy(state), rel=1e-11)
    macro = slice(3 * n, 3 * n + 6)
    np.testing.assert_array_equal(other.joint_vertices, cell.joint_vertices)
    if not tube:  # the images of all points pull at the cell vectors, wherever the base points are
        ours, theirs = cell.full_gradient(state)[macro], other.full_gradient(same)[macro]
        shift = points.T @ cell.full_gradient(state)[: 3 * n].reshape(-1, 3)
        np.testing.assert_allclose(theirs, ours - shift.ravel(), atol=1e-8 * np.abs(ours).max())


@pytest.mark.slow
@settings(max_examples=4, deadline=None, derandomize=True)
@given(x=st.floats(-30.0, 30.0), y=st.floats(-30.0, 30.0))
def test_results_do_not_depend_on_where_the_motif_is_in_its_lattice(x: float, y: float) -> None:
    expected = relaxed_cell("diamonds")[1]
    flat = relax_flat_cell(UnitCell(motif_design(moved(diamonds(), (x, y))), EDGE))
    assert flat.energy == pytest.approx(expected.energy, rel=1e-7)
    np.testing.assert_allclose(flat.deformation, expected.deformation, atol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_results_do_not_depend_on_the_order_and_sense_of_the_lines(order: tuple[int, int]) -> None:
    """The mesh does: it begins at the first node."""
    motif, lattice = grid()
    changed = [{"line_mm": motif[k]["line_mm"][::-1]} for k in order]
    flat = relax_flat_cell(UnitCell(motif_design((changed, lattice)), 2.5))
    expected = relax_flat_cell(UnitCell(motif_design(grid()), 2.5))
    assert flat.energy == pytest.approx(expected.energy, rel=1e-3)
    np.testing.assert_allclose(flat.deformation, expected.deformation, atol=1e-3)


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


@pytest.mark.parametrize(
    "pattern",
    [
        parallel(),
        grid(),
        diamonds(),
        *(pytest.param(each, marks=pytest.mark.slow) for each in (waves(), honeycomb(), stars())),
    ],
)
def test_meshes_follow_the_rods(pattern: Pattern) -> None:
    design = motif_design(pattern)
    assert design.rods is not None
    motif = motif_graph(design.rods, design.lattice)
    mesh = motif_cell_mesh(motif, 2.0)
    length = sum(np.linalg.norm(np.diff(mesh.points[rod], axis=0), axis=1).sum() for rod in mesh.rods)
    assert length == pytest.approx(sum(rod.length for rod in motif.rods), rel=0.01)
    assert mesh.area == pytest.approx(abs(np.linalg.det(motif.vectors)))
    np.testing.assert_allclose(mesh.points[0], 0.0, atol=1e-12)


def test_cells_that_cannot_be_are_refused() -> None:
    pattern = grid()
    with pytest.raises(ValueError, match=r"^rods\.motif: is missing"):
        UnitCell(Design.from_dict({"rods": {"draw": pattern[0]}, "border": {"rectangle_mm": (60, 60)}}), EDGE)
    with pytest.raises(ValueError, match=r"^rods: must have a motif alone"):
        UnitCell(motif_design(pattern, rods={"motif": pattern[0], "draw": pattern[0]}), EDGE)
    with pytest.raises(ValueError, match=r"^rods: must stand alone in a unit cell"):
        UnitCell(motif_design(pattern, stars={"length_mm": 3.0}), EDGE)
    with pytest.raises(ValueError, match=r"^rods\.thickness_mm: must be a number"):
        UnitCell(motif_design(pattern, rods={"motif": pattern[0], "thickness_mm": {"formula": "0.3 + 0.001*r"}}), EDGE)
    with pytest.raises(ValueError, match="weight"):
        UnitCell(motif_design(pattern, gravity={"on": True}, fabric={"modulus_mpa": 7.0}), EDGE)


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
    return compare_with_larger_cell(design, 2.5, relax_flat_cell(UnitCell(design, 2.5)))


@pytest.mark.slow
@pytest.mark.parametrize("pattern", [parallel(), grid(), diamonds(), waves(), stars()])
def test_lines_grids_waves_and_stars_repeat_cell_by_cell(pattern: Pattern) -> None:
    comparison = compared(pattern)
    assert comparison.reason is None
    assert abs(comparison.excess) < 1e-6
    np.testing.assert_allclose(comparison.larger_stretches, comparison.stretches, atol=1e-5)


@pytest.mark.slow
def test_a_connected_honeycomb_has_no_law_of_one_cell() -> None:
    comparison = compared(honeycomb())
    assert comparison.excess > 0.1 and comparison.reason is not None
    assert comparison.stretches.min() > 0.99 and comparison.larger_stretches.min() < 0.8
    assert comparison.reason is not None
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


@pytest.mark.slow
@pytest.mark.parametrize("name", ["grid", "diamonds"])
def test_the_work_of_gaussian_curvature_depends_on_the_cut_and_nothing_else_does(name: str) -> None:
    """Rods of a tense cell that stand for images elsewhere: another multiple of det K, the same tubes."""
    cell, flat = relaxed_cell(name)
    mesh = cell.mesh
    points = np.zeros((mesh.n_base, 2), dtype=np.int64)
    rods = np.random.default_rng(2).integers(-2, 3, size=(len(mesh.rods), 2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("asterism.homogenize.cell.free_cell_mesh.motif_cell_mesh", lambda *_: recut(mesh, points, rods))
        other = cell_of(name)
    here, there = (
        effective_stiffness(one, state).stiffness for one, state in ((cell, flat), (other, relax_flat_cell(other)))
    )
    part = there[3:, 3:][0, 1] - here[3:, 3:][0, 1]
    assert abs(part) > here[3, 3]
    changed = np.zeros((6, 6))
    changed[3:, 3:] = part * GAUSSIAN
    np.testing.assert_allclose(there - here, changed, atol=1e-4 * np.abs(here).max())
    alone = rod_bending(cell.design, flat.deformation)
    bending = [completed_by_rods(each[3:, 3:], alone) for each in (here, there)]
    np.testing.assert_allclose(bending[0], bending[1], atol=1e-3 * bending[0].max())
    assert np.linalg.eigvalsh(bending[0])[0] > 0.0
