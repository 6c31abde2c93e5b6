"""A shape maps printed points into space, knows its own size, and has the curvatures and strains of known surfaces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from asterism.pattern.geometry.normals import vertex_normals
from asterism.shape import surface as fields
from asterism.shape.shape import Shape
from tests.asterism import sheets


def moved(shape: Shape, rotation: Rotation) -> Shape:
    return replace(shape, positions=rotation.apply(shape.positions) + np.array([3.0, -50.0, 7.0]))


def affine(points: np.ndarray) -> np.ndarray:
    return points @ np.array([[0.7, 0.1, 0.3], [-0.2, 0.8, 0.5]]) + [1.0, 2.0, 3.0]


AFFINE_SHEET = sheets.sheet(affine, edge=5.0)


@given(st.tuples(st.floats(-50, 50), st.floats(-40, 40)))
def test_an_affine_map_is_reproduced_everywhere(point: tuple[float, float]) -> None:
    assert np.allclose(AFFINE_SHEET.at(np.array([point])), affine(np.array([point])), atol=1e-12)


def test_points_in_long_triangles_are_found() -> None:
    """Many small triangles are closer by their centroids than the long one that holds the point."""
    line = np.column_stack([np.linspace(0, 1, 40), np.zeros(40)])
    printed = np.concatenate([line, [[0.5, 100.0], [0.5, -0.01]]])
    fans = [[i, i + 1, 40] for i in range(39)] + [[i + 1, i, 41] for i in range(39)]
    shape = Shape(
        printed=printed,
        positions=sheets.flat(printed),
        triangles=np.array(fans),
        star=np.full(len(printed), -1),
        rods=(),
        star_vertices=np.empty(0, dtype=int),
    )
    points = np.array([[0.5, 99.0], [0.1, 1.0], [0.9, 0.5], [0.5, -0.005]])
    assert np.allclose(shape.at(points)[:, :2], points, atol=1e-12)


@pytest.mark.parametrize("point", [(50.1, 0.0), (0.0, -40.001), (1e9, 0.0), (np.nan, 0.0), (0.0, np.inf)])
def test_points_off_the_sheet_are_refused(point: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match=r"off the sheet|not a number"):
        AFFINE_SHEET.at(np.array([(0.0, 0.0), point]))


@pytest.mark.parametrize("points", [[], [[0.0, 0.0, 0.0]], 3.0])
def test_what_are_no_points_is_refused(points: object) -> None:
    with pytest.raises(ValueError, match="must be pairs of mm"):
        AFFINE_SHEET.at(points)  # type: ignore[arg-type]


def test_points_on_the_border_survive_rounding() -> None:
    edge = np.column_stack([np.full(100, 50.0 * (1 + 1e-15)), np.linspace(-40, 40, 100)])
    assert np.isfinite(AFFINE_SHEET.at(edge)).all()


def test_extent_does_not_depend_on_the_pose_unless_the_sheet_is_held() -> None:
    leaning = moved(sheets.sheet(sheets.flat, edge=5.0), Rotation.from_euler("x", 30, degrees=True))
    assert leaning.extent_mm == pytest.approx((100, 80, 0), abs=1e-9)
    held = replace(leaning, held=True)
    assert held.extent_mm == pytest.approx((100, 80 * np.sqrt(0.75), 40))
    assert held.extent_mm[2] == held.height_mm


@pytest.mark.parametrize("place", [sheets.dome, sheets.tube, sheets.saddle])
def test_aligned_brings_every_pose_to_the_same_one(place) -> None:  # type: ignore[no-untyped-def]
    shape = sheets.sheet(place)
    expected = shape.aligned()
    for seed in range(5):
        again = moved(shape, Rotation.random(rng=np.random.default_rng(seed))).aligned()
        assert np.allclose(again.positions, expected.positions, atol=1e-6)
    distance = np.linalg.norm(expected.positions[::7] - expected.positions[0], axis=1)
    assert np.allclose(distance, np.linalg.norm(shape.positions[::7] - shape.positions[0], axis=1))


def test_aligned_shows_the_plastic_side_and_turns_vectors() -> None:
    upside_down = moved(sheets.sheet(sheets.dome), Rotation.from_euler("x", 180, degrees=True))
    shape = upside_down.aligned()
    centre = np.linalg.norm(shape.printed, axis=1).argmin()
    assert shape.positions[centre, 2] == pytest.approx(shape.positions[:, 2].max(), abs=0.1)
    vectors = {"normal": vertex_normals(upside_down.positions, shape.triangles)}
    turned = replace(upside_down, point_fields=vectors).aligned()
    assert np.allclose(turned.point_fields["normal"], vertex_normals(turned.positions, turned.triangles))


def inside(points: np.ndarray, margin: float = 6.0) -> np.ndarray:
    return (np.abs(points) < np.ptp(points, axis=0) / 2 - margin).all(axis=1)


@pytest.mark.parametrize(("edge", "up"), [(4.0, 1), (2.0, 1), (2.0, -1)])
def test_a_sphere_has_its_curvatures(edge: float, up: int) -> None:
    """The mean one is positive where the plastic side is convex."""
    shape = sheets.sheet(lambda p: sheets.dome(p, radius=90.0) * [1, 1, up], edge=edge)
    core = inside(shape.printed, 12.0)
    mean = fields.mean_curvature(shape.positions, shape.triangles)[core]
    gauss = fields.gaussian_curvature(shape.positions, shape.triangles)[core]
    assert mean == pytest.approx(up / 90, rel=0.02)
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
    strain = fields.principal_strains(fields.deformation_gradients(shape.printed, shape.positions, shape.triangles))
    assert np.allclose(strain, [0, -1], atol=1e-7)
