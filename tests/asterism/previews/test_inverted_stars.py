"""Warnings of stars that may be inverted, from the flat and the natural state of their cells."""

from __future__ import annotations

import numpy as np
import pytest

import asterism
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from asterism.previews.warnings import stars_that_may_be_inverted

# stars of the exact dome with arms of 10 mm that are inverted after its release (`asterism simulate`), without the
# three corners of the sheet
INVERTED = [0, 2, 4, 6, 14, 16, 18]


def dome(length: float | None, thickness: float = 0.3) -> Design:
    data = asterism.new("dome").to_dict()
    if length is not None:
        data["stars"] |= {"length_mm": length, "thickness_mm": thickness}
    return Design.from_dict(data)


@pytest.mark.slow
@pytest.mark.parametrize(("thickness", "count"), [(0.3, 34), (0.5, 0)])
def test_long_thin_arms_on_a_flat_sheet_may_be_inverted(thickness: float, count: int) -> None:
    preview = Preview(dome(10.0, thickness), load_law())
    stars = stars_that_may_be_inverted(preview.state)
    assert len(stars) == pytest.approx(count, abs=3)
    if count:
        assert set(INVERTED) <= set(stars.tolist())
    lines = [line for line in preview.shape().summary["warnings"] if "may be inverted beside others" in line]
    assert len(lines) == (count > 0)


def test_a_dome_of_graded_arms_is_not_warned_of() -> None:
    """Only its central star is long enough, and one star alone has no neighbour to alternate with."""
    law = load_law()
    assert len(stars_that_may_be_inverted(Preview(dome(None), law).state)) == 0
    assert "_cell_stability" not in vars(law)  # its cells stay packed


def test_free_sheets_are_not_warned_of() -> None:
    data = dome(10.0).to_dict() | {"pins": []}
    assert len(stars_that_may_be_inverted(Preview(Design.from_dict(data), load_law()).state)) == 0


def test_the_table_holds_the_cells_of_one_stretch() -> None:
    """The cells of 10 mm and 0.3 mm are unstable flat and stable rolled."""
    law = load_law()
    table = law.cell_stability(1.35)
    assert len(table.sizes) == sum(
        s["stretch"] == 1.35 and s["problem"] is None and s["length_mm"] > 0 for s in law.samples
    )
    flat, half, rolled = table.eigenvalues(np.array([[10.0, 0.3, 1.2]] * 3), np.array([-1.0, 0.5, 2.0]))
    assert flat < 0.0 < rolled and half == pytest.approx(0.5 * (flat + rolled))
    assert law.cell_stability(1.35) is table
