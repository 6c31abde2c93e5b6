"""A design for a wanted height or radius, and a needle that brings the sheet to a wanted point."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import asterism
from asterism.fitting.errors import ReachError
from asterism.fitting.solve_for import POINT_TOLERANCE_MM, solve_for, solve_for_point
from asterism.pattern.design.design import Design


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


def test_wrong_arguments_are_named() -> None:
    design = asterism.new("dome")
    with pytest.raises(ValueError, match="wanted = 'depth'"):
        solve_for(design, "depth", 3.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="value = -1"):
        solve_for(design, "height_mm", -1)
    with pytest.raises(ValueError, match="change = 'stretch'"):
        solve_for(design, "height_mm", 3.0, "stretch")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="Design is needed"):
        solve_for("dome.toml", "height_mm", 3.0)  # type: ignore[arg-type]


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


def test_wrong_arguments_of_a_needle_are_named(canopy: Design) -> None:
    with pytest.raises(ValueError, match="needle = 5: must be a whole number from 0 to 4"):
        solve_for_point(canopy, (0.0, 0.0), (0.0, 0.0, 18.0), needle=5)
    with pytest.raises(ValueError, match="needles with target_mm are needed"):
        solve_for_point(asterism.new("dome"), (0.0, 0.0), (0.0, 0.0, 18.0))
    with pytest.raises(ValueError, match=r"at_mm = .*: must be on the sheet"):
        solve_for_point(canopy, (300.0, 0.0), (0.0, 0.0, 18.0))
    with pytest.raises(ValueError, match=r"point_mm = .*: must be 3 numbers of mm"):
        solve_for_point(canopy, (0.0, 0.0), (0.0, 18.0))
    with pytest.raises(ValueError, match="at_mm = 'centre': must be 2 numbers of mm"):
        solve_for_point(canopy, "centre", (0.0, 0.0, 18.0))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="Design is needed"):
        solve_for_point({}, (0.0, 0.0), (0.0, 0.0, 18.0))  # type: ignore[arg-type]
