"""Periodic meshes of cells, on the lattice lines and off them: what must hold for every star and supercell."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.homogenize.cell.aligned_cell_mesh import aligned_cell_mesh
from asterism.homogenize.cell.conforming_triangulation import IDENTITY, MIN_CELL_ANGLE_DEG
from asterism.homogenize.cell.periodic_mesh import PeriodicMesh, periodic_delaunay
from asterism.homogenize.cell.point_group import aligned_lines
from asterism.homogenize.cell.unit_cell import cell_mesh
from asterism.pattern.design.errors import DesignError, MeshError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.geometry.planar import triangle_angles, triangle_areas
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from tests.homogenize.cells import design

VECTORS = np.asarray(design().lattice.vectors)
SPACING = float(np.linalg.norm(VECTORS[0]))
SKEW = {"kind": "custom", "vectors_mm": [[14.0, 0.0], [4.0, 21.0]]}
STARS = [
    ({"arms": 5}, 6.0),
    ({"arms": 5}, 1.0),
    ({"arms": 7, "kind": "square"}, 8.0),
    ({"arms": 8}, 7.0),
    ({"orientation_deg": 20}, 10.0),
    ({"orientation_deg": 7}, 13.0),
    ({"arms": 4, "kind": "square", "orientation_deg": 7}, 13.0),
    ({"arms": 5, **SKEW}, 6.0),
    ({"arms": 5}, 0.0),
]


def mesh(lattice: dict[str, Any], length: float, edge: float = 1.92, repeat: tuple[int, int] = (1, 1)) -> PeriodicMesh:
    star = design(length, lattice=lattice)
    assert aligned_lines(star.lattice) is None
    return cell_mesh(star, edge, repeat)


def edges(torus: PeriodicMesh, triangles: np.ndarray) -> set[tuple[int, ...]]:
    """Directed edges as (base point, base point, images between them)."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    step = torus.image[ends[:, 1]] - torus.image[ends[:, 0]]
    return {tuple(row) for row in np.column_stack([torus.base[ends], step]).tolist()}


@pytest.mark.parametrize("edge", [2.9, 1.4])
@pytest.mark.parametrize(
    ("lattice", "length", "repeat"),
    [(*star, (1, 1)) for star in STARS]
    + [({}, length, repeat) for length in (1.0, 5.0, 8.66, 10.0, 13.0, SPACING) for repeat in ((1, 1), (2, 2), (1, 3))],
)
def test_invariants(lattice: dict[str, Any], length: float, edge: float, repeat: tuple[int, int]) -> None:
    torus = cell_mesh(design(length, lattice=lattice), edge, repeat)
    stars = repeat[0] * repeat[1]
    assert triangle_areas(torus.points, torus.triangles).sum() == pytest.approx(torus.area, rel=1e-12)
    assert torus.area == pytest.approx(stars * abs(np.linalg.det(Lattice.model_validate(lattice).vectors)), rel=1e-12)
    assert triangle_areas(torus.points, torus.triangles).min() > 0.0
    least = MIN_CELL_ANGLE_DEG if aligned_lines(design(length, lattice=lattice).lattice) is None else 15.0
    assert triangle_angles(torus.points, torus.triangles).min() >= least
    # Euler on the torus, and every edge with one triangle on either side
    assert len(torus.triangles) == 2 * torus.n_base
    assert len(torus.hinges) == 3 * torus.n_base
    known = edges(torus, torus.triangles)
    assert len(known) == 3 * len(torus.triangles)
    assert {(b, a, -i, -j) for a, b, i, j in known} == known
    assert edges(torus, torus.hinges[:, [0, 1, 2]]) <= known
    assert edges(torus, torus.hinges[:, [1, 0, 3]]) <= known
    # as fine as asked for: the area of a triangle is near that of an equilateral one
    segments = [np.linalg.norm(np.diff(torus.points[rod], axis=0), axis=1).max() for rod in torus.rods]
    equilateral = np.sqrt(0.75) / 2.0 * max(edge, *segments, 0.0) ** 2
    assert 0.6 < torus.area / (2 * torus.n_base) / equilateral < 1.3
    np.testing.assert_allclose(torus.points, torus.points[torus.base] + torus.image @ torus.cell_vectors, atol=1e-12)
    assert (torus.image[: torus.n_base] == 0).all() and len(torus.star_vertices) == stars
    arms = lattice.get("arms", 3) if length else 0
    assert len(torus.rods) == len(torus.arm_star) == stars * arms
    for rod, star in zip(torus.rods, torus.arm_star, strict=True):
        assert torus.base[rod[0]] == torus.base[torus.star_vertices[star]]
        steps = np.diff(torus.points[rod], axis=0)
        assert np.linalg.norm(steps.sum(axis=0)) == pytest.approx(length, rel=1e-12)
        assert np.linalg.norm(steps, axis=1).sum() == pytest.approx(length, rel=1e-12)
        pairs = np.column_stack([torus.base[rod[:-1]], torus.base[rod[1:]], np.diff(torus.image[rod], axis=0)])
        assert {tuple(row) for row in pairs.tolist()} <= known


@pytest.mark.parametrize("turn", [72.0, -72.0, 360.0])
def test_a_star_turned_onto_itself_has_the_same_mesh(turn: float) -> None:
    one, other = (mesh({"arms": 5, "orientation_deg": angle}, 6.0) for angle in (0.0, turn))
    np.testing.assert_array_equal(one.points, other.points)
    np.testing.assert_array_equal(one.triangles, other.triangles)


def test_arms_are_cut_finer_beside_others() -> None:
    """Where tips pass another star's arm at 1.2 mm; even elsewhere."""
    torus = mesh({"arms": 5}, 9.9, 2.9)
    steps = [np.linalg.norm(np.diff(torus.points[rod], axis=0), axis=1) for rod in torus.rods]
    assert min(step[-1] for step in steps) < 2.1 < 2.7 < min(step[0] for step in steps)
    alone = mesh({"arms": 5}, 5.8, 2.9)
    for rod in alone.rods:
        np.testing.assert_allclose(np.linalg.norm(np.diff(alone.points[rod], axis=0), axis=1), 2.9, rtol=1e-9)


def test_tips_that_meet_are_one_point() -> None:
    """Two of the eight arms on a square lattice end where their neighbours' do."""
    torus = cell_mesh(design(5.0 * np.sqrt(3.0), lattice={"arms": 8, "kind": "square"}), 1.92)
    assert len(np.unique(torus.base[[rod[-1] for rod in torus.rods]])) == 6


def test_arms_that_overlap_are_refused() -> None:
    with pytest.raises(MeshError, match="overlap"):
        aligned_cell_mesh(VECTORS, np.arange(6), np.full(6, 9.0), 2.5)
    assert len(aligned_cell_mesh(VECTORS, np.arange(6), np.full(6, 8.0), 2.5).rods) == 6
    with pytest.raises(DesignError, match=r"stars at \[0.00, 0.00\] and .* overlap; shorten or turn them"):
        mesh({"arms": 5}, 12.0)
    with pytest.raises(DesignError, match="print as one"):
        mesh({"arms": 5}, 10.5)
    with pytest.raises(MeshError, match="longer than the spacing"):
        mesh({"orientation_deg": 20}, 18.0)


def test_graded_cells_off_the_lattice_lines_and_points_with_a_hole_are_refused() -> None:
    with pytest.raises(MeshError, match="lattice lines"):
        cell_mesh(design(6.0, **GRADED, lattice={"orientation_deg": 10.0}), 3.0)
    with pytest.raises(MeshError, match="hole"):
        periodic_delaunay(np.random.default_rng(1).random((12, 2)), 20.0 * np.eye(2), 0.1, IDENTITY)


def test_ties_are_decided_alike_in_every_cell() -> None:
    """All four points of every square of a grid lie on one circle."""
    i, j = (index.ravel() for index in np.indices((5, 5)))
    found = periodic_delaunay(np.column_stack([i, j]) * 1.0, 5.0 * np.eye(2), 1.0, IDENTITY)
    assert len(found.corner) == 50
    found.edges()


@pytest.mark.parametrize(
    ("basis", "arms"),
    [
        ([[15, 5 * 3**0.5], [15, -5 * 3**0.5]], 3),
        ([[15, -5 * 3**0.5], [0, 10 * 3**0.5]], 3),
        ([[0, 10 * 3**0.5], [-15, -5 * 3**0.5]], 6),
    ],
)
def test_arms_along_the_lattice_are_so_in_any_basis(basis, arms):
    """Left-handed and obtuse ones too."""
    star = design(7.0, lattice={"kind": "custom", "vectors_mm": basis, "arms": arms})
    assert aligned_lines(star.lattice) is not None
    torus = cell_mesh(star, 3.0)
    assert triangle_areas(torus.points, torus.triangles).min() > 0.0


@pytest.mark.parametrize("miss", [0.0, 4e-7, -4e-7])
@pytest.mark.parametrize("edge", [1.155, 3.0, 3.5, 5.8])
def test_tips_that_meet_on_lattice_lines_are_one_point(miss, edge):
    """In the middle of a link, whatever the number of edges that would suit it best; but for rounding."""
    torus = aligned_cell_mesh(VECTORS, np.arange(6), np.full(6, SPACING * (0.5 + miss)), edge)
    assert len(np.unique(torus.base[[rod[-1] for rod in torus.rods]])) == 3
    area = triangle_areas(torus.points, torus.triangles)
    assert area.min() > 0.5 * area.mean()


GRADED = {"fabric": {"bending": "consistent"}, "mesh": {"graded": True}}


@pytest.mark.parametrize("length", [5.0, 8.0, 13.0])
@pytest.mark.parametrize("repeat", [(1, 1), (1, 2)])
def test_a_graded_one_has_the_triangles_of_the_even_mesh(length: float, repeat: tuple[int, int]) -> None:
    even = cell_mesh(design(length, fabric=GRADED["fabric"], mesh={"graded": False}), 2.2, repeat)
    graded = cell_mesh(design(length, **GRADED), 2.2, repeat)
    areas = triangle_areas(graded.points, graded.triangles)
    assert areas.min() > 0.0 and areas.sum() == pytest.approx(graded.area, rel=1e-12)
    assert areas.min() < 0.5 * triangle_areas(even.points, even.triangles).min()
    np.testing.assert_array_equal(graded.triangles, even.triangles)
    for rod, straight in zip(graded.rods, even.rods, strict=True):
        ends = graded.points[rod[[0, -1]]]
        np.testing.assert_allclose(ends, even.points[straight[[0, -1]]], atol=1e-9)
        steps = np.linalg.norm(np.diff(graded.points[rod], axis=0), axis=1)
        assert steps.sum() == pytest.approx(length, rel=1e-9)
        assert steps[-1] < 0.7 * steps[0]  # crowds at the tip


@pytest.mark.slow
def test_a_graded_one_is_the_mesh_of_a_sheet() -> None:
    """The triangles of the cell, moved by lattice vectors, are those around the middle star of a large sheet."""
    star = design(8.0, **GRADED, border={"rings": 2})
    plan = layout(star)
    sheet = mesh_layout(plan, 1.9, graded=True)
    cell = cell_mesh(star, 1.9)
    middle = plan.centres[np.argmin(np.linalg.norm(plan.centres - plan.centres.mean(axis=0), axis=1))]

    def places(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
        return points[triangles].mean(axis=1) - middle

    away = cell.points - cell.points[cell.star_vertices[0]] + middle
    steps = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)]) @ cell.cell_vectors
    ours = (places(away, cell.triangles)[:, None] + steps).reshape(-1, 2)
    theirs = places(sheet.points, sheet.triangles)
    theirs = theirs[np.linalg.norm(theirs, axis=1) < 0.8 * 17.32]
    apart = np.linalg.norm(theirs[:, None] - ours, axis=2).min(axis=1)
    assert len(theirs) > 50 and apart.max() < 0.02 * 1.9


def test_graded_bare_fabric_is_even() -> None:
    star = design(8.0, **GRADED)
    stars = star.required_stars.model_copy(update={"length_mm": 0.0})
    bare = cell_mesh(star.model_copy(update={"stars": stars}), 3.0)
    areas = triangle_areas(bare.points, bare.triangles)
    assert np.ptp(areas) < 1e-9
