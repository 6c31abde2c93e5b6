"""Free sides of a sheet, and the bare rim, which lies as low as the tips of the arms."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.fields.rim_arms import free_normals
from asterism.previews.fields.star_values import star_values
from asterism.previews.star_lens import corrugation_heights
from tests.asterism.previews.laws import SPACING, plain_law

TUBE = gallery.load("tube")
PLAN = layout(TUBE)
VALUES = star_values(TUBE, PLAN, plain_law())
COUNT = len(PLAN.centres)


def rectangle(pins: list[dict[str, object]]) -> Design:
    data = TUBE.to_dict() | {"border": {"rectangle_mm": [80.0, 60.0]}, "pins": pins}
    return Design.from_dict(data)


def test_normals_are_those_of_the_nearest_side_and_vanish_where_it_is_held() -> None:
    places = np.array([[35.0, 0.0], [-35.0, 2.0], [0.0, 25.0], [3.0, -25.0]])
    free = layout(rectangle([]))
    expected = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    assert free_normals(free, places) == pytest.approx(expected)
    middle = 0.5 * (free.outline + np.roll(free.outline, -1, axis=0))
    held = int(middle[:, 0].argmax())
    plan = layout(rectangle([{"edges": [held], "scale": 0.8}]))
    assert free_normals(plan, places) == pytest.approx(expected * np.array([[0.0], [1.0], [1.0], [1.0]]))
    # points on the right side and near the lower one
    pulled = layout(rectangle([{"points_mm": [[40.0, 5.0], [10.0, -28.0]], "scale": 0.8}]))
    assert free_normals(pulled, places) == pytest.approx(expected * np.array([[0.0], [1.0], [1.0], [0.0]]))
    sliding = layout(rectangle([{"points_mm": [[40.0, 5.0], [10.0, -28.0]], "slide": "plane"}]))
    assert free_normals(sliding, places) == pytest.approx(expected)
    alone = layout(rectangle([{"points_mm": [[40.0, 25.0]], "scale": 0.8}]))
    assert free_normals(alone, places) == pytest.approx(expected)


def test_the_bare_rim_lies_as_low_as_the_tips() -> None:
    weights = sp.csr_matrix(np.array([[0.2], [1e-9]]) * np.eye(1, COUNT))
    kappa = VALUES.value["kappa"][0]
    waves, curvature = np.zeros((2, len(plain_law().waves))), np.full(2, kappa)
    nearest = np.zeros(2, dtype=np.int64)
    heights = corrugation_heights(waves, VALUES, weights, curvature, nearest, SPACING)
    tip = VALUES.tip_heights[0] @ np.array([1.0, kappa])
    assert tip < 0.0
    assert heights == pytest.approx([0.8 * tip, tip])  # far from all stars too


def test_outlines_of_many_corners_are_asked_in_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the size of the tables, the answers are the same."""
    held = Design.from_dict(TUBE.to_dict() | {"pins": [{"edges": [0, 1]}, {"corners": [3], "scale": 0.9}]})
    plan = layout(held)
    points = np.random.default_rng(2).uniform(-60.0, 60.0, (300, 2))
    whole = free_normals(plan, points), plan.distance_to_supports(points)
    monkeypatch.setattr("asterism.pattern.geometry.planar.MAX_TABLE_ENTRIES", 100)
    np.testing.assert_array_equal(free_normals(plan, points), whole[0])
    np.testing.assert_array_equal(plan.distance_to_supports(points), whole[1])
    assert len(plan.distance_to_supports(points[:0])) == 0 and np.isinf(PLAN.distance_to_supports(points)).all()


def test_a_side_in_pieces_is_one_side() -> None:
    """Held at a corner it keeps no curl along its whole length, however many corners lie on it."""
    corners = PLAN.outline
    pieces = np.concatenate(
        [np.linspace(a, b, 5)[:-1] for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)]
    )
    points = np.random.default_rng(3).uniform(-60.0, 60.0, (200, 2))
    for held in (corners[:1], corners[:2], corners[::3]):
        pins = [{"points_mm": held.tolist(), "scale": 0.9}]
        one, other = (
            free_normals(
                layout(Design.from_dict(TUBE.to_dict() | {"border": {"polygon_mm": ring.tolist()}, "pins": pins})),
                points,
            )
            for ring in (corners, np.roll(pieces, 2, axis=0))
        )
        np.testing.assert_allclose(one, other, atol=1e-9)
