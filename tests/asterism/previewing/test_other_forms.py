"""A preview says which other forms it met."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.previewing.expected import UNSURE, close_form, expected_rms_percent
from asterism.previewing.other_forms import OtherForm
from asterism.previewing.preview import Preview
from pattern.design import Design
from tests.asterism.previewing.laws import plain_law

AMPLITUDES = np.array([5.0, 2.0])


def design(thickness: object) -> Design:
    stars = {"length_mm": 9.0, "thickness_mm": thickness, "width_mm": 1.2}
    return Design.from_dict({"name": "forms", "stars": stars, "border": {"rings": 3}})


def test_a_sheet_that_changes_along_a_line_has_several_forms() -> None:
    skew = {"profile": "linear", "from": 0.3, "to": 0.2, "start_mm": [-34.0, -10.0], "end_mm": [34.0, 10.0]}
    preview = Preview(design(skew), plain_law())
    summary = preview.shape().summary
    others = summary["other_forms"]
    assert others
    for other in others:
        assert other["distance_percent"] > 2.0
        more = other["gap"] * preview.equilibrium.at_stake
        assert other["energy_n_mm"] == pytest.approx(summary["energy_n_mm"] + more)
        assert any(trial["energy"] == other["energy_n_mm"] for trial in summary["starts"])
    assert others[0]["gap"] < UNSURE
    assert any("another form" in line for line in summary["warnings"])
    assert summary["expected_rms_percent"] > 0.5 * others[0]["distance_percent"]


def test_forms_that_symmetry_makes_equal_are_one() -> None:
    preview = Preview(design(0.3), plain_law())
    assert len(preview.symmetries) == 6
    assert preview.shape().summary["other_forms"] == []


def test_a_form_counts_by_how_likely_it_is() -> None:
    def expected(*gaps: float) -> float:
        return expected_rms_percent(AMPLITUDES, [OtherForm("arc", 1.0, gap, 20.0) for gap in gaps]) or 0.0

    alone = expected()
    assert expected(0.0) == pytest.approx(np.hypot(alone, 20.0 / np.sqrt(2.0)))
    assert expected(-0.01) > expected(0.0) > expected(0.05) > expected(0.2) > alone
    assert expected(1.0) == pytest.approx(alone)
    assert expected(0.3, 0.05) == expected(0.05)


def test_a_close_form_is_one_that_the_law_cannot_exclude() -> None:
    near, far = OtherForm("arc", 1.0, 0.5 * UNSURE, 20.0), OtherForm("cap", 1.0, 2.0 * UNSURE, 20.0)
    assert close_form([near, far]) is near
    assert close_form([far]) is None
    assert close_form([]) is None
