"""Derivatives of a preview by the sizes of single stars."""

from __future__ import annotations

import numpy as np
import pytest

import asterism
from asterism.fitting.solve_for import sensitivity
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import SIZE_KEYS, with_painted_stars

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


@pytest.mark.parametrize("wrong", [{"of": "weight"}, {"by": "depth_mm"}])
def test_unknown_quantities_and_sizes_are_refused(wrong: dict[str, str]):
    with pytest.raises(ValueError, match=r"must be .*(height_mm|length_mm)"):
        sensitivity(FREE, **wrong)  # type: ignore[arg-type]
