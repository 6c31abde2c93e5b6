"""Scans whose motion and size are known are laid back; mirrored ones are not. Nearest places on triangles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from asterism.equilibrium.arrays import Floats
from asterism.measure.compare.nearest import NearestOnSurface
from asterism.measure.compare.registration import register
from asterism.measure.compare.scan import Scan, surface_samples
from asterism.measure.compare.scan_comparison import ScanComparison, compare_scan, fitted_size
from asterism.pattern import gallery
from asterism.pattern.geometry.normals import vertex_normals
from asterism.previews.session import preview
from asterism.shape.shape import Shape
from tests.asterism.measure.compare.scans import bent_sheet, motion, scanned
from tests.asterism.sheets import dome, saddle, sheet, tube

SHAPE = bent_sheet()
SURFACE = SHAPE.positions, SHAPE.triangles


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "noise", "part"), [(0, 0.0, 1.0), (2, 0.3, 0.6)])
def test_known_motions_are_undone(seed: int, noise: float, part: float) -> None:
    points, of_sheet = scanned(SHAPE, seed, noise, part)
    rotation, shift = motion(seed)
    best = register(points @ rotation.T + shift, *SURFACE, seed=seed)[0]
    assert np.linalg.det(best.rotation) == pytest.approx(1, abs=1e-9)
    np.testing.assert_allclose(best.rotation @ best.rotation.T, np.eye(3), atol=1e-9)
    off = best(points @ rotation.T + shift) - points
    assert np.sqrt((off[of_sheet] ** 2).sum(axis=1).mean()) < 0.15 + 1.5 * noise


@pytest.mark.slow
def test_a_mirrored_scan_is_another_shape() -> None:
    points, _ = scanned(SHAPE, 0, 0.1, other=0.0)
    right, mirrored = (register(p, *SURFACE)[0] for p in (points, points * [-1.0, 1.0, 1.0]))
    assert right.spread_mm < 0.25
    assert mirrored.spread_mm > 4 * right.spread_mm
    assert np.linalg.det(mirrored.rotation) == pytest.approx(1, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("place", [saddle, dome, tube])
def test_symmetric_shapes_come_to_lie_on_themselves(place) -> None:
    shape = sheet(place, edge=3.0)
    points, _ = scanned(shape, 5, 0.2, 1.0)
    rotation, shift = motion(5)
    poses = register(points @ rotation.T + shift, shape.positions, shape.triangles)
    assert poses[0].spread_mm < 0.25


@pytest.mark.slow
def test_a_table_under_the_sheet_is_left_out() -> None:
    points, _ = scanned(SHAPE, 7, 0.1, 1.0, other=0.0)
    rng = np.random.default_rng(7)
    table = np.column_stack([rng.uniform(-30, 30, 1000), rng.uniform(-25, 25, 1000), np.full(1000, -25.0)])
    everything = np.concatenate([points, table])
    rotation, shift = motion(7)
    found = compare_scan(SHAPE, Scan(everything @ rotation.T + shift, 0, len(everything)))
    s = found.distances()
    assert s["rms_mm"] < 0.2
    assert s["points_left_out_percent"] == pytest.approx(100 * 1000 / 7000, abs=0.5)


@pytest.mark.slow
def test_what_is_measured() -> None:
    """A sheet that lies 0.5 mm off to its plastic side, with a bump of 2 mm, of which a third was scanned."""
    points, _ = scanned(SHAPE, 8, 0.0, 1.0, other=0.0)
    found = compare_scan(SHAPE, Scan(points, 0, len(points)))
    s = found.distances()
    assert s["rms_mm"] < 0.02 and s["shape_covered_percent"] > 98 and s["points_left_out_percent"] == 0
    assert s["poses_as_good"] == 1
    placed = np.column_stack([points, np.ones(len(points))]) @ np.array(s["scan_to_shape"]).T
    np.testing.assert_allclose(placed[:, :3], found.points, atol=1e-9)

    bump = 2 * np.exp(-((points[:, 0] - 20) ** 2 + points[:, 1] ** 2) / 150)
    raised = points + np.column_stack([0 * bump, 0 * bump, bump])
    found = compare_scan(SHAPE, Scan(raised, 0, len(raised)))
    there = np.linalg.norm(SHAPE.printed - [20, 0], axis=1) < 2
    away = np.linalg.norm(SHAPE.printed - [-30, 0], axis=1) < 8
    assert np.nanmean(found.vertex_distance[there]) == pytest.approx(2 * 0.96, abs=0.25)
    assert abs(np.nanmean(found.vertex_distance[away])) < 0.1
    assert found.used.all()

    part = points[points[:, 0] < np.quantile(points[:, 0], 1 / 3)]
    covered = compare_scan(SHAPE, Scan(part, 0, len(part))).distances()["shape_covered_percent"]
    assert covered == pytest.approx(100 / 3, abs=4)


@pytest.mark.slow
def test_a_sheet_like_itself_from_two_sides_says_two() -> None:
    """A scan without noise too, where nothing but the registration's own error is left."""
    shape = sheet(saddle, edge=3.0)
    points, _ = scanned(shape, 5, 0.0, 1.0, other=0.0)
    rotation, shift = motion(0)
    found = compare_scan(shape, Scan(points @ rotation.T + shift, 0, len(points)))
    assert found.distances()["poses_as_good"] == 2


@pytest.mark.slow
def test_a_scan_of_a_part_is_laid_where_it_belongs() -> None:
    """A piece of a rolled sheet without noise."""
    seed, part = 3, 0.35
    shape = preview(gallery.load("fig8-l-increasing"))
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, 6.28)
    along = shape.printed[shape.triangles].mean(axis=1) @ [np.cos(angle), np.sin(angle)]
    points = surface_samples(shape.positions, shape.triangles[along > np.quantile(along, 1.0 - part)], 5000, rng)[0]
    turn = Rotation.random(random_state=seed).as_matrix()
    s = compare_scan(shape, Scan(points @ turn.T + [10.0, 20.0, 30.0], 0, len(points))).distances()
    assert s["rms_mm"] < 0.01 and s["poses_as_good"] == 1


def test_on_a_sheet_with_its_side() -> None:
    shape = sheet(saddle, edge=4.0)
    surface = NearestOnSurface(shape.positions, shape.triangles)
    middles = shape.positions[shape.triangles].mean(axis=1)
    above = surface(middles + 0.3 * surface.normals)
    np.testing.assert_allclose(above.distance, 0.3, atol=0.02)
    np.testing.assert_allclose(surface(middles - 0.3 * surface.normals).distance, -0.3, atol=0.02)
    points = middles + np.random.default_rng(0).normal(size=middles.shape)
    corners = shape.positions[shape.triangles]
    every = np.array(
        [
            np.linalg.norm(trimesh.triangles.closest_point(corners, np.tile(p, (len(corners), 1))) - p, axis=1).min()
            for p in points[::25]
        ]
    )
    np.testing.assert_allclose(np.abs(surface(points[::25]).distance), every, atol=1e-9)


def test_beside_small_triangles_a_large_one_is_found() -> None:
    """A sheet whose triangles grow from one side to the other, by two orders of magnitude."""
    rng = np.random.default_rng(4)
    x, y = 60.0 * rng.random(1500) ** 3, 20.0 * rng.random(1500)
    vertices = np.column_stack([x, y, 0.1 * x * np.sin(0.3 * y)])
    triangles = Delaunay(vertices[:, :2]).simplices
    surface, corners = NearestOnSurface(vertices, triangles), vertices[triangles]
    points = vertices[::7] + rng.normal(0.0, 2.0, (len(vertices[::7]), 3))
    every = [
        np.linalg.norm(trimesh.triangles.closest_point(corners, np.tile(p, (len(corners), 1))) - p, axis=1).min()
        for p in points
    ]
    np.testing.assert_allclose(np.abs(surface(points).distance), every, atol=1e-9)


def laid(shape: Shape, ratio: float, part: float = 1.0) -> ScanComparison:
    """A scan of so many times its size."""
    points, _ = scanned(shape, 5, 0.05, part, other=0.0)
    rotation, shift = motion(5)
    return compare_scan(shape, Scan(ratio * points @ rotation.T + shift, 0, len(points)))


@pytest.mark.slow
@pytest.mark.parametrize(("form", "ratio"), [("bent", 1.12), ("dome", 0.95), ("dome", 1.0)])
def test_the_size_of_a_whole_scan_is_found(form: str, ratio: float) -> None:
    numbers = laid(bent_sheet() if form == "bent" else sheet(dome), ratio).distances()
    assert numbers["best_size"] == pytest.approx(ratio, abs=0.005)
    assert numbers["rms_percent_at_best_size"] < 0.2
    if ratio != 1.0:
        assert numbers["rms_percent"] > 1.2 * numbers["rms_percent_at_best_size"]


@pytest.mark.slow
def test_a_part_fits_in_many_sizes() -> None:
    numbers = laid(bent_sheet(), 1.05, part=0.7).distances()
    assert numbers["best_size"] is None and numbers["rms_percent_at_best_size"] is None


@pytest.mark.slow
def test_one_side_of_a_roll_is_no_other_size() -> None:
    """Of a tube every parallel surface is one of another radius; its length tells."""
    shape = preview(gallery.load("fig8-l-uniform"))
    for off_mm, scale in ((-0.5, 1.0), (0.5, 1.04)):
        side = replace(shape, positions=shape.positions + off_mm * vertex_normals(shape.positions, shape.triangles))
        points, _ = scanned(side, 5, 0.05, other=0.0)
        size = compare_scan(shape, Scan(scale * points, 0, len(points))).size
        assert size is not None
        assert size.lifted_rms_mm < 0.6 * size.rms_mm if scale == 1.0 else size.lifted_rms_mm > size.rms_mm


@pytest.mark.slow
def test_a_scan_is_lifted_by_no_more_than_a_sheet_is_thick() -> None:
    """By 2 mm: what lies farther off is no other side of the sheet."""

    def roll(points: Floats) -> Floats:
        x, y = points.T
        return np.column_stack([30.0 * np.sin(x / 30.0), y, 30.0 * np.cos(x / 30.0)])

    shape = sheet(roll, edge=3.0)
    for off_mm in (1.0, 3.0, -3.0):
        side = replace(shape, positions=shape.positions + off_mm * vertex_normals(shape.positions, shape.triangles))
        size = fitted_size(shape, scanned(side, 5, 0.05, other=0.0)[0], 10.0)
        assert size is not None and (size.lifted_rms_mm > 0.3) == (abs(off_mm) > 2.0)
