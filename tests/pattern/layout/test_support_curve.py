"""Edges held along a curve: affine and smooth places, sharp corners, and messages."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.supports import PinSet, SupportCurve

MATRIX, OFFSET = np.array([[0.8, 0.1], [-0.2, 0.7], [0.3, 0.4]]), np.array([1.0, -2.0, 5.0])


def ring(count: int) -> np.ndarray:
    turn = 2.0 * np.pi * np.arange(count) / count
    return 50.0 * np.column_stack([np.cos(turn), np.sin(turn)])


def wave(points: np.ndarray) -> np.ndarray:
    """(n, 3) places that rise and fall three times around."""
    turn = np.arctan2(points[:, 1], points[:, 0])
    return np.column_stack([0.8 * points, 6.0 * np.cos(3.0 * turn)])


def pins(corners: np.ndarray, **table: Any) -> PinSet:
    data = {"stars": {"length_mm": 10}, "border": {"polygon_mm": corners.tolist()}, "pins": [table]}
    return layout(Design.from_dict(data)).pins[0]


@pytest.mark.parametrize("count", [4, 6, 40])
@pytest.mark.parametrize("edges", [None, [1, 2], [3]])
def test_affine_places_give_the_affine_image_of_the_edges(count: int, edges: list[int] | None) -> None:
    corners = ring(count)
    places = corners @ MATRIX.T + OFFSET
    which = list(range(count)) if edges is None else [*edges, (edges[-1] + 1) % count]
    where: dict[str, Any] = {"where": "border"} if edges is None else {"edges": edges}
    held = pins(corners, target_mm=places[which].tolist(), **where)
    assert held.curve is not None
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))[list(held.edges)]
    np.testing.assert_allclose(held.places(middles), middles @ MATRIX.T + OFFSET, atol=1e-9)
    assert np.abs(held.curve.shift(middles, middles, np.ones_like(middles))).max() < 1e-9


def test_places_between_corners_converge_with_order_four() -> None:
    errors = []
    for count in (24, 48):
        corners = ring(count)
        curve = pins(corners, where="border", target_mm=wave(corners).tolist()).curve
        assert curve is not None
        middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
        errors.append(np.abs(curve.places(middles) - wave(middles)).max())
    assert errors[0] < 0.1 and np.log2(errors[0] / errors[1]) > 3.5


def test_derivatives_are_the_limit_of_differences_in_both_senses() -> None:
    corners = ring(30)
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

    held = pins(corners, where="border", target_mm=rise(corners).tolist())
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
        pins(ring(4), **table)
