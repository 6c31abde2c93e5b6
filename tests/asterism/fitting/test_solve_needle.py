"""A needle that brings the sheet to a wanted point."""

from __future__ import annotations

import numpy as np
import pytest

import asterism
from asterism.fitting.errors import ReachError
from asterism.fitting.solve_for import POINT_TOLERANCE_MM, solve_for_point
from asterism.pattern.design.design import Design

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


def test_wrong_arguments_are_named(canopy: Design) -> None:
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
