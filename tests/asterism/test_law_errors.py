"""Laws that miss their own test cells say so."""

from __future__ import annotations

import copy
from dataclasses import replace

import asterism
from asterism.law_errors import coarse_line
from asterism.law_table import law_table
from homogenize.law import Law
from homogenize.law_file import load_law


def missed(kappa: float, bending: float) -> Law:
    """The paper's, whose cells at stretch 1.75 are missed by so many percent."""
    law = load_law()
    residuals = copy.deepcopy(law.residuals)
    errors = residuals["1.75"]["held_out"]["errors"]
    errors["kappa"]["rms_percent"], errors["bending"]["rms_percent"] = kappa, bending
    return replace(law, residuals=residuals)


def test_a_law_that_misses_its_cells_says_so_wherever_it_is_used() -> None:
    law = missed(8.5, 2.0)
    line = coarse_line(law)
    assert line is not None and "at stretch 1.75" in line and "curvature by 8 % and bending stiffness by 2 %" in line
    assert f"  {line}" in law_table(law)
    assert line in asterism.preview(asterism.new("dome"), law).summary["warnings"]


def test_a_law_that_does_not_is_silent() -> None:
    assert coarse_line(load_law()) is None and coarse_line(missed(4.9, 4.9)) is None
    assert not any("test cells" in line for line in asterism.preview(asterism.new("dome")).summary["warnings"])
    untested = replace(load_law(), residuals={"1.35": {"held_out": {"count": 0, "errors": {}}}})
    assert coarse_line(untested) is None
