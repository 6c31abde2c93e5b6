"""A design for a wanted height or radius."""

from __future__ import annotations

from typing import Any

import pytest

import asterism
from asterism.fitting.errors import ReachError
from asterism.fitting.solve_for import solve_for


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
