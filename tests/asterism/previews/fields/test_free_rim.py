"""Free rims lie as low as the arms' tips and go on with their slope; held ones do not turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.bumps import corrugation_heights
from asterism.previews.fields.free_rim import free_normals, rim_curvature, stars_share
from asterism.previews.fields.star_values import star_values
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.session import Preview
from asterism.previews.sheet import StarShares
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


def test_bare_fabric_turns_across_the_rim_by_the_bumps_beside_it() -> None:
    share = np.array([1.0, 0.6, 0.0])
    weights = sp.csr_matrix(share[:, None] * np.eye(1, COUNT))
    normals = np.tile([0.6, 0.8], (3, 1))
    border = np.array([0.0, 0.05, 0.01])
    found = rim_curvature(weights, VALUES, normals, border)
    # the plain law: one wave, 1 on the star
    wave = plain_law().waves(np.vstack([np.zeros((1, 2)), 10.0 * np.asarray(TUBE.lattice.arm_directions)]))[:, 0]
    top = (0.1 + 0.5 * VALUES.value["kappa"][0]) * 10.0
    slope = 2.0 * top * (1.0 - wave[1:].mean() / wave[0]) / 10.0
    assert found[1] == pytest.approx(0.05 * slope * np.array([0.36, 0.64, 0.48]))
    assert found[[0, 2]] == pytest.approx(0.0)  # among stars, and far from all of them


@pytest.mark.parametrize("half_width", [30.0, 34.0])
def test_the_rim_turns_by_one_slope_however_wide_it_is(half_width: float) -> None:
    """The decrease of the share across the rim adds up to the share inside less that at the side."""
    data = TUBE.to_dict() | {"border": {"rectangle_mm": [2.0 * half_width, 240.0]}, "pins": []}
    design = Design.from_dict(data)
    plan = layout(design)
    across = np.linspace(0.0, half_width, 401)
    points = np.column_stack([across, np.full(401, 3.0)])
    shares = StarShares.at(points, design, plan, PREVIEW_MODEL)
    length = np.full(len(plan.centres), 8.0)
    share = stars_share(shares.shares(length))
    near = shares.rim_normals[:, 0] > 0.5
    turned = np.trapezoid(shares.border(length)[near], across[near])
    assert turned == pytest.approx(share[near][0] - share[-1], abs=0.02)
    assert turned > 0.8


def test_the_bare_rim_lies_as_low_as_the_tips() -> None:
    weights = sp.csr_matrix(np.array([[0.2], [1e-9]]) * np.eye(1, COUNT))
    kappa = VALUES.value["kappa"][0]
    waves, curvature = np.zeros((2, len(plain_law().waves))), np.full(2, kappa)
    nearest = np.zeros(2, dtype=np.int64)
    heights = corrugation_heights(waves, VALUES, weights, curvature, nearest, SPACING)
    tip = VALUES.tip_heights[0] @ np.array([1.0, kappa])
    assert tip < 0.0
    assert heights == pytest.approx([0.8 * tip, tip])  # far from all stars too


@pytest.mark.parametrize("pins", [[], [{"where": "border", "scale": 0.78}]])
def test_rims_of_free_sheets_turn_down_and_those_of_held_ones_stay(
    pins: list[dict[str, object]],
) -> None:
    design = rectangle(pins)
    plan = layout(design)
    # a little inside of each side, in its middle
    middle = 0.97 * 0.5 * (plan.outline + np.roll(plan.outline, -1, axis=0))

    def tilt(model: PreviewModel) -> np.ndarray:
        normals = Preview(design, plain_law(), model=model).at(np.vstack([0.6 * middle, middle])).surface.normals
        inner, outer = np.split(normals, 2)
        return np.asarray(np.degrees(np.arccos((inner * outer).sum(axis=1))))

    curled, straight = tilt(PREVIEW_MODEL), tilt(replace(PREVIEW_MODEL, has_rim_turn=False))
    if pins:
        assert curled == pytest.approx(straight)
    else:
        assert (curled - straight).mean() > 2.0


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
