"""The periodic mesh: what must hold for every star and supercell."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.cell.aligned_cell_mesh import aligned_cell_mesh
from asterism.homogenize.cell.point_group import aligned_lines
from asterism.homogenize.cell.unit_cell import cell_mesh
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from tests.homogenize.cells import design

VECTORS = np.asarray(design().lattice.vectors)
THREE = np.array([1, 3, 5])
SPACING = float(np.linalg.norm(VECTORS[0]))


@pytest.mark.parametrize("length", [1.0, 5.0, 8.66, 10.0, 13.0, SPACING])
@pytest.mark.parametrize("repeat", [(1, 1), (2, 2), (1, 3)])
def test_invariants(length, repeat):
    torus = aligned_cell_mesh(VECTORS, THREE, np.full(3, length), 2.5, repeat)
    stars = repeat[0] * repeat[1]
    corner = torus.points[torus.triangles]
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = 0.5 * (e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])
    assert (area > 0.0).all()
    assert area.sum() == pytest.approx(torus.area, rel=1e-12)
    assert torus.area == pytest.approx(stars * abs(np.linalg.det(VECTORS)), rel=1e-12)
    # Euler on the torus: V - E + F = 0 with 3 edges, all of them hinges, and 2 triangles for each base point
    assert len(torus.hinges) == 3 * torus.n_base
    assert len(torus.triangles) == 2 * torus.n_base
    assert len(torus.star_vertices) == stars
    assert len(torus.rods) == 3 * stars
    # images are where their lattice vector takes the base point
    np.testing.assert_allclose(torus.points, torus.points[torus.base] + torus.image @ torus.cell_vectors, atol=1e-12)
    assert (torus.image[: torus.n_base] == 0).all()
    for rod, star in zip(torus.rods, torus.arm_star, strict=True):
        steps = np.linalg.norm(np.diff(torus.points[rod], axis=0), axis=1)
        assert steps.sum() == pytest.approx(length, rel=1e-12)
        assert np.ptp(steps) < 1e-9 * length
        centre = torus.star_vertices[star]
        assert torus.base[rod[0]] == torus.base[centre]
        assert np.linalg.norm(torus.points[rod[-1]] - torus.points[rod[0]]) == pytest.approx(length, rel=1e-12)


def test_hinges_are_between_triangles():
    """Every hinge folds two triangles of the mesh about an edge that both have."""
    torus = aligned_cell_mesh(VECTORS, THREE, np.full(3, 9.0), 2.5)

    def place(vertices):
        """Classes of triangles modulo the lattice, by their middle."""
        middle = torus.points[vertices].mean(axis=1) @ np.linalg.inv(torus.cell_vectors)
        return {tuple(np.round(m % 1.0, 6) % 1.0) for m in middle}

    known = place(torus.triangles)
    left = torus.hinges[:, [0, 1, 2]]
    right = torus.hinges[:, [1, 0, 3]]
    assert place(left) <= known
    assert place(right) <= known


def test_arms_that_overlap_are_refused():
    with pytest.raises(MeshError, match="overlap"):
        aligned_cell_mesh(VECTORS, np.arange(6), np.full(6, 9.0), 2.5)
    assert len(aligned_cell_mesh(VECTORS, np.arange(6), np.full(6, 8.0), 2.5).rods) == len(GRID_DIRECTIONS)


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


@pytest.mark.parametrize("edge", [0.667, 1.2, 2.0, 3.0])
@pytest.mark.parametrize(
    ("lattice", "length"),
    [
        ({"kind": "square", "spacing_mm": 16.0, "arms": 4}, 7.0),
        ({"kind": "custom", "vectors_mm": [[10.0, 0.0], [0.0, 14.0]], "arms": 4}, 5.0),
        ({"kind": "triangular", "spacing_mm": 17.0, "arms": 6}, 8.0),
        ({"kind": "triangular", "spacing_mm": 17.0, "arms": 3}, 16.9),
    ],
)
def test_arms_have_their_length(lattice, length, edge):
    """On links with arms from both ends too, whether or not the tips meet."""
    star = design(length, lattice=lattice)
    torus = cell_mesh(star, edge)
    for rod in torus.rods:
        assert np.linalg.norm(torus.points[rod[-1]] - torus.points[rod[0]]) == pytest.approx(length, rel=1e-9)


@pytest.mark.parametrize("miss", [0.0, 4e-7, -4e-7])
@pytest.mark.parametrize("edge", [1.155, 3.0, 3.5, 5.8])
def test_tips_that_meet_are_one_point(miss, edge):
    """In the middle of a link, whatever the number of edges that would suit it best; but for rounding."""
    torus = aligned_cell_mesh(VECTORS, np.arange(6), np.full(6, SPACING * (0.5 + miss)), edge)
    assert len(np.unique(torus.base[[rod[-1] for rod in torus.rods]])) == 3
    area = triangle_areas(torus.points, torus.triangles)
    assert area.min() > 0.5 * area.mean()
