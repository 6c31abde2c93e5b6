"""The rigid motions that each kind of support leaves free, and fits over these alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.pattern.design.design import Design
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.free_motions import FreeMotions, count_free_tilts, free_motions, free_rotation_axes
from asterism.pattern.layout.layout import Layout

TWO_POINTS = {"points_mm": [[-30.0, 0.0], [30.0, 0.0]]}
CORNERS = {"where": "corners"}
DOWN = (0.0, 0.0, -2.0)


def lumpy(points: np.ndarray) -> np.ndarray:
    x, y = points.T / 20.0
    return np.column_stack([points + 0.3 * np.column_stack([y**2, x * y]), 4 * x**2 + 2 * x * y + y**3 + 3 * y])


def rectangle(*pins: dict[str, Any]) -> Layout:
    border = {"rectangle_mm": [100, 60]}
    return layout(Design.from_dict({"stars": {"length_mm": 8}, "border": border, "pins": list(pins)}))


def motions(
    *pins: dict[str, Any], gravity: tuple[float, float, float] | None = None, flat: bool = False
) -> FreeMotions:
    """Of a rectangle that is lumpy wherever its supports leave it free, or flat."""
    samples = rectangle(*pins).support_samples
    places = np.column_stack([samples.printed, np.zeros(len(samples.printed))]) if flat else lumpy(samples.printed)
    return free_motions(samples, places, gravity)


KINDS = [
    ("free", [], 6),
    ("border", [{"where": "border"}], 0),
    ("corners", [CORNERS], 0),
    ("lifted corners", [{"corners": [0, 2]}, {"corners": [1, 3], "offset_mm": [0.0, 0.0, 20.0]}], 0),
    ("later step", [CORNERS | {"step": 1}], 0),
    ("three needles", [{"points_mm": [[0.0, 0.0], [30.0, 0.0], [0.0, 20.0]]}], 0),
    ("a needle turns about itself", [{"points_mm": [[3.0, 4.0]]}], 3),
    ("two needles, about their line", [TWO_POINTS], 1),
    ("two needles at two heights", [TWO_POINTS | {"target_mm": [[0.0, 0.0, 0.0], [8.0, -20.0, 35.0]]}], 1),
    ("an edge, about itself", [{"edges": [0]}], 1),
    ("two edges", [{"edges": [0, 2]}], 0),
    ("an edge, the other one slides", [{"edges": [0]}, {"edges": [2], "slide": "plane"}], 0),
    ("corners on the ground", [CORNERS | {"slide": "plane"}], 3),
    ("two points on the ground", [TWO_POINTS | {"slide": "plane"}], 4),
    ("a point on the ground", [{"points_mm": [[3.0, 4.0]], "slide": "plane"}], 5),
    ("corners on poles", [CORNERS | {"slide": "z"}], 1),
    ("two points on poles", [TWO_POINTS | {"slide": "z"}], 2),
    ("a point on a pole", [{"points_mm": [[3.0, 4.0]], "slide": "z"}], 4),
    ("a needle, corners on the ground", [{"points_mm": [[3.0, 4.0]]}, CORNERS | {"slide": "plane"}], 1),
    ("a needle, a point on a pole", [{"points_mm": [[3.0, 4.0]]}, {"points_mm": [[30.0, 4.0]], "slide": "z"}], 1),
]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "pins", "count"), KINDS, ids=[kind[0] for kind in KINDS])
def test_each_kind_of_support_leaves_its_motions(name: str, pins: list[dict[str, Any]], count: int) -> None:
    """A fit takes them out, and these alone. It is the best: small free motions from it bring the sheet no nearer."""
    free = motions(*pins)
    assert free.count == count
    rng = np.random.default_rng(3)
    sheet = lumpy(rng.uniform(-30.0, 30.0, (40, 2)))
    rotation, shift = np.eye(3), np.zeros(3)
    fit = free.fit(sheet, sheet)
    np.testing.assert_allclose(fit[0], np.eye(3), atol=1e-9)
    for _ in range(3):  # somewhere else: the motion that brings the sheet nearest to a random place
        turn = Rotation.random(rng=rng).as_matrix()
        rotation, shift = free.fit(sheet, sheet @ turn.T + rng.uniform(-20.0, 20.0, 3))
        assert np.abs(free.misses(rotation, shift)).max(initial=0.0) < 1e-8
        assert np.linalg.det(rotation) == pytest.approx(1.0)
        moved = sheet @ rotation.T + shift
        back = free.fit(sheet, moved)
        assert np.abs(sheet @ back[0].T + back[1] - moved).max() < 1e-5
    still = count == 0
    moved_by = np.abs(rotation - np.eye(3)).max() + np.abs(shift).max()
    assert moved_by == 0.0 if still else moved_by > 0.01

    turn = Rotation.from_euler("xyz", [8.0, -5.0, 12.0], degrees=True).as_matrix()
    targets = sheet @ turn.T + [1.0, -2.0, 3.0] + rng.normal(0.0, 0.5, sheet.shape)

    def square(motion: tuple[np.ndarray, np.ndarray]) -> float:
        return float(((sheet @ motion[0].T + motion[1] - targets) ** 2).sum())

    best = free.fit(sheet, targets)
    assert square(rigid_fit(sheet, targets)) - 1e-6 <= square(best) <= square((np.eye(3), np.zeros(3)))
    if count == 6:
        assert square(best) == pytest.approx(square(rigid_fit(sheet, targets)))
    if len(free.points):
        centre = free.points.mean(axis=0) @ best[0].T + best[1]
        moved = sheet @ best[0].T + best[1]
        for twist in free.basis(free.points @ best[0].T + best[1], centre).T:
            v, w = twist[:3], twist[3:] / free.size
            slope = 2.0 * ((v + np.cross(w, moved - centre)) * (moved - targets)).sum()
            assert abs(slope) < 1e-6 * square(best)


def test_equal_heights_do_not_make_poles_let_go() -> None:
    """To first order a flat sheet may tilt on poles; further on its points would leave them."""
    assert motions(CORNERS | {"slide": "z"}, flat=True).count == 1
    assert motions(TWO_POINTS | {"slide": "z"}, flat=True).count == 2


@pytest.mark.parametrize(
    ("pins", "direction", "count"),
    [
        ({"points_mm": [[3.0, 4.0]]}, DOWN, 1),  # about the plumb line
        ({"points_mm": [[3.0, 4.0]]}, (1.0, 0.0, 0.0), 1),
        (TWO_POINTS, DOWN, 0),
        (TWO_POINTS, (1.0, 0.0, 0.0), 1),  # about their line, along which gravity pulls
        ({"edges": [0]}, DOWN, 0),
        (CORNERS | {"slide": "plane"}, DOWN, 3),
        (CORNERS, DOWN, 0),
    ],
)
def test_gravity_leaves_the_turns_about_its_direction(
    pins: dict[str, Any], direction: tuple[float, float, float], count: int
) -> None:
    assert motions(pins, gravity=direction).count == count


def turns(*pins: dict[str, Any]) -> tuple[np.ndarray, int]:
    plan = rectangle(*pins)
    return free_rotation_axes(plan), count_free_tilts(plan)


@pytest.mark.parametrize("target", [[30.0, 5.0, 0.0], [30.0, 5.0, 20.0], [8.0, -20.0, 35.0]])
def test_two_points_leave_the_turn_about_the_line_through_their_places(target: list[float]) -> None:
    places = [[0.0, 0.0, 0.0], target]
    axes, tilted = turns({"points_mm": [[0.0, 0.0], [40.0, 0.0]], "target_mm": places})
    assert np.abs(axes @ target) == pytest.approx([np.linalg.norm(target)]) and tilted == 1


def test_a_point_leaves_all_turns_the_ground_the_upright_one_and_a_held_border_none() -> None:
    for pins in ([], [{"points_mm": [[3.0, 4.0]]}]):
        axes, tilted = turns(*pins)
        assert axes @ axes.T == pytest.approx(np.eye(3)) and tilted == 2
    axes, tilted = turns({"where": "corners", "slide": "plane"})
    assert np.abs(axes) == pytest.approx(np.array([[0.0, 0.0, 1.0]])) and tilted == 0
    axes, tilted = turns({"where": "border"})
    assert len(axes) == tilted == 0
