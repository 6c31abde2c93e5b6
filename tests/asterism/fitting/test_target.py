"""Targets: files, checks with one line each, side and pose."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.fitting.disk import TargetError
from asterism.fitting.target import MAX_TARGET_TRIANGLES, TargetSurface
from asterism.fitting.target_files import load_target
from tests.asterism.fitting.surfaces import Mesh, bow_tie, spherical_cap

BROKEN: list[tuple[Callable[[], Mesh], str]] = [
    (bow_tie, "the border touches itself at"),
    (lambda: (np.zeros((3, 3)), np.array([[0, 1, 2]])), "holds no triangles"),
    (lambda: (np.array([[0.0, 0, 0], [50, 0, 0], [100, 0, 0]]), np.array([[0, 1, 2]])), "have no area"),
    (lambda: (0.01 * spherical_cap(30.0)[0], spherical_cap(30.0)[1]), "mm large, allowed are 10 to 4000 mm"),
    # a triangle that is there twice, closed at its edges, touches two others at two corners
    (
        lambda: (
            np.array([[1.0, 0, 0], [0, 1, 0], [10, 0, 0], [0, 0, 0], [0, 2, 0]]),
            np.array([[1, 2, 3], [1, 2, 3], [0, 4, 1], [0, 4, 2]]),
        ),
        "has 2 parts that share corners only",
    ),
    (lambda: (np.full((3, 3), np.nan), np.array([[0, 1, 2]])), "vertices must be finite numbers"),
    (lambda: (np.eye(3), np.array([[0, 1, 3]])), "corners that it does not hold"),
    (lambda: (np.eye(3), np.array([[0.0, 1.0, 2.0]])), "triangles must be whole numbers"),
    (lambda: (np.eye(3)[:, :2], np.array([[0, 1, 2]])), "vertices must be finite numbers"),
]


@pytest.mark.parametrize(("mesh", "problem"), BROKEN, ids=[problem for _, problem in BROKEN])
def test_what_is_no_disk_is_refused_in_one_line(mesh: Callable[[], Mesh], problem: str) -> None:
    with pytest.raises(TargetError) as caught:
        TargetSurface.of_triangles(*mesh(), name="thing.obj")
    assert problem in str(caught.value) and str(caught.value).startswith("thing.obj: ")
    assert "\n" not in str(caught.value)


@given(
    arrays(float, st.tuples(st.integers(3, 8), st.just(3)), elements=st.floats(-50.0, 50.0, width=16)),
    st.data(),
)
@settings(max_examples=40)
def test_random_triangles_give_a_target_or_one_line(vertices: Floats, data: st.DataObject) -> None:
    corner = st.integers(0, len(vertices) - 1)
    triangles = data.draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=8))
    try:
        target = TargetSurface.of_triangles(vertices, np.array(triangles))
    except Error as error:
        assert isinstance(error, TargetError) and "\n" not in str(error)
    else:
        assert np.isfinite(target.disk.vertices).all() and target.diameter_mm >= 10.0


@pytest.mark.parametrize("ending", [".obj", ".stl", ".ply"])
def test_files_in_three_formats_give_the_same_target(ending: str, tmp_path: Path) -> None:
    vertices, triangles = spherical_cap(35.0, rings=23)
    path = tmp_path / f"cap{ending}"
    trimesh.Trimesh(vertices / 10.0, triangles, process=False).export(path)
    target = load_target(path, unit="cm")
    expected = TargetSurface.of_triangles(vertices, triangles)
    assert target.diameter_mm == pytest.approx(expected.diameter_mm, rel=1e-5)
    assert len(target.disk.vertices) == len(expected.disk.vertices)
    assert np.sort(target.disk.vertices[:, 2]) == pytest.approx(np.sort(expected.disk.vertices[:, 2]), abs=1e-3)


def test_the_plastic_is_on_the_convex_side_and_upright() -> None:
    vertices, triangles = spherical_cap(35.0)
    for points in (vertices, vertices * [1.0, 1.0, -1.0], vertices[:, [2, 0, 1]]):
        for corners in (triangles, triangles[:, ::-1]):
            target = TargetSurface.of_triangles(points, corners)
            heights, radius = target.disk.vertices[:, 2], np.linalg.norm(target.disk.vertices[:, :2], axis=1)
            assert heights[radius.argmin()] == pytest.approx(heights.max())
            assert target.nearest(np.array([[0.0, 0.0, 100.0]])).distance[0] > 0.0


def test_the_side_can_be_chosen_and_the_pose_is_stated() -> None:
    vertices, triangles = spherical_cap(35.0, rings=23)
    normals, other = (TargetSurface.of_triangles(vertices, triangles, side=side) for side in ("normals", "other"))
    assert normals.nearest(np.array([[0.0, 0.0, 90.0]])).distance[0] > 0.0
    # the other side up: the cap is a bowl
    heights = other.disk.vertices[:, 2]
    radius = np.linalg.norm(other.disk.vertices[:, :2], axis=1)
    assert heights[radius.argmin()] == pytest.approx(heights.min())
    moved = vertices @ other.motion.T + other.shift_mm
    assert np.sort(moved[:, 2]) == pytest.approx(np.sort(heights), abs=1e-9)
    scaled = TargetSurface.of_triangles(vertices, triangles, size_mm=250.0)
    assert scaled.diameter_mm == pytest.approx(250.0)
    moved = vertices @ scaled.motion.T + scaled.shift_mm
    assert np.sort(moved[:, 2]) == pytest.approx(np.sort(scaled.disk.vertices[:, 2]), abs=1e-9)


def test_height_fields() -> None:
    target = TargetSurface.of_formula("10*(1 - (r/60)**2)", 80.0, 60.0, "dome")
    assert np.ptp(target.disk.vertices[:, :2], axis=0) == pytest.approx([80.0, 60.0])
    x = np.linspace(-40.0, 40.0, 41)
    heights = 5.0 - 0.002 * (x[None] ** 2 + x[:, None] ** 2)
    heights[np.hypot(x[None], x[:, None]) > 38.0] = np.nan
    assert TargetSurface.of_heights(heights, x, x).diameter_mm == pytest.approx(76.0, abs=1.0)
    with pytest.raises(TargetError, match="do not fit 41 x and 40 y"):
        TargetSurface.of_heights(heights, x, x[:-1])
    with pytest.raises(TargetError, match="x and y must increase"):
        TargetSurface.of_heights(heights, x[::-1], x)
    with pytest.raises(TargetError, match="the formula has an unknown name foo"):
        TargetSurface.of_formula("foo", 80.0)
    with pytest.raises(TargetError, match="must have positive sides"):
        TargetSurface.of_formula("x", -80.0)


def test_a_coarse_target_is_divided_without_a_change_of_its_shape() -> None:
    corners = np.array([[-40.0, -40, 0], [40, -40, 5], [40, 40, 0], [-40, 40, 5]])
    target = TargetSurface.of_triangles(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    assert len(target.disk.triangles) >= 1500
    assert target.diameter_mm == pytest.approx(np.linalg.norm(corners[2] - corners[0]))


@pytest.mark.slow
def test_a_large_target_is_decimated_with_a_note() -> None:
    vertices, triangles = spherical_cap(35.0, rings=70)
    assert len(triangles) > MAX_TARGET_TRIANGLES
    target = TargetSurface.of_triangles(vertices, triangles, name="cap")
    assert len(target.disk.triangles) <= MAX_TARGET_TRIANGLES
    (note,) = target.notes
    moved = float(re.search(r"by at most (\S+) mm", note)[1])  # type: ignore[index]
    away = np.abs(target.nearest(vertices @ target.motion.T + target.shift_mm).distance)
    assert away.max() == pytest.approx(moved, rel=0.1) and moved < 0.01
