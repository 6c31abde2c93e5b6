"""Sliders: what a design has, their ranges, and the design that their values stand for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import asterism
from asterism.notebook.show import SliderBoard
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout

CANOPY: dict[str, Any] = {
    "stars": {"length_mm": 7.0},
    "border": {"rings": 2},
    "pins": [
        {
            "points_mm": [[43.0, 24.8], [-43.0, 24.8], [-43.0, -24.8], [43.0, -24.8]],
            "target_mm": [[31.0, 18.0, 0.0], [-31.0, 18.0, 5.0], [-31.0, -18.0, 0.0], [31.0, -18.0, 5.0]],
        }
    ],
}


def board(design: Design, keys: list[str] | None = None) -> SliderBoard:
    return SliderBoard(design, layout(design), asterism.load_law(), keys)


def test_a_design_has_the_sliders_of_what_is_in_it() -> None:
    held, free = Design.from_dict(CANOPY), Design.from_dict({"stars": {"length_mm": 7.0}, "border": {"rings": 2}})
    sizes = ["length", "thickness", "width", "stretch"]
    assert [slider.key for slider in board(held).sliders] == [*sizes, "needle_scale", "needle_height"]
    assert [slider.key for slider in board(free).sliders] == sizes
    chosen = ["needle_scale", "length"]
    assert [slider.key for slider in board(asterism.new("dome"), chosen).sliders] == chosen
    with pytest.raises(ValueError, match=r"'needle_scale', but length, thickness"):
        board(free, ["needle_scale"])
    with pytest.raises(ValueError, match=r"'height' must be one of length, .*needle_height"):
        board(free, ["height"])


def test_sizes_stay_in_the_range_of_the_law_and_stretches_are_its_own() -> None:
    design = asterism.new("dome")
    ranges = asterism.load_law().size_ranges(1.35)
    sizes = layout(design).site_sizes_mm
    for column, key in enumerate(("length", "thickness", "width")):
        (slider,), (low, high) = board(design, [key]).sliders, ranges[f"{key}_mm"]
        assert slider.low < 1.0 < slider.high
        at = [layout(board(design, [key]).design_at({key: value})).site_sizes_mm for value in (slider.low, slider.high)]
        assert at[0][:, column].min() >= low - 1e-3 and at[1][:, column].max() <= high + 1e-3
        others = [other for other in range(3) if other != column]
        np.testing.assert_array_equal(at[0][:, others], sizes[:, others])
    (stretch,) = board(design, ["stretch"]).sliders
    assert stretch.options == (1.35, 1.75) and stretch.start == design.fabric.stretch
    assert board(design).design_at({"stretch": 1.7}).fabric.stretch == 1.75


def test_sizes_of_all_stars_are_multiplied_and_removed_ones_stay_removed() -> None:
    override = [{"site": [0, 0], "remove": True}, {"site": [1, 0], "length_mm": 5.0}]
    painted = Design.from_dict(CANOPY | {"stars": {"length_mm": 7.0, "override": override}})
    for design in (asterism.new("dome"), asterism.new("tunnel"), painted):
        before, after = layout(design), layout(board(design).design_at({"length": 0.9, "width": 1.1}))
        has_arms = before.site_sizes_mm[:, 0] > 0
        expected = before.site_sizes_mm[has_arms] * [0.9, 1.0, 1.1]
        np.testing.assert_allclose(after.site_sizes_mm[has_arms], expected, atol=1e-4)
        assert len(after.centres) == len(before.centres)
    plain = board(Design.from_dict(CANOPY)).design_at({"length": 1.1})
    assert plain.stars.length_mm == pytest.approx(7.7) and plain.stars.override == ()  # a number stays one


def test_needles_move_in_the_plane_and_in_height() -> None:
    targets = np.array(CANOPY["pins"][0]["target_mm"])
    moved = board(Design.from_dict(CANOPY)).design_at({"needle_scale": 1.1, "needle_height": 0.5})
    np.testing.assert_allclose(moved.pins[0].target_mm, targets * [1.1, 1.1, 0.5])
    scaled = board(asterism.new("dome")).design_at({"needle_scale": 1.1})
    assert scaled.pins[0].scale == pytest.approx(1.1 * asterism.new("dome").pins[0].scale)


def test_values_are_checked_and_the_design_comes_back() -> None:
    design = asterism.new("dome")
    sliders = board(design)
    assert sliders.design_at({}) == design == sliders.design_at(sliders.start)
    assert sliders.checked({"length": 99.0})["length"] == next(s.high for s in sliders.sliders if s.key == "length")
    for values, message in (
        ({"colour": 1.0}, "'colour' is no slider"),
        ({"length": "long"}, "length = 'long': must be a number"),
        ({"length": float("nan")}, "length = nan: must be a number"),
        ({"length": True}, "length = True: must be a number"),
    ):
        with pytest.raises(ValueError, match=message):
            sliders.design_at(values)
