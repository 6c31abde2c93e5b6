"""A preview says which other forms it met."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from asterism.fem.search.relax import Trial
from asterism.pattern.design.design import Design
from asterism.pattern.layout.supports import SupportSamples
from asterism.pattern.layout.symmetries import Symmetry
from asterism.previews.session import Preview
from asterism.previews.solve import other_forms
from tests.asterism.previews.laws import plain_law
from tests.distances import rms_distance


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


def test_forms_are_told_from_each_other_and_measured_from_the_one_that_is_shown() -> None:
    """Rolls about one axis by more and more: the third is as good as the second."""
    y = np.linspace(-50.0, 50.0, 9)
    x = np.tile([-10.0, 0.0, 10.0], 3)
    rolls = [np.column_stack([x, np.sin(k * y) / k, np.cos(k * y) / k]) for k in (0.01, 0.02, 0.0201)]
    trials = [Trial(f"arc {n}", 10.0 + n, True, 1, roll) for n, roll in enumerate(rolls)]
    lost = Trial("cap", 5.0, False, 1, 3.0 * rolls[0])
    no_supports = SupportSamples(np.empty((0, 2)), np.empty((0, 3)), np.empty(0, dtype=np.int64))
    plan = SimpleNamespace(sample_points=np.column_stack([x, y]), support_samples=no_supports)
    space = SimpleNamespace(locate=lambda points: SimpleNamespace(value=np.eye(9)))
    same = [Symmetry(np.eye(2), np.zeros(2), np.arange(9))]
    shown = SimpleNamespace(x=rolls[0], energy=10.0, absolute_energy=20.0, trials=[lost, *trials[::-1]])
    corners = np.array([[0.0, 0.0, 0.0], [100.0, 0.0, 0.0]])
    shell = SimpleNamespace(node_positions=lambda x: corners)
    sheet = SimpleNamespace(space=space, symmetries=same)
    state = SimpleNamespace(resting=shown, shell=shell, sheet=sheet, layout=plan)
    ((found, trial),) = other_forms(state)  # type: ignore[arg-type]
    assert trial is trials[1]
    assert (found.start, found.energy_n_mm, found.gap) == ("arc 1", 11.0, 1.0 / 20.0)
    assert found.distance_percent == pytest.approx(rms_distance(rolls[0], rolls[1]))
    # a third one beside the second, further from it than EQUAL
    shown.trials.append(Trial("arc 3", 14.0, True, 1, 1.1 * rolls[1]))
    third = other_forms(state)[1][0]  # type: ignore[arg-type]
    apart = [rms_distance(roll, 1.1 * rolls[1]) for roll in rolls[:2]]
    assert third.distance_percent == pytest.approx(apart[0]) and apart[1] < 0.9 * apart[0]
