"""Scans whose motion is known are laid back; mirrored ones are not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.measure.compare.registration import register
from asterism.measure.compare.scan import Scan, surface_samples
from asterism.measure.compare.scan_comparison import compare_scan
from asterism.pattern import gallery
from asterism.previews.session import preview
from tests.asterism.measure.compare.scans import bent_sheet, motion, scanned
from tests.asterism.sheets import dome, saddle, sheet, tube

SHAPE = bent_sheet()
SURFACE = SHAPE.positions, SHAPE.triangles


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "noise", "part"), [(0, 0.0, 1.0), (1, 0.3, 1.0), (2, 0.3, 0.6), (3, 0.1, 0.5)])
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
@pytest.mark.parametrize(("seed", "part"), [(3, 0.35), (0, 0.5)])
def test_a_scan_of_a_part_is_laid_where_it_belongs(seed: int, part: float) -> None:
    """Pieces of a rolled sheet without noise."""
    shape = preview(gallery.load("fig8-l-increasing"))
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, 6.28)
    along = shape.printed[shape.triangles].mean(axis=1) @ [np.cos(angle), np.sin(angle)]
    points = surface_samples(shape.positions, shape.triangles[along > np.quantile(along, 1.0 - part)], 5000, rng)[0]
    turn = Rotation.random(random_state=seed).as_matrix()
    s = compare_scan(shape, Scan(points @ turn.T + [10.0, 20.0, 30.0], 0, len(points))).distances()
    assert s["rms_mm"] < 0.01 and s["poses_as_good"] == 1
