"""Targets: checks with one line each, side and pose, files of surfaces, of heights and of Rhino."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from asterism import Error, TargetSurface, load_target
from asterism.equilibrium.arrays import Floats
from asterism.fitting.disk import TargetError, disk_of, height_mesh
from asterism.fitting.target import MAX_TARGET_TRIANGLES
from tests.asterism.fitting.surfaces import Mesh, bow_tie, dome, spherical_cap

FIVE = np.array([[1.0, 0, 0], [0, 1, 0], [10, 0, 0], [0, 0, 0], [0, 2, 0]])
BROKEN: list[tuple[Callable[[], Mesh], str]] = [
    (bow_tie, "the border touches itself at"),
    (lambda: (np.zeros((3, 3)), np.array([[0, 1, 2]])), "holds no triangles"),
    (lambda: (np.array([[0.0, 0, 0], [50, 0, 0], [100, 0, 0]]), np.array([[0, 1, 2]])), "have no area"),
    # a triangle that is there twice, closed at its edges, touches two others at two corners
    (lambda: (FIVE, np.array([[1, 2, 3], [1, 2, 3], [0, 4, 1], [0, 4, 2]])), "has 2 parts that share corners only"),
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


@given(arrays(float, st.tuples(st.integers(3, 8), st.just(3)), elements=st.floats(-50.0, 50.0, width=16)), st.data())
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


WIDTH, RISE = 90.0, 12.0


def vault(points: int) -> Floats:
    """Heights of 0 to 1 over a square, higher at the upper left: row 0 is the upper one."""
    x = np.linspace(-1.0, 1.0, points)
    return np.asarray((1.0 - x[None] ** 2) * (1.0 - x[:, None] ** 2) * (1.0 - 0.2 * x[None] - 0.1 * x[:, None]) / 1.1)


def height_at(target: Any, x: float, y: float) -> float:
    """Height of a target, in the coordinates of its file, over a place."""
    places = (target.disk.vertices - target.shift_mm) @ target.motion
    return float(places[np.hypot(places[:, 0] - x, places[:, 1] - y).argmin(), 2])


@pytest.mark.parametrize(("bits", "steps"), [(8, 255), (16, 65535)])
def test_a_picture_gives_heights(bits: int, steps: int, tmp_path: Path) -> None:
    levels = np.round(steps * vault(91))
    Image.fromarray(levels.astype(np.uint8 if bits == 8 else np.uint16)).save(tmp_path / "vault.png")
    target = load_target(tmp_path / "vault.png", heights_mm=(0.0, RISE), extent_mm=WIDTH)
    assert target.notes == ()
    # the upper left is at negative x and positive y
    expected = RISE * float(vault(91)[20, 30])
    assert height_at(target, -45.0 + 30.0, 45.0 - 20.0) == pytest.approx(expected, abs=RISE / steps)
    lower = load_target(tmp_path / "vault.png", heights_mm=(RISE, 0.0), extent_mm=WIDTH)
    assert height_at(lower, -15.0, 25.0) == pytest.approx(RISE - expected, abs=RISE / steps)


def test_options_of_other_types_are_refused_in_one_line(tmp_path: Path) -> None:
    Image.fromarray((255 * vault(21)).astype(np.uint8)).save(tmp_path / "vault.png")
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"heights_mm": 12.0, "extent_mm": 90.0}, "heights_mm = 12.0: must be two numbers of mm"),
        ({"heights_mm": (0.0, np.nan), "extent_mm": 90.0}, "must be two numbers of mm"),
        ({"heights_mm": (0.0, 12.0), "extent_mm": "wide"}, "extent_mm = 'wide': must be a number of mm above 0"),
        ({"heights_mm": (0.0, 12.0), "extent_mm": 90.0, "size_mm": "big"}, "size_mm = 'big': must be a number of mm"),
        ({"unit": "feet"}, "unit = 'feet': must be mm"),
    ]
    for options, problem in wrong:
        with pytest.raises(TargetError, match=re.escape(problem)):
            load_target(tmp_path / "vault.png", **options)


def test_arrays_and_tables_give_the_same_target(tmp_path: Path) -> None:
    heights = RISE * vault(61)
    heights[:8, :8] = np.nan
    np.save(tmp_path / "vault.npy", heights)
    rows = [";".join("" if np.isnan(value) else repr(float(value)) for value in row) for row in heights]
    (tmp_path / "vault.csv").write_text("\n".join(rows) + "\n")
    array, table = (load_target(tmp_path / f"vault.{ending}", extent_mm=WIDTH) for ending in ("npy", "csv"))
    assert array.disk.vertices == pytest.approx(table.disk.vertices)
    assert (array.disk.triangles == table.disk.triangles).all()
    in_cm = load_target(tmp_path / "vault.npy", unit="cm", extent_mm=WIDTH, size_mm=100.0)
    assert in_cm.diameter_mm == pytest.approx(100.0, rel=1e-3)
    side = load_target(tmp_path / "vault.npy", extent_mm=WIDTH, side="other")
    assert height_at(side, 0.0, 0.0) == pytest.approx(height_at(array, 0.0, 0.0))
    assert side.nearest(np.array([[0.0, 0.0, 90.0]])).distance[0] > 0.0


def test_a_fine_picture_is_averaged_and_transparent_parts_are_left_out(tmp_path: Path) -> None:
    levels = np.round(255 * vault(300)).astype(np.uint8)
    x = np.linspace(-1.0, 1.0, 300)
    opacity = np.where(np.hypot(x[None], x[:, None]) < 0.9, 255, 0).astype(np.uint8)
    Image.fromarray(np.dstack([levels, levels, levels, opacity])).save(tmp_path / "round.png")
    target = load_target(tmp_path / "round.png", heights_mm=(0.0, RISE), extent_mm=WIDTH)
    assert target.notes == ("300 x 300 values are averaged over 3 x 3",)
    places = (target.disk.vertices - target.shift_mm) @ target.motion
    assert np.ptp(places[:, :2], axis=0) == pytest.approx(0.9 * WIDTH, abs=1.0)
    # steps of 8 bits are averaged away
    assert height_at(target, 0.0, 0.0) == pytest.approx(RISE / 1.1, abs=0.05)


def nurbs_vault(rhino3dm: Any) -> Any:
    """A surface over a square of 10 units, with its highest point in the middle."""
    surface = rhino3dm.NurbsSurface.Create(3, False, 3, 3, 5, 5)
    for i in range(5):
        for j in range(5):
            height = 1.2 * (1.0 - (0.5 * i - 1.0) ** 2) * (1.0 - (0.5 * j - 1.0) ** 2)
            surface.Points[(i, j)] = rhino3dm.Point4d(2.5 * i, 2.5 * j, height, 1.0)
    surface.KnotsU.CreateUniformKnots(1.0)
    surface.KnotsV.CreateUniformKnots(1.0)
    return surface


def rhino_file(path: Path, unit: str = "Centimeters", **things: Any) -> Path:
    file = rhino3dm.File3dm()
    file.Settings.ModelUnitSystem = getattr(rhino3dm.UnitSystem, unit)
    for kind, thing in things.items():
        getattr(file.Objects, f"Add{kind}")(thing)
    file.Write(str(path), 8)
    return path


@pytest.mark.parametrize("kind", ["Surface", "Brep"])
def test_a_nurbs_surface_is_sampled_in_the_unit_of_its_file(kind: str, tmp_path: Path) -> None:
    surface = nurbs_vault(rhino3dm)
    thing = surface if kind == "Surface" else rhino3dm.Brep.CreateFromSurface(surface)
    path = rhino_file(tmp_path / "vault.3dm", **{kind: thing})
    target = load_target(path)
    assert target.diameter_mm == pytest.approx(100.0 * np.sqrt(2.0))
    interval = surface.Domain(0)
    middle = surface.PointAt(0.5 * (interval.T0 + interval.T1), 0.5 * (interval.T0 + interval.T1))
    top = 10.0 * np.array([middle.X, middle.Y, middle.Z])
    assert target.nearest((target.motion @ top + target.shift_mm)[None]).distance[0] == pytest.approx(0.0, abs=0.01)
    assert load_target(path, unit="mm").diameter_mm == pytest.approx(10.0 * np.sqrt(2.0))


def test_a_mesh_of_rhino_is_taken_as_it_is(tmp_path: Path) -> None:
    mesh = rhino3dm.Mesh()
    vertices, triangles = dome(points=31)
    for place in vertices.tolist():
        mesh.Vertices.Add(*place)
    for corners in triangles.tolist():
        mesh.Faces.AddFace(*corners)
    target = load_target(rhino_file(tmp_path / "dome.3dm", "Millimeters", Mesh=mesh))
    assert target.diameter_mm == pytest.approx(80.0 * np.sqrt(2.0), rel=1e-6)


def test_files_of_rhino_without_a_surface_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    start, end = rhino3dm.Point3d(0, 0, 0), rhino3dm.Point3d(9, 9, 9)
    box, vault = rhino3dm.Box(rhino3dm.BoundingBox(0, 0, 0, 9, 9, 9)), nurbs_vault(rhino3dm)

    def refuse(path: Path, problem: str) -> None:
        with pytest.raises(TargetError, match=problem) as caught:
            load_target(path)
        assert "\n" not in str(caught.value)

    for things, problem in (
        ({}, "holds no visible surface or mesh, nothing"),
        ({"Curve": rhino3dm.LineCurve(start, end)}, "no visible surface or mesh, only LineCurve"),
        ({"Brep": rhino3dm.Sphere(start, 5.0).ToBrep()}, "is closed"),
        ({"Brep": rhino3dm.Brep.CreateFromBox(box)}, "without its render mesh"),
        ({"unit": "LightYears", "Surface": vault}, "its unit is LightYears"),
    ):
        refuse(rhino_file(tmp_path / "a.3dm", **things), problem)
    assert load_target(tmp_path / "a.3dm", unit="cm").diameter_mm == pytest.approx(100.0 * np.sqrt(2.0))
    whole = rhino_file(tmp_path / "whole.3dm", Surface=vault).read_bytes()
    for content in (whole[: len(whole) // 3], b"hello", b""):
        (tmp_path / "a.3dm").write_bytes(content)
        refuse(tmp_path / "a.3dm", "cannot be read as 3DM")
    refuse(tmp_path / "missing.3dm", "is not there")
    monkeypatch.setitem(sys.modules, "rhino3dm", None)
    refuse(tmp_path / "whole.3dm", r'needs rhino3dm: pip install "asterism-fabric\[cad\]"')


def test_a_few_triangles_without_area_are_left_out_with_a_word(tmp_path: Path) -> None:
    """Inside, at the border, and one whose long edge belongs to another one."""
    vertices, triangles = (part.tolist() for part in dome(points=9))
    for number, share in ((40, 0.5), (0, 0.3), (90, 0.4), (len(triangles) + 4, 0.5)):
        a, b, c = triangles[number]
        vertices.append(((1.0 - share) * np.array(vertices[a]) + share * np.array(vertices[b])).tolist())
        middle = len(vertices) - 1
        triangles[number] = [middle, b, c]
        triangles += [[a, middle, c], [a, b, middle]]
    trimesh.Trimesh(vertices, triangles, process=False).export(tmp_path / "dome.obj", digits=12)
    target, whole = load_target(tmp_path / "dome.obj"), TargetSurface.of_triangles(*dome(points=9))
    assert target.notes == ("4 triangles without area: left out",)
    assert len(disk_of(np.array(vertices), np.array(triangles), "dome").triangles) == 128 + 7
    area, expected = (trimesh.Trimesh(one.disk.vertices, one.disk.triangles).area for one in (target, whole))
    assert area == pytest.approx(expected, rel=1e-9)


def test_corners_that_nearly_coincide_are_welded(tmp_path: Path) -> None:
    """Also where a grid of places would part them."""
    vertices, triangles = dome(points=9)
    soup, numbers = vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    moved = soup + np.random.default_rng(0).uniform(-5e-6, 5e-6, soup.shape)
    trimesh.Trimesh(moved, numbers, process=False).export(tmp_path / "soup.obj")
    welded, whole = load_target(tmp_path / "soup.obj"), TargetSurface.of_triangles(soup, numbers)
    assert np.array_equal(welded.disk.triangles, whole.disk.triangles)
    assert np.allclose(welded.disk.vertices, whole.disk.vertices, atol=1e-4)


def test_a_round_border_has_no_steps() -> None:
    x = np.linspace(-40.0, 40.0, 41)
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
