"""Triangles over heights: the border is smooth where the surface ends within the grid."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.fitting.disk import disk_of, height_mesh


def test_a_full_grid_is_taken_as_it_is() -> None:
    x, y = np.linspace(-3.0, 3.0, 4), np.linspace(-1.0, 1.0, 3)
    heights = np.arange(12.0).reshape(3, 4)
    vertices, triangles = height_mesh(heights, x, y)
    assert len(triangles) == 12
    assert vertices[:, 2].tolist() == heights.ravel().tolist()
    assert vertices[5].tolist() == [-1.0, 0.0, 5.0]


@pytest.mark.parametrize("points", [41, 81])
def test_a_round_border_has_no_steps(points: int) -> None:
    x = np.linspace(-40.0, 40.0, points)
    step, radius = x[1] - x[0], np.hypot(x[None], x[:, None])
    heights = np.where(radius < 36.0, 20.0 - 0.01 * radius**2, np.nan)
    disk = disk_of(*height_mesh(heights, x, x), "round")
    ring = disk.vertices[disk.border]
    away = np.hypot(*ring[:, :2].T)
    assert away.mean() == pytest.approx(36.0, abs=0.2 * step)
    assert away.std() < 0.25 * step
    # heights are continued to the border
    assert ring[:, 2] == pytest.approx(20.0 - 0.01 * away**2, abs=0.05 * step)
    # chords over some cells turn little: the border has no corners
    chord = np.roll(ring, -4, axis=0)[:, :2] - ring[:, :2]
    angle = np.unwrap(np.arctan2(chord[:, 1], chord[:, 0]))
    assert np.abs(angle[4:] - angle[:-4]).max() < np.deg2rad(35.0)


def test_the_edges_of_the_grid_stay_straight() -> None:
    x = np.linspace(0.0, 60.0, 31)
    heights = np.where(x[None] + x[:, None] < 80.0, 0.0, np.nan)
    vertices, triangles = height_mesh(heights, x, x)
    disk = disk_of(vertices, triangles, "cut")
    low = disk.vertices[disk.border].min(axis=0)
    assert low.tolist() == [0.0, 0.0, 0.0]
    on_edge = disk.vertices[disk.border][:, 0] == 0.0
    assert on_edge.sum() == 31
    cut = disk.vertices[disk.border]
    inner = cut[(cut[:, :2] > 25.0).all(axis=1)]
    assert inner[:, 0] + inner[:, 1] == pytest.approx(80.0, abs=1.5)
