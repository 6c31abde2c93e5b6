"""A design for a wanted height or radius, a needle for a wanted point, and derivatives by the sizes of single stars."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import asterism
from asterism import Design, sensitivity, solve_for, solve_for_point
from asterism.fitting.reach import ReachError
from asterism.fitting.solve_for import POINT_TOLERANCE_MM
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import SIZE_KEYS, with_painted_stars


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "wanted", "value", "change"),
    [("tube", "roll_radius_mm", 25.0, "length_mm"), ("dome", "height_mm", 10.0, "length_mm")],
)
def test_a_fresh_preview_has_the_value(name: str, wanted: Any, value: float, change: Any) -> None:
    shape = asterism.preview(solve_for(asterism.new(name), wanted, value, change))
    reached = shape.height_mm if wanted == "height_mm" else shape.summary["roll_radius_mm"]
    assert reached == pytest.approx(value, rel=3e-3)


@pytest.mark.slow
def test_values_that_do_not_occur_are_refused_with_those_that_do() -> None:
    with pytest.raises(ReachError, match=r"height_mm = 90: is not reached by scaling length_mm; it is \d.* to \d.* mm"):
        solve_for(asterism.new("dome"), "height_mm", 90.0)


CORNERS = [[43.0, 24.8], [-43.0, 24.8], [-43.0, -24.8], [43.0, -24.8]]
PLACES = [[31.0, 18.0, 0.0], [-31.0, 18.0, 0.0], [-31.0, -18.0, 0.0], [31.0, -18.0, 0.0]]


@pytest.fixture(scope="module")
def canopy() -> Design:
    pins = [{"points_mm": CORNERS, "target_mm": PLACES}, {"points_mm": [[0.0, 0.0]], "target_mm": [[0.0, 0.0, 16.0]]}]
    return Design.from_dict({"stars": {"length_mm": 7.0}, "border": {"rings": 2}, "pins": pins})


@pytest.mark.slow
def test_a_fresh_preview_has_the_point(canopy: Design) -> None:
    lines: list[str] = []
    wanted = np.array([9.0, 0.0, 20.0])
    raised = solve_for_point(canopy, (12.0, 0.0), wanted.tolist(), needle=4, say=lines.append)
    there = asterism.preview(raised).at(np.array([[12.0, 0.0]]))[0]
    assert np.linalg.norm(there - wanted) < POINT_TOLERANCE_MM
    assert raised.pins[0].target_mm == canopy.pins[0].target_mm
    assert raised.pins[1].target_mm is not None and raised.pins[1].target_mm[0][2] > 20.0
    assert lines[0].startswith("needle 4 at (0.0, 0.0, 16.0) mm: ")


def test_a_point_that_another_needle_holds_is_refused_with_the_nearest_one(canopy: Design) -> None:
    with pytest.raises(ReachError, match=r"needle 0 cannot bring .* comes to \(.*16\.0\) mm, 2 mm away"):
        solve_for_point(canopy, (0.0, 0.0), (0.0, 0.0, 18.0), needle=0)


# a free hexagon could roll about several axes, and a small change would turn it
FREE = asterism.Design.from_dict({"stars": {"length_mm": 7.0}, "border": {"rectangle_mm": [84.0, 60.0]}})
HELD = asterism.Design.from_dict(
    {"stars": {"length_mm": 7.0}, "border": {"rings": 1}, "pins": [{"where": "border", "scale": 0.74}]}
)


def changed(design: asterism.Design, star: int, by: str, change: float) -> asterism.Design:
    plan, column = layout(design), SIZE_KEYS.index(by)
    row = np.full((1, 3), np.nan)
    row[0, column] = plan.star_sizes_mm[star, column] + change
    return with_painted_stars(design, plan.sites[star : star + 1], row)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("design", "by", "step"), [(FREE, "length_mm", 0.01), (HELD, "thickness_mm", 0.0005), (HELD, "width_mm", 0.002)]
)
def test_derivatives_are_differences_of_equilibria(design: asterism.Design, by: str, step: float):
    found = sensitivity(design, by=by)  # type: ignore[arg-type]
    assert found.value == pytest.approx(asterism.preview(design).height_mm, rel=1e-9)
    preview = asterism.Preview(design)
    for star in (0, 3):
        # one-sided: several places of a symmetric sheet are the highest
        more = preview.update(changed(design, star, by, step)).height_mm
        assert found.derivatives[star] == pytest.approx((more - found.value) / step, rel=0.02, abs=0.005)


def test_any_quantity_of_a_shape_has_derivatives():
    def middle(shape: asterism.Shape) -> np.ndarray:
        return shape.at(np.zeros((1, 2)))[0]

    found = sensitivity(HELD, of=middle)
    assert found.derivatives.shape == (7, 3) and found.stars.tolist() == list(range(7))
    more, less = (middle(asterism.preview(changed(HELD, 2, "length_mm", step))) for step in (0.02, -0.02))
    np.testing.assert_allclose(found.derivatives[2], (more - less) / 0.04, atol=2e-3)


def test_a_size_at_the_upper_end_of_the_law_is_changed_downwards():
    longest = asterism.Design.from_dict({"stars": {"length_mm": 11.0}, "border": {"rings": 1}})
    assert np.isfinite(sensitivity(longest).derivatives).all()


# a dome on a fabric without a law: its cells are solved when they are needed
UNKNOWN: dict[str, Any] = {
    "border": {"rings": 1},
    "fabric": {"stretch": 1.5},
    "pins": [{"where": "border", "scale": 0.7}],
}
SIZES = {"length_mm": 7.0, "width_mm": 1.2}


@pytest.mark.slow
def test_a_height_on_a_fabric_without_a_law() -> None:
    higher = solve_for(Design.from_dict(UNKNOWN | {"stars": SIZES}), "height_mm", 5.5)
    assert asterism.preview(higher).height_mm == pytest.approx(5.5, rel=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("by", "step", "star"),
    [
        ("length_mm", 0.05, {}),
        ("width_mm", 0.02, {}),
        ("width_mm", 0.02, {"override": [{"star": 0, "length_mm": 6.0}]}),
        ("width_mm", 0.02, {"override": [{"star": 0, "length_mm": 6.5}, {"star": 2, "thickness_mm": 0.25}]}),
    ],
)
def test_sizes_of_stars_on_a_fabric_without_a_law(by: Any, step: float, star: dict[str, Any]) -> None:
    heights = [
        asterism.preview(Design.from_dict(UNKNOWN | {"stars": SIZES | star | {by: SIZES[by] + change}})).height_mm
        for change in (-step, step)
    ]
    derivatives = sensitivity(Design.from_dict(UNKNOWN | {"stars": SIZES | star}), by=by).derivatives
    assert derivatives.sum() == pytest.approx((heights[1] - heights[0]) / (2.0 * step), rel=0.05, abs=0.05)
    assert np.abs(derivatives).max() < 2.0


@pytest.mark.slow
def test_a_painted_star_on_a_fabric_without_a_law_is_as_in_a_fresh_preview() -> None:
    plain, painted = (UNKNOWN | {"stars": SIZES | more} for more in ({}, {"override": [{"star": 0, "width_mm": 1.1}]}))
    edited = asterism.Preview(Design.from_dict(plain)).update(Design.from_dict(painted))
    assert edited.height_mm == pytest.approx(asterism.preview(Design.from_dict(painted)).height_mm, rel=5e-3)
