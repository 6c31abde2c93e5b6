"""A preview says which other forms it met."""

from __future__ import annotations

import pytest

from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from tests.asterism.previews.laws import plain_law


def design(thickness: object) -> Design:
    stars = {"length_mm": 9.0, "thickness_mm": thickness, "width_mm": 1.2}
    return Design.from_dict({"name": "forms", "stars": stars, "border": {"rings": 3}})


@pytest.mark.slow
def test_a_sheet_that_changes_along_a_line_has_several_forms() -> None:
    skew = {"profile": "linear", "from": 0.35, "to": 0.2, "start_mm": [-34.0, -10.0], "end_mm": [34.0, 10.0]}
    preview = Preview(design(skew), plain_law())
    summary = preview.shape().summary
    others = summary["other_forms"]
    assert others
    for other in others:
        assert other["distance_percent"] > 2.0
        more = other["gap"] * preview.equilibrium.absolute_energy
        assert other["energy_n_mm"] == pytest.approx(summary["energy_n_mm"] + more)
        assert any(trial["energy"] == other["energy_n_mm"] for trial in summary["starts"])
    shown = [text for label, text in summary.table().items() if label.startswith("other form")]
    assert len(shown) == len(others) and all(text.endswith("more energy") for text in shown)


def test_forms_that_symmetry_makes_equal_are_one() -> None:
    preview = Preview(design(0.3), plain_law())
    assert len(preview.sheet.symmetries) == 6
    assert preview.shape().summary["other_forms"] == []
