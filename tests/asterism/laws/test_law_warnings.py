"""Laws that miss their own test cells say so."""

from __future__ import annotations

import copy
from dataclasses import replace

from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.laws.law_text import held_out_warning, law_lines


def missed(kappa: float, bending: float) -> StarLaw:
    """The paper's, whose cells at stretch 1.75 are missed by so many percent."""
    law = load_law()
    residuals = copy.deepcopy(law.residuals)
    errors = residuals["1.75"]["held_out"]["errors"]
    errors["kappa"]["rms_percent"], errors["bending"]["rms_percent"] = kappa, bending
    return replace(law, residuals=residuals)


def test_a_law_that_misses_its_cells_says_so() -> None:
    law = missed(8.5, 2.0)
    line = held_out_warning(law)
    assert line is not None and "at stretch 1.75" in line and "8 % in curvature and 2 % in bending stiffness" in line
    assert f"  {line}" in law_lines(law)


def test_a_law_that_does_not_is_silent() -> None:
    assert held_out_warning(load_law()) is None and held_out_warning(missed(4.9, 4.9)) is None
    untested = replace(load_law(), residuals={"1.35": {"held_out": {"count": 0, "errors": {}}}})
    assert held_out_warning(untested) is None


def test_the_sizes_that_a_law_covers_are_numbers() -> None:
    law = load_law()
    for stretch in law.stretches:
        ranges = law.size_ranges(stretch)
        assert list(ranges) == ["length_mm", "thickness_mm", "width_mm"]
        lows, highs = zip(*ranges.values(), strict=True)
        table = law.at(stretch)
        assert table(*lows).inside.all() and table(*highs).inside.all()
        assert not table(highs[0], highs[1] * 1.01, highs[2]).inside.any()
