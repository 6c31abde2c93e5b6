"""Scans whose motion and size are known are laid back; mirrored ones are not. Nearest places on triangles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from scipy.spatial import Delaunay

from asterism import Shape, preview
from asterism.equilibrium.arrays import Floats
from asterism.measure.compare import compare_scan, fitted_size
from asterism.measure.registration import register
from asterism.measure.scan import Scan
from asterism.pattern import gallery
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.normals import vertex_normals
from asterism.shape.surface import NearestOnSurface
from tests.asterism.measure.compare.scans import bent_sheet, motion, scanned
from tests.asterism.sheets import dome, saddle, sheet

SHAPE = bent_sheet()
SURFACE = SHAPE.positions, SHAPE.triangles


@pytest.mark.slow
def test_a_known_motion_is_undone() -> None:
    seed, noise = 2, 0.3
    points, of_sheet = scanned(SHAPE, seed, noise, part=0.6, count=6000)
    rotation, shift = motion(seed)
    best = register(points @ rotation.T + shift, *SURFACE, seed=seed)[0]
    assert np.linalg.det(best.rotation) == pytest.approx(1, abs=1e-9)
    np.testing.assert_allclose(best.rotation @ best.rotation.T, np.eye(3), atol=1e-9)
    off = best(points @ rotation.T + shift) - points
    assert np.sqrt((off[of_sheet] ** 2).sum(axis=1).mean()) < 0.15 + 1.5 * noise


@pytest.mark.slow
def test_a_table_under_the_sheet_is_left_out() -> None:
    points, _ = scanned(SHAPE, 7, 0.1, 1.0, other=0.0)
    rng = np.random.default_rng(7)
    table = np.column_stack([rng.uniform(-30, 30, 400), rng.uniform(-25, 25, 400), np.full(400, -25.0)])
    everything = np.concatenate([points, table])
    rotation, shift = motion(7)
    found = compare_scan(SHAPE, Scan(everything @ rotation.T + shift, 0, len(everything)))
    s = found.distances()
    assert s["rms_mm"] < 0.2
    assert s["points_left_out_percent"] == pytest.approx(100 * 400 / 2900, abs=0.5)


@pytest.mark.slow
def test_what_is_measured() -> None:
    """A sheet of which a third was scanned, and a whole one with a bump of 2 mm."""
    points, _ = scanned(SHAPE, 8, 0.0, 1.0, other=0.0)
    part = points[points[:, 0] < np.quantile(points[:, 0], 1 / 3)]
    found = compare_scan(SHAPE, Scan(part, 0, len(part)))
    s = found.distances()
    assert s["rms_mm"] < 0.02 and s["points_left_out_percent"] == 0 and s["poses_as_good"] == 1
    assert s["shape_covered_percent"] == pytest.approx(100 / 3, abs=4)
    placed = np.column_stack([part, np.ones(len(part))]) @ np.array(s["scan_to_shape"]).T
    np.testing.assert_allclose(placed[:, :3], found.points, atol=1e-9)

    bump = 2 * np.exp(-((points[:, 0] - 20) ** 2 + points[:, 1] ** 2) / 150)
    raised = points + np.column_stack([0 * bump, 0 * bump, bump])
    found = compare_scan(SHAPE, Scan(raised, 0, len(raised)))
    there = np.linalg.norm(SHAPE.printed - [20, 0], axis=1) < 2
    away = np.linalg.norm(SHAPE.printed - [-30, 0], axis=1) < 8
    assert np.nanmean(found.vertex_distance[there]) == pytest.approx(2 * 0.96, abs=0.25)
    assert abs(np.nanmean(found.vertex_distance[away])) < 0.1
    assert found.used.all()


@pytest.mark.slow
def test_a_sheet_like_itself_from_two_sides_says_two() -> None:
    """A scan without noise too, where nothing but the registration's own error is left."""
    shape = sheet(saddle, edge=3.0)
    points, _ = scanned(shape, 5, 0.0, 1.0, other=0.0)
    rotation, shift = motion(0)
    found = compare_scan(shape, Scan(points @ rotation.T + shift, 0, len(points)))
    assert found.distances()["poses_as_good"] == 2


def test_on_a_sheet_with_its_side() -> None:
    shape = sheet(saddle, edge=4.0)
    surface = NearestOnSurface(shape.positions, shape.triangles)
    middles = shape.positions[shape.triangles].mean(axis=1)
    above = surface(middles + 0.3 * surface.normals)
    np.testing.assert_allclose(above.distance, 0.3, atol=0.02)
    np.testing.assert_allclose(surface(middles - 0.3 * surface.normals).distance, -0.3, atol=0.02)
    points = middles + np.random.default_rng(0).normal(size=middles.shape)
    assert_nearest(surface, shape.positions[shape.triangles], points[::25])


def assert_nearest(surface: NearestOnSurface, corners: Floats, points: Floats) -> None:
    """Of all triangles, one after the other."""
    every = [
        np.linalg.norm(trimesh.triangles.closest_point(corners, np.tile(p, (len(corners), 1))) - p, axis=1).min()
        for p in points
    ]
    np.testing.assert_allclose(np.abs(surface(points).distance), every, atol=1e-9)


def test_beside_small_triangles_a_large_one_is_found() -> None:
    """A sheet whose triangles grow from one side to the other, by two orders of magnitude."""
    rng = np.random.default_rng(4)
    x, y = 60.0 * rng.random(1500) ** 3, 20.0 * rng.random(1500)
    vertices = np.column_stack([x, y, 0.1 * x * np.sin(0.3 * y)])
    triangles = Delaunay(vertices[:, :2]).simplices
    points = vertices[::7] + rng.normal(0.0, 2.0, (len(vertices[::7]), 3))
    assert_nearest(NearestOnSurface(vertices, triangles), vertices[triangles], points)


@pytest.mark.parametrize(("form", "ratio"), [(SHAPE, 1.12), (sheet(dome), 0.95)], ids=["bent", "dome"])
def test_the_size_of_a_whole_scan_is_found(form: Shape, ratio: float) -> None:
    """And a part fits in many sizes."""
    size = fitted_size(form, ratio * scanned(form, 5, 0.05, other=0.0, count=6000)[0], 15.0)
    assert size is not None and size.ratio == pytest.approx(ratio, abs=0.005)
    assert size.rms_mm < 0.002 * diameter(form.positions) and size.lifted_rms_mm > 1.2 * size.rms_mm
    assert fitted_size(form, scanned(form, 5, 0.05, part=0.7, other=0.0)[0], 15.0) is None


@pytest.mark.slow
def test_one_side_of_a_roll_is_no_other_size() -> None:
    """Of a tube every parallel surface is one of another radius; its length tells."""
    shape = preview(gallery.load("fig8-l-uniform"))
    for off_mm, scale in ((-0.5, 1.0), (0.5, 1.04)):
        side = replace(shape, positions=shape.positions + off_mm * vertex_normals(shape.positions, shape.triangles))
        size = fitted_size(shape, scale * scanned(side, 5, 0.05, other=0.0, count=6000)[0], 10.0)
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
        size = fitted_size(shape, scanned(side, 5, 0.05, other=0.0, count=6000)[0], 10.0)
        assert size is not None and (size.lifted_rms_mm > 0.3) == (abs(off_mm) > 2.0)
