"""The periodic mesh of stars whose arms lie on no lattice lines: what must hold for all of them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.homogenize.cell.conforming_triangulation import MIN_CELL_ANGLE_DEG
from asterism.homogenize.cell.periodic_delaunay import periodic_delaunay
from asterism.homogenize.cell.periodic_mesh import PeriodicMesh
from asterism.homogenize.cell.point_group import aligned_lines
from asterism.homogenize.cell.unit_cell import cell_mesh
from asterism.pattern.design.errors import DesignError, MeshError
from asterism.pattern.geometry.planar import triangle_angles, triangle_areas
from tests.homogenize.cells import design

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
@pytest.mark.parametrize(("lattice", "length"), STARS)
def test_invariants(lattice: dict[str, Any], length: float, edge: float) -> None:
    torus = mesh(lattice, length, edge)
    assert triangle_areas(torus.points, torus.triangles).sum() == pytest.approx(torus.area, rel=1e-12)
    assert triangle_areas(torus.points, torus.triangles).min() > 0.0
    assert triangle_angles(torus.points, torus.triangles).min() >= MIN_CELL_ANGLE_DEG
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
    arms = lattice.get("arms", 3) if length else 0
    assert len(torus.rods) == len(torus.arm_star) == arms
    for rod in torus.rods:
        assert rod[0] == torus.star_vertices[0]
        steps = np.diff(torus.points[rod], axis=0)
        assert np.linalg.norm(steps.sum(axis=0)) == pytest.approx(length, rel=1e-12)
        assert np.linalg.norm(steps, axis=1).sum() == pytest.approx(length, rel=1e-12)
        pairs = np.column_stack([torus.base[rod[:-1]], torus.base[rod[1:]], np.diff(torus.image[rod], axis=0)])
        assert {tuple(row) for row in pairs.tolist()} <= known


def test_several_cells_are_the_same_mesh_again() -> None:
    """Every point, triangle, hinge and arm of 2 x 3 cells lies on one of the single cell."""
    one, many = (mesh({"arms": 5}, 6.0, 2.9, repeat) for repeat in ((1, 1), (2, 3)))

    def places(torus: PeriodicMesh, vertices: np.ndarray) -> np.ndarray:
        middle = torus.points[vertices].mean(axis=1) @ np.linalg.inv(one.cell_vectors)
        return np.round(middle % 1.0, 7) % 1.0

    for kind in ("triangles", "hinges"):
        rows, counts = np.unique(places(many, getattr(many, kind)), axis=0, return_counts=True)
        assert (counts == 6).all()
        np.testing.assert_allclose(rows, np.unique(places(one, getattr(one, kind)), axis=0), atol=1e-6)
    assert many.n_base == 6 * one.n_base
    assert len(many.rods) == 6 * len(one.rods)
    assert len(many.star_vertices) == 6
    for rod, star in zip(many.rods, many.arm_star, strict=True):
        assert rod[0] == many.star_vertices[star]


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
    star = design(0.5 * 10 * np.sqrt(3.0), lattice={"arms": 8, "kind": "square"})
    torus = cell_mesh(star, 1.92)
    tips = torus.base[[rod[-1] for rod in torus.rods]]
    assert len(np.unique(tips)) == 6


def test_arms_that_overlap_are_refused() -> None:
    with pytest.raises(DesignError, match=r"stars at \[0.00, 0.00\] and .* overlap; shorten or turn them"):
        mesh({"arms": 5}, 12.0)
    with pytest.raises(DesignError, match="print as one"):
        mesh({"arms": 5}, 10.5)
    with pytest.raises(MeshError, match="longer than the spacing"):
        mesh({"orientation_deg": 20}, 18.0)


def test_points_with_a_hole_are_refused() -> None:
    corner = np.random.default_rng(1).random((12, 2))
    with pytest.raises(MeshError, match="hole"):
        periodic_delaunay(corner, 20.0 * np.eye(2), 0.1)


def test_ties_are_decided_alike_in_every_cell() -> None:
    """All four points of every square of a grid lie on one circle."""
    i, j = (index.ravel() for index in np.indices((5, 5)))
    found = periodic_delaunay(np.column_stack([i, j]) * 1.0, 5.0 * np.eye(2), 1.0)
    assert len(found.corner) == 50
    found.edges()
