"""Turned ellipses, arcs over the edges of polygons, and splines, as outlines and as holes; edges held along a curve."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import shapely

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import polygon_area, turning_angles
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.supports import PinSet, SupportCurve
from asterism.print.needles import needles

SQUARE = [[-40.0, -40.0], [40.0, -40.0], [40.0, 40.0], [-40.0, 40.0]]
BULGES = [10.0, 0.0, -15.0, 40.0]
WAVES = [[-40.0, -40.0], [0.0, -30.0], [40.0, -40.0], [30.0, 0.0], [40.0, 40.0], [0.0, 30.0], [-40.0, 40.0]]
CURVE_MM = 0.1
MATRIX, OFFSET = np.array([[0.8, 0.1], [-0.2, 0.7], [0.3, 0.4]]), np.array([1.0, -2.0, 5.0])


def sheet(border: dict[str, Any], **rest: Any) -> Layout:
    return layout(Design.from_dict({"stars": {"length_mm": 8.0}, "border": border, **rest}))


def hole(edge: dict[str, Any]) -> np.ndarray:
    return sheet({"rectangle_mm": [240.0, 240.0], "holes": [edge]}).holes[0]


def segment(bulge: float, chord: float) -> float:
    """mm2, the area between an arc and its chord; negative if it stands in."""
    radius = (chord**2 / 4.0 + bulge**2) / (2.0 * abs(bulge))
    angle = 4.0 * np.arctan(2.0 * abs(bulge) / chord)
    return float(np.sign(bulge) * radius**2 * (angle - np.sin(angle)) / 2.0)


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("make", [lambda edge: sheet(edge).outline, hole])
def test_edges_are_arcs_whose_middles_stand_out_by_the_bulge(make: Any, order: int) -> None:
    # in reverse, the edge after the last corner of the list comes last, too
    bulges = BULGES if order == 1 else [*BULGES[2::-1], BULGES[3]]
    ring = make({"polygon_mm": SQUARE[::order], "bulge_mm": bulges})
    area = 6400.0 + sum(segment(bulge, 80.0) for bulge in BULGES if bulge)
    # pieces of chords turn by at most 4 degrees
    assert abs(polygon_area(ring)) == pytest.approx(area, rel=1e-3)
    apexes = [[0.0, -50.0], [40.0, 0.0], [0.0, 25.0], [-80.0, 0.0]]
    edge = shapely.LinearRing(ring)
    assert shapely.distance(edge, shapely.points([*SQUARE, *apexes])).max() < CURVE_MM
    left = ring[ring[:, 0] < -40.0 - 1e-9]
    np.testing.assert_allclose(np.hypot(left[:, 0] + 40.0, left[:, 1]), 40.0)


def test_bulges_of_zero_leave_the_polygon_as_it_is() -> None:
    plain = sheet({"polygon_mm": SQUARE}).outline
    np.testing.assert_array_equal(sheet({"polygon_mm": SQUARE, "bulge_mm": [0.0] * 4}).outline, plain)


def test_an_outline_is_a_smooth_curve_through_its_points() -> None:
    ring, of_hole = sheet({"spline_mm": WAVES}).outline, hole({"spline_mm": WAVES})
    assert {tuple(point) for point in WAVES} <= {tuple(point) for point in ring.tolist()}
    assert np.abs(turning_angles(ring)).max() < np.radians(5.0)
    backwards = sheet({"spline_mm": WAVES[::-1]}).outline
    for other, within in ((backwards, 1e-9), (of_hole, CURVE_MM)):
        assert shapely.hausdorff_distance(shapely.LinearRing(ring), shapely.LinearRing(other)) < within


def test_a_spline_through_points_of_a_circle_is_nearly_the_circle() -> None:
    turn = 2.0 * np.pi * np.arange(16) / 16
    ring = sheet({"spline_mm": (60.0 * np.column_stack([np.cos(turn), np.sin(turn)])).tolist()}).outline
    # the spline of a circle has an error of order four: (pi / 8)^4 / 384
    np.testing.assert_allclose(np.hypot(*ring.T), 60.0, rtol=1e-4)


@pytest.mark.parametrize("turn", [0.0, 30.0, -90.0])
def test_ellipses_are_turned_alike_as_outline_hole_and_rod(turn: float) -> None:
    circle = {"centre": [5.0, -3.0], "radius": [70.0, 40.0], "turn_deg": turn}
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    rod = layout(Design.from_dict({"rods": {"draw": [{"circle_mm": circle}]}, "border": {"rectangle_mm": [240, 240]}}))
    for ring in (sheet({"circle_mm": circle}).outline, hole({"circle_mm": circle}), rod.graph.rods[0].points[:-1]):
        x, y = ((ring - circle["centre"]) @ [[c, -s], [s, c]] / [70.0, 40.0]).T
        np.testing.assert_allclose(np.hypot(x, y), 1.0)
        count = len(ring)
        assert 70.0 * (1.0 - np.cos(np.pi / count)) < CURVE_MM
        area = 0.5 * count * np.sin(2.0 * np.pi / count) * 70.0 * 40.0
        assert abs(polygon_area(ring)) == pytest.approx(area)


def test_pins_count_the_given_corners_and_hold_whole_arcs() -> None:
    border = {"polygon_mm": SQUARE, "bulge_mm": BULGES}
    plan = sheet(border, pins=[{"edges": [3], "scale": 0.9}, {"corners": [2, 1], "scale": 0.9}])
    assert plan.pins[1].points.tolist() == [[40.0, 40.0], [40.0, -40.0]]
    held = np.array([end for ends in plan.pins[0].segments(plan.edges) for end in ends])
    np.testing.assert_allclose(np.hypot(held[:, 0] + 40.0, held[:, 1]), 40.0)
    length = sum(np.linalg.norm(b - a) for a, b in plan.pins[0].segments(plan.edges))
    assert length == pytest.approx(40.0 * np.pi, rel=1e-3)
    assert len(plan.pins[0].chains(plan.edges)) == 1
    # needles at equal distances along the arc, as along a circle
    places = np.array([needle.printed for needle in needles(plan, 10.0)[:14]])
    step = np.linalg.norm(np.diff(places, axis=0), axis=1)
    np.testing.assert_allclose(step, step[0], rtol=2e-3)
    holes = [{"circle_mm": {"centre": [x, 0.0], "radius": 4.0}} for x in (-8.0, 8.0)]
    for number in range(4):
        with pytest.raises(DesignError, match=rf"pins\[1\] = 'edge {number}': must not hold what pins\[0\] holds"):
            sheet(border, pins=[{"where": "border"}, {"edges": [number]}])
    with pytest.raises(DesignError, match=r"pins\[1\] = 'hole 1': must not"):
        sheet({**border, "holes": holes}, pins=[{"holes": [0, 1]}, {"holes": [1]}])
    with pytest.raises(DesignError, match=r"pins\[1\] = 'the whole outline': must not"):
        sheet({"circle_mm": {"radius": 60.0}}, pins=[{"where": "border"}, {"where": "border", "scale": 0.9}])
    smooth = sheet({"spline_mm": WAVES}, pins=[{"where": "corners"}])
    assert sorted(smooth.pins[0].points.tolist()) == sorted(WAVES)


@pytest.mark.parametrize("border", [{"spline_mm": WAVES}, {"polygon_mm": WAVES, "bulge_mm": [0.0, 4.0] + [-3.0] * 5}])
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("edges", [None, [1, 2]])
def test_affine_places_of_the_given_corners_hold_the_affine_image_of_the_curve(
    border: dict[str, Any], order: int, edges: list[int] | None
) -> None:
    corners = np.array(WAVES)
    border = {key: values[::order] for key, values in border.items()}
    which = list(range(7)) if edges is None else [1, 2, 3]
    where: dict[str, Any] = {"where": "border"} if edges is None else {"edges": edges}
    plan = sheet(border, pins=[where | {"target_mm": (corners[which] @ MATRIX.T + OFFSET).tolist()}])
    middles = np.array([0.5 * (a + b) for a, b in plan.pins[0].segments(plan.edges)])
    np.testing.assert_allclose(plan.pins[0].places(middles), middles @ MATRIX.T + OFFSET, atol=1e-9)


def test_places_of_the_corners_are_kept_where_kinks_and_curves_meet() -> None:
    heights = [0.0, 3.0, 1.0, 6.0]
    target = [[0.8 * x, 0.8 * y, z] for (x, y), z in zip(SQUARE, heights, strict=True)]
    curve = sheet({"polygon_mm": SQUARE, "bulge_mm": BULGES}, pins=[{"where": "border", "target_mm": target}]).pins[0]
    np.testing.assert_allclose(curve.places(np.array(SQUARE)), target, atol=1e-9)


def test_one_arc_held_at_its_ends_stands_out_as_a_similar_arc() -> None:
    """Its corners are on a line, from which no affine image can be told."""
    ends = [[-0.9 * 40.0, -40.0, 0.0], [0.9 * 40.0, -40.0, 7.0]]
    found = sheet({"polygon_mm": SQUARE, "bulge_mm": BULGES}, pins=[{"edges": [0], "target_mm": ends}]).support_samples
    scale = np.hypot(72.0, 7.0) / 80.0
    x, y = found.printed.T
    similar = np.column_stack([0.9 * x, -40.0 + scale * (y + 40.0), 7.0 * (x / 80.0 + 0.5)])
    assert np.abs(found.places - similar).max() < 1e-9


def corners_on_circle(count: int) -> np.ndarray:
    turn = 2.0 * np.pi * np.arange(count) / count
    return 50.0 * np.column_stack([np.cos(turn), np.sin(turn)])


def wave(points: np.ndarray) -> np.ndarray:
    """(n, 3) places that rise and fall three times around."""
    turn = np.arctan2(points[:, 1], points[:, 0])
    return np.column_stack([0.8 * points, 6.0 * np.cos(3.0 * turn)])


def pins_on(corners: np.ndarray, **table: Any) -> PinSet:
    data = {"stars": {"length_mm": 10}, "border": {"polygon_mm": corners.tolist()}, "pins": [table]}
    return layout(Design.from_dict(data)).pins[0]


@pytest.mark.parametrize("count", [4, 6, 40])
@pytest.mark.parametrize("edges", [None, [1, 2], [3]])
def test_affine_places_give_the_affine_image_of_the_edges(count: int, edges: list[int] | None) -> None:
    corners = corners_on_circle(count)
    places = corners @ MATRIX.T + OFFSET
    which = list(range(count)) if edges is None else [*edges, (edges[-1] + 1) % count]
    where: dict[str, Any] = {"where": "border"} if edges is None else {"edges": edges}
    held = pins_on(corners, target_mm=places[which].tolist(), **where)
    assert held.curve is not None
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))[list(held.edges)]
    np.testing.assert_allclose(held.places(middles), middles @ MATRIX.T + OFFSET, atol=1e-9)
    assert np.abs(held.curve.shift(middles, middles, np.ones_like(middles))).max() < 1e-9


def test_places_between_corners_converge_with_order_four() -> None:
    errors = []
    for count in (24, 48):
        corners = corners_on_circle(count)
        curve = pins_on(corners, where="border", target_mm=wave(corners).tolist()).curve
        assert curve is not None
        middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
        errors.append(np.abs(curve.places(middles) - wave(middles)).max())
    assert errors[0] < 0.1 and np.log2(errors[0] / errors[1]) > 3.5


def test_derivatives_are_the_limit_of_differences_in_both_senses() -> None:
    corners = corners_on_circle(30)
    curve = SupportCurve.through(corners, np.column_stack([0.7 * corners, corners[:, 0] ** 2 / 50.0]))
    start, end = corners[7], corners[8]
    tangent = (end - start) / np.linalg.norm(end - start)
    points = 0.5 * (start + end) + np.array([[-1e-3], [0.0], [1e-3]]) * tangent
    value, first, second = curve.shift(points, points, np.tile(tangent, (3, 1)))[1]
    before, here, after = curve.shift(points, points, np.tile(tangent, (3, 1)))[:, 0]
    np.testing.assert_allclose(value, here)
    np.testing.assert_allclose(first, (after - before) / 2e-3, atol=1e-7)
    np.testing.assert_allclose(second, (after - 2.0 * here + before) / 1e-6, atol=1e-6)
    backwards = curve.shift(points, points, np.tile(-tangent, (3, 1)))[1]
    np.testing.assert_allclose(backwards, [value, -first, second])


@pytest.mark.parametrize("first", [0, 1])
def test_the_curve_has_kinks_at_sharp_corners_only(first: int) -> None:
    """A square with corners on its sides, whose sides are parabolas in space; it begins at a corner or on a side."""
    side = np.linspace(-1.0, 1.0, 5)[:-1]
    one = np.column_stack([side, -np.ones(4)])
    corners = 40.0 * np.concatenate([one @ np.linalg.matrix_power([[0, 1], [-1, 0]], k) for k in range(4)])
    corners = np.roll(corners, -first, axis=0)

    def rise(points: np.ndarray) -> np.ndarray:
        return np.column_stack([points, 10.0 * (1.0 - np.abs(points).min(axis=1) ** 2 / 1600.0)])

    held = pins_on(corners, where="border", target_mm=rise(corners).tolist())
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    np.testing.assert_allclose(held.places(middles), rise(middles), atol=1e-9)
    assert held.curve is not None and len(held.curve.shifts) == 4


@pytest.mark.parametrize(
    ("table", "problem"),
    [
        ({"where": "border", "target_mm": [[k, 0, 0] for k in range(3)]}, "must have 4 places, one for each corner"),
        ({"edges": [0, 1], "target_mm": [[k, 0, 0] for k in range(2)]}, "must have 3 places, one for each corner"),
        ({"edges": [0, 2], "target_mm": [[k, 0, 0] for k in range(3)]}, r"edges\[1\] = 2: with target_mm, must be 1"),
        ({"edges": [3, 0], "scale": 0.8, "target_mm": [[k, 0, 0] for k in range(3)]}, "stands alone, without scale"),
    ],
)
def test_bad_curves_are_named(table: dict[str, Any], problem: str) -> None:
    with pytest.raises(DesignError, match=problem):
        pins_on(corners_on_circle(4), **table)
