"""Curvatures and strains of surfaces whose values are known."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.geometry.normals import vertex_normals
from asterism.shape import surface as fields
from tests.asterism import sheets


def inside(points: np.ndarray, margin: float = 6.0) -> np.ndarray:
    return (np.abs(points) < np.ptp(points, axis=0) / 2 - margin).all(axis=1)


@pytest.mark.parametrize("edge", [4.0, 2.0])
def test_a_sphere_has_its_curvatures(edge: float) -> None:
    shape = sheets.sheet(lambda p: sheets.dome(p, radius=90.0), edge=edge)
    core = inside(shape.printed, 12.0)
    mean = fields.mean_curvature(shape.positions, shape.triangles)[core]
    gauss = fields.gaussian_curvature(shape.positions, shape.triangles)[core]
    assert mean == pytest.approx(1 / 90, rel=0.02)
    assert np.mean(gauss) == pytest.approx(1 / 90**2, rel=0.01)


def test_a_cylinder_bends_one_way() -> None:
    def bent(points: np.ndarray) -> np.ndarray:
        angle = points[:, 1] / 40
        return np.column_stack([points[:, 0], 40 * np.sin(angle), 40 * np.cos(angle)])

    shape = sheets.sheet(bent)
    core = inside(shape.printed)
    mean = fields.mean_curvature(shape.positions, shape.triangles)[core]
    gauss = fields.gaussian_curvature(shape.positions, shape.triangles)[core]
    assert mean == pytest.approx(1 / 80, rel=0.01)
    assert np.abs(gauss).max() < 1e-3 / 80


def test_turning_the_sheet_over_changes_the_sign_of_the_mean_curvature() -> None:
    shape = sheets.sheet(sheets.dome, edge=5.0)
    up = fields.mean_curvature(shape.positions, shape.triangles)
    down = fields.mean_curvature(shape.positions * [1, 1, -1], shape.triangles)
    assert np.allclose(up, -down, equal_nan=True)


def test_curvature_is_undefined_on_the_border_only() -> None:
    shape = sheets.sheet(sheets.saddle, edge=5.0)
    on_edge = (np.isclose(np.abs(shape.printed), [50.0, 40.0])).any(axis=1)
    for curvature in (fields.mean_curvature, fields.gaussian_curvature):
        assert np.array_equal(np.isnan(curvature(shape.positions, shape.triangles)), on_edge)


def test_vertex_areas_add_up_to_the_sheet() -> None:
    shape = sheets.sheet(sheets.saddle)
    total = fields.surface_triangle_areas(shape.positions, shape.triangles).sum()
    areas = fields.vertex_areas(shape.positions, shape.triangles)
    assert areas.sum() == pytest.approx(total, rel=1e-12)
    assert areas.min() > 0
    assert fields.surface_triangle_areas(shape.printed, shape.triangles).sum() == pytest.approx(8000, rel=1e-12)


def test_gauss_bonnet_on_a_closed_surface() -> None:
    octahedron = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
    faces = np.array([[i, (i + 1) % 4, 4] for i in range(4)] + [[(i + 1) % 4, i, 5] for i in range(4)])
    area = fields.vertex_areas(octahedron, faces)
    assert fields.gaussian_curvature(octahedron, faces) @ area == pytest.approx(4 * np.pi, rel=1e-12)


def test_strains_of_a_known_stretch() -> None:
    turn = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)]])
    gradient = np.column_stack([turn @ np.diag([1.2, 0.9]) @ turn.T, [0.0, 0.0]])
    shape = sheets.sheet(lambda p: p @ gradient, edge=5.0)
    strain = fields.principal_strains(fields.deformation_gradients(shape.printed, shape.positions, shape.triangles))
    assert np.allclose(strain, [0.2, -0.1], atol=1e-12)


def test_rest_strain_counts_from_the_fabric_before_it_was_stretched() -> None:
    shape = sheets.sheet(sheets.flat, edge=5.0)
    found = fields.cell_fields(shape.printed, shape.positions, shape.triangles, (1.35, 1.2))
    assert np.allclose(found["strain_from_print_max"], 0, atol=1e-12)
    assert np.allclose(found["strain_from_rest_max"], 0.35, atol=1e-12)
    assert np.allclose(found["strain_from_rest_min"], 0.2, atol=1e-12)


def test_collapsed_triangles_give_no_surprise() -> None:
    """A state that is not an answer still has fields, so that it can be looked at."""
    shape = sheets.sheet(lambda p: sheets.flat(p * [1.0, 0.0]), edge=10.0)
    with np.errstate(all="ignore"):
        normals = vertex_normals(shape.positions, shape.triangles)
    assert np.isfinite(normals).all()
    assert np.allclose(
        fields.principal_strains(fields.deformation_gradients(shape.printed, shape.positions, shape.triangles)),
        [0, -1],
        atol=1e-7,
    )
