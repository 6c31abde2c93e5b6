"""The coarse mesh: it has the sheet's area, and a point wherever the sheet is held.

The guarded triangulation: a sound mesh or one line, never the end of the process.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import cross_2d, polygon_area, triangle_angles, triangle_areas
from asterism.pattern.mesh.sheet_mesh import coarse_outline, sheet_mesh
from asterism.pattern.mesh.triangulate import triangulate
from tests.pattern.layouts import unit

HEXAGON = 67.0 * unit(30.0 + 60.0 * np.arange(6))
RECTANGLE = np.array([[-69.0, -89.0], [69.0, -89.0], [69.0, 89.0], [-69.0, 89.0]])
PLATE = np.array([[-60.0, -40.0], [60.0, -40.0], [60.0, 40.0], [-60.0, 40.0]])
L_SHAPE = np.array([[0, 0], [120, 0], [120, 40], [40, 40], [40, 120], [0, 120.0]])


def circle(count: int, radius: float = 60.0, centre: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    return np.asarray(centre) + radius * unit(360.0 * np.arange(count) / count)


HOLE = circle(60, 12.0)


@pytest.mark.parametrize("parts", [1, 2, 4])
def test_a_hexagon_has_equilateral_triangles(parts: int) -> None:
    mesh = sheet_mesh(HEXAGON, 67.0 / parts)
    assert len(mesh.triangles) == 6 * parts**2
    assert triangle_angles(mesh.points, mesh.triangles) == pytest.approx(60.0)


@pytest.mark.parametrize("border", [HEXAGON, RECTANGLE, L_SHAPE, circle(100), circle(12)], ids=list("HRLCD"))
@pytest.mark.parametrize("edge", [14.0, 30.0])
def test_the_area_is_the_sheets(border: np.ndarray, edge: float) -> None:
    mesh = sheet_mesh(border, edge)
    areas = triangle_areas(mesh.points, mesh.triangles)
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(polygon_area(border), rel=1e-12)
    assert triangle_angles(mesh.points, mesh.triangles).min() > 15.0


def test_a_circle_of_many_sides_gets_few() -> None:
    mesh = sheet_mesh(circle(300), 20.0)
    assert len(mesh.rim) < 30
    radius = np.linalg.norm(mesh.points[mesh.rim[:, 0]], axis=1)
    # half way between the chords' sagitta inside and outside
    assert np.abs(radius - 60.0).max() < 0.06 * 20.0


@pytest.mark.parametrize(
    ("border", "edge", "held", "holes"),
    [
        (RECTANGLE, 25.0, [[-66.0, 0.0], [10.0, -89.0], [69.0, 89.0], [-66.0, -86.0]], []),
        (PLATE, 14.0, [HOLE[7], 0.5 * (HOLE[20] + HOLE[21]), [-40.0, 10.0]], [HOLE]),
    ],
    ids=["inside, on a side and at a corner", "on the edge of a hole"],
)
def test_held_points_are_points_of_the_mesh(border: np.ndarray, edge: float, held: list, holes: list) -> None:
    mesh = sheet_mesh(border, edge, np.array(held), holes=holes)
    away = np.linalg.norm(np.array(held)[:, None] - mesh.points[None], axis=2).min(axis=1)
    assert away == pytest.approx(0.0, abs=1e-12)
    area = polygon_area(border) - sum(polygon_area(hole) for hole in holes)
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(area)


def test_what_is_held_ends_at_a_point_of_the_mesh() -> None:
    border = circle(100)
    mesh = sheet_mesh(border, 20.0, held_sides=[range(10, 35)])
    held = np.isin(mesh.side, range(10, 35))
    ends = mesh.rim[held].ravel()
    once = [point for point in ends if (ends == point).sum() == 1]
    assert sorted(mesh.points[once].tolist()) == sorted(border[[10, 35]].tolist())
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(polygon_area(border))


@settings(deadline=None, max_examples=12)
@given(st.integers(0, 10**6), st.floats(8.0, 40.0))
def test_any_wavy_outline(seed: int, edge: float) -> None:
    random = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 90, endpoint=False)
    radius = 60 + sum(random.uniform(-8, 8) * np.cos(k * angle + random.uniform(0, 6)) for k in (2, 3, 5))
    border = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    coarse, _ = coarse_outline(border, edge, np.array([0, 30]))
    assert polygon_area(coarse) == pytest.approx(polygon_area(border), rel=1e-9)
    assert {tuple(p) for p in border[[0, 30]]} <= {tuple(p) for p in coarse}
    mesh = sheet_mesh(border, edge)
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(polygon_area(border), rel=1e-9)


@settings(max_examples=20)
@given(st.integers(3, 40), st.floats(1.0, 25.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.booleans())
def test_holes_are_left_out_and_angles_stay_large(n: int, radius: float, x: float, y: float, turned: bool) -> None:
    hole = circle(n, radius, (x * (57.0 - radius), y * (37.0 - radius)))
    mesh = sheet_mesh(PLATE, 14.0, holes=[hole[::-1] if turned else hole])
    area = 9600.0 - polygon_area(hole)
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(area)
    assert triangle_angles(mesh.points, mesh.triangles).min() > 10.0
    assert [len(mesh.rings), polygon_area(mesh.rings[0])] == [2, pytest.approx(9600.0)]
    assert polygon_area(mesh.rings[1]) == pytest.approx(area - 9600.0)


def test_the_rim_has_the_sheet_to_its_left_and_names_its_edges() -> None:
    holes = [circle(4, 10.0, (-30.0, 0.0)), circle(60, 12.0, (30.0, 5.0))]
    mesh = sheet_mesh(PLATE, 14.0, holes=holes, held_sides=[range(8, 68)])
    assert set(mesh.side[mesh.side < 8].tolist()) == set(range(8))
    around = mesh.side >= 8
    distance = np.linalg.norm(mesh.points[mesh.rim[around]] - [30.0, 5.0], axis=-1)
    assert distance == pytest.approx(12.0, rel=0.06)
    # each rim edge belongs to one triangle, which has it in the same direction
    corners = mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    assert {*map(tuple, mesh.rim.tolist())} <= {*map(tuple, corners.tolist())}
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    assert (cross_2d(b - a, c - a) > 0.0).all()


SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
LOOP = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])


def loop(n, first=0):
    """Segments around n points."""
    number = first + np.arange(n)
    return np.column_stack([number, np.roll(number, -1)])


def around(polygon, n):
    """n points on each side of a polygon."""
    part = np.arange(n)[:, None] / n
    return np.concatenate([a + part * (b - a) for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True)])


@pytest.mark.parametrize("scale", [1e-80, 1e-3, 1.0, 1e6, 1e80])
@pytest.mark.parametrize("angle", [0, 20, 30, 33])
@pytest.mark.parametrize("area", [None, 1e-2, 1e-3])
def test_quality_at_any_scale(scale, angle, area):
    outline = scale * around(SQUARE, 20)
    largest = area and area * scale**2
    points, triangles = triangulate(outline, loop(80), min_angle_deg=angle, max_area=largest)
    assert np.array_equal(points[:80], outline)
    # beside the outline, which is not split, both bounds are missed by a little
    assert triangle_angles(points / scale, triangles).min() >= 0.9 * angle
    areas = triangle_areas(points / scale, triangles)
    assert areas.sum() == pytest.approx(1)
    if area is not None:
        assert areas.max() <= 1.1 * area


def test_segments_are_kept_whole():
    """A long segment across fine triangles stays an edge, and so does a dangling one."""
    points = np.concatenate([around(SQUARE, 10), [[0.21, 0.52], [0.83, 0.47], [0.55, 0.8]]])
    segments = np.concatenate([loop(40), [[40, 41], [41, 42]]])
    mesh, triangles = triangulate(points, segments, min_angle_deg=30, max_area=0.01)
    edges = {frozenset(e) for t in triangles.tolist() for e in ((t[0], t[1]), (t[1], t[2]), (t[2], t[0]))}
    assert {frozenset(s) for s in segments.tolist()} <= edges
    assert np.array_equal(mesh[:43], points)


def test_holes_and_islands():
    inner = 0.25 + 0.5 * SQUARE
    points, segments = np.concatenate([SQUARE, inner]), np.concatenate([LOOP, LOOP + 4])
    assert triangle_areas(*triangulate(points, segments)).sum() == pytest.approx(1)
    assert triangle_areas(*triangulate(points, segments, holes=[[0.5, 0.5]])).sum() == pytest.approx(0.75)
    apart = np.concatenate([SQUARE, SQUARE + np.array([3, 0])])
    assert triangle_areas(*triangulate(apart, segments)).sum() == pytest.approx(2)


FIVE = np.concatenate([SQUARE, [[0.5, 0.5]]])


@pytest.mark.parametrize(
    ("points", "segments", "line"),
    [
        (SQUARE[:2], LOOP, "three points"),
        (SQUARE * np.nan, LOOP, "finite"),
        (np.full((4, 2), np.inf), LOOP, "finite"),
        (SQUARE * 1e200, LOOP, "1e-100 and 1e100"),
        (SQUARE * 1e-200, LOOP, "1e-100 and 1e100"),
        (SQUARE * 0, LOOP, "1e-100 and 1e100"),
        (SQUARE * 0 + 1, LOOP, "coincide"),
        (SQUARE * 1e-9 + 1e9, LOOP, "coincide"),
        (SQUARE * [1, 0], LOOP, "same"),
        (np.linspace([0, 0], [1, 1], 4), LOOP, "one line"),
        (np.concatenate([SQUARE, SQUARE[:1]]), LOOP, "points 0 and 4 are the same"),
        (np.concatenate([SQUARE, SQUARE[:1] + 1e-10]), LOOP, "same"),
        (SQUARE, LOOP + 1, "name points 0 to 3"),
        (SQUARE, LOOP - 1, "name points 0 to 3"),
        (SQUARE, [], "three segments"),
        (SQUARE, [*LOOP.tolist(), [1, 1]], "segment 4 has no length"),
        (SQUARE, [*LOOP.tolist(), [1, 0]], "given twice"),
        (SQUARE, [*LOOP.tolist(), [0, 2], [1, 3]], "segments 4 and 5 cross"),
        (FIVE, [*LOOP.tolist(), [0, 2]], "point 4 lies on segment 4"),
        (FIVE, [*LOOP.tolist(), [0, 2], [0, 4]], "point 4 lies on segment 4"),
        (np.concatenate([SQUARE, [[0.5, 0]]]), LOOP, "point 4 lies on segment 0"),
        (np.concatenate([SQUARE, [[0.5, 1e-10]]]), LOOP, "point 4 lies on segment 0"),
        (np.concatenate([SQUARE, [[2, 2]]]), LOOP, "lie outside"),
        (np.concatenate([SQUARE, [[2, 2]]]), [*LOOP.tolist(), [2, 4]], "lie outside"),
        (SQUARE, LOOP[:3], "enclose no region"),
        (SQUARE[[0, 2, 1, 3]], LOOP, "cross"),
    ],
)
def test_bad_points_and_segments_are_refused(points, segments, line):
    with pytest.raises(MeshError, match=line) as caught:
        triangulate(points, segments)
    assert "\n" not in str(caught.value)


NOT_WITHIN = [[2, 2], [0, 0], [0.5, 0], [0.5, 0.5], [np.nan, 0.5]]


@pytest.mark.parametrize("options", [{"max_area": 1e-12}, {"max_area": 1e-300}, *({"holes": [p]} for p in NOT_WITHIN)])
def test_bad_options_are_refused(options):
    with pytest.raises(MeshError) as caught:
        triangulate(SQUARE, LOOP, **options)
    assert "\n" not in str(caught.value)


# coordinates that repeat, nearly repeat and line up
COORDINATE = st.one_of(st.integers(0, 4).map(float), st.floats(0, 4), st.integers(0, 4).map(lambda i: i + 1e-8))


@pytest.mark.slow
@settings(max_examples=60)
@given(
    st.lists(st.tuples(COORDINATE, COORDINATE), min_size=3, max_size=12),
    st.lists(st.tuples(st.integers(0, 11), st.integers(0, 11)), max_size=14),
    st.booleans(),
    st.sampled_from([None, 0, 20, 33]),
    st.sampled_from([None, 0.1, 1.0]),
    st.lists(st.tuples(COORDINATE, COORDINATE), max_size=2),
)
def test_any_input(points, segments, framed, angle, area, holes):
    """Whatever is put in, the process lives; what comes out covers what the outline encloses."""
    if framed:
        points = [(-1.0, -1.0), (5.0, -1.0), (5.0, 5.0), (-1.0, 5.0), *points]
        segments = [*LOOP.tolist(), *segments]
    try:
        mesh, triangles = triangulate(points, segments, min_angle_deg=angle, max_area=area, holes=holes)
    except MeshError as error:
        assert "\n" not in str(error)
        return
    areas = triangle_areas(mesh, triangles)
    assert areas.min() > 0
    if framed and not holes:
        assert areas.sum() == pytest.approx(36)
