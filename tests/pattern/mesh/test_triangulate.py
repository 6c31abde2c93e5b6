"""The guarded triangulation: a sound mesh or one line, never the end of the process."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import triangle_angles, triangle_areas
from asterism.pattern.mesh.triangulate import triangulate

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
def test_refused(points, segments, line):
    with pytest.raises(MeshError, match=line) as caught:
        triangulate(points, segments)
    assert "\n" not in str(caught.value)


NOT_WITHIN = [[2, 2], [0, 0], [0.5, 0], [0.5, 0.5], [np.nan, 0.5]]


@pytest.mark.parametrize("options", [{"max_area": 1e-12}, {"max_area": 1e-300}, *({"holes": [p]} for p in NOT_WITHIN)])
def test_refused_options(options):
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
