"""Graded cells: the mesh of a cell in the middle of a graded sheet."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.homogenize.cell.unit_cell import cell_mesh
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from tests.homogenize.cells import design

GRADED = {"fabric": {"bending": "consistent"}, "mesh": {"graded": True}}


@pytest.mark.parametrize("length", [5.0, 8.0, 13.0])
@pytest.mark.parametrize("repeat", [(1, 1), (1, 2)])
def test_it_has_the_connectivity_of_the_even_mesh_and_covers_the_cell(length: float, repeat: tuple[int, int]) -> None:
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
def test_it_is_the_mesh_of_a_sheet() -> None:
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


def test_cells_off_the_lattice_lines_are_refused() -> None:
    with pytest.raises(MeshError, match="lattice lines"):
        cell_mesh(design(6.0, **GRADED, lattice={"orientation_deg": 10.0}), 3.0)


def test_bare_fabric_is_even() -> None:
    star = design(8.0, **GRADED)
    stars = star.required_stars.model_copy(update={"length_mm": 0.0})
    bare = cell_mesh(star.model_copy(update={"stars": stars}), 3.0)
    areas = triangle_areas(bare.points, bare.triangles)
    assert np.ptp(areas) < 1e-9
