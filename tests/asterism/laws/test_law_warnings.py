"""Laws that miss their own test cells say so."""

from __future__ import annotations

import copy
from dataclasses import replace

from asterism.homogenize.campaign.fit_law import broken_symmetry, unstable_tubes
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.laws.law_text import law_lines
from asterism.laws.law_warnings import held_out_warning, pleat_warning, symmetry_warning


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


def test_a_law_whose_stars_bend_out_of_their_symmetry_says_so() -> None:
    """The difference is that of the worst cell."""
    cells = [0.02, 0.4, 0.1]
    samples = [{"problem": None, "length_mm": 7.0, "sample": {"asymmetry": each}} for each in cells]
    law = load_law()
    residuals = {name: {**kinds, "symmetry": broken_symmetry(samples)} for name, kinds in law.residuals.items()}
    broken = replace(law, residuals=residuals)
    line = symmetry_warning(broken)
    assert line is not None and "equal directions differ by up to 40 %" in line
    assert f"  {line}" in law_lines(broken)


def test_a_law_of_cells_that_keep_their_symmetry_is_silent() -> None:
    kept = {name: {**kinds, "symmetry": broken_symmetry([])} for name, kinds in load_law().residuals.items()}
    assert symmetry_warning(replace(load_law(), residuals=kept)) is None and symmetry_warning(load_law()) is None


def unstable(count: int) -> StarLaw:
    """The paper's, of whose cells so many out of forty would leave their natural tubes."""
    law = load_law()
    residuals = copy.deepcopy(law.residuals)
    residuals["1.35"]["tubes"] = {"count": 20, "unstable": count}
    residuals["1.75"]["tubes"] = {"count": 20, "unstable": 0}
    return replace(law, residuals=residuals)


def test_a_law_whose_stars_would_rise_and_fall_in_turn_says_so() -> None:
    line = pleat_warning(unstable(5))
    assert line is not None and "of 5 of the law's 40 cells" in line
    assert "another form" in line
    assert f"  {line}" in law_lines(unstable(5))


def test_a_law_of_few_such_cells_is_silent() -> None:
    assert pleat_warning(unstable(4)) is None and pleat_warning(load_law()) is None


def test_what_a_law_keeps_of_its_cells_stability_is_what_its_cells_say() -> None:
    """The paper's has 17 tight ones in 1224."""
    law = load_law()
    assert unstable_tubes(law.samples) == {"count": 1224, "unstable": 17}
    free = [copy.deepcopy(cell) for cell in law.samples[-3:]]
    free[0]["sample"]["natural_supercell_eigenvalue"][1] = -1e-4
    free[1] |= {"problem": "none", "sample": None}
    assert unstable_tubes(free) == {"count": 2, "unstable": 1}


def test_the_sizes_that_a_law_covers_are_numbers() -> None:
    law = load_law()
    for stretch in law.stretches:
        ranges = law.size_ranges(stretch)
        assert list(ranges) == ["length_mm", "thickness_mm", "width_mm"]
        lows, highs = zip(*ranges.values(), strict=True)
        table = law.at(stretch)
        assert table(*lows).inside.all() and table(*highs).inside.all()
        assert not table(highs[0], highs[1] * 1.01, highs[2]).inside.any()
