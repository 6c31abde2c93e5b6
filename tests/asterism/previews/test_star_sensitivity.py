"""Sensitivities of a preview against finite edits of it."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.painted_stars import SizeName, with_painted_stars
from asterism.previews.session import Preview
from asterism.previews.star_sensitivity import star_sensitivity

SIZES = {"length_mm": 7.0, "thickness_mm": 0.45, "width_mm": 1.2}
PINNED = {"corners": [0, 2, 4], "target_mm": [[30.0, 15.0, 0.0], [-33.0, 2.0, 3.0], [2.0, -34.0, 0.0]]}


def design(pins: list[dict[str, object]]) -> Design:
    return Design.from_dict({"stars": dict(SIZES), "border": {"rings": 2}, "pins": pins})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pins", "size", "step"),
    [([], "length_mm", 0.2), ([PINNED], "thickness_mm", 0.004), ([PINNED], "width_mm", 0.04)],
)
def test_the_derivative_is_the_limit_of_edits(pins: list[dict[str, object]], size: SizeName, step: float) -> None:
    """Rigid motions of a free sheet are left out."""
    preview = Preview(design(pins))
    derivative, before, plan = star_sensitivity(preview.state, size), preview.snapshot(), preview.sheet.layout
    located = preview.sheet.space.locate(plan.centres)
    start = located.jets(preview.state.resting.x)[:, 0]

    def moved(places: Floats) -> Floats:
        rotation, shift = (np.eye(3), np.zeros(3)) if pins else rigid_fit(places, start)
        return np.asarray(places @ rotation.T + shift - start)

    for star in (0, 11):
        errors = []
        for change in (step, step / 4.0):
            predicted = moved(start + change * located.jets(derivative[..., star])[:, 0])
            sizes = [[value + change if name == size else np.nan for name, value in SIZES.items()]]
            preview.update(with_painted_stars(preview.design, [plan.sites[star]], sizes))
            found = moved(located.jets(preview.state.resting.x)[:, 0])
            preview.restore(before)
            errors.append(np.linalg.norm(found - predicted) / np.linalg.norm(predicted))
        # the error falls with the step; what is left are the tolerances of the equilibria
        assert errors[1] < 0.02
        assert errors[1] < 0.5 * errors[0] or errors[0] < 0.01


@pytest.mark.slow
def test_rounded_sizes_are_changed_from_their_rounded_values() -> None:
    """A design whose thickness 0.45 mm is printed as 0.5 mm has the derivatives of one that is drawn so."""
    rounded, printed = design([PINNED]).to_dict(), design([PINNED]).to_dict()
    rounded["stars"]["rounding"] = {"first_layer_mm": 0.3, "layer_mm": 0.2, "line_mm": 0.4}
    printed["stars"]["thickness_mm"] = 0.5
    one, other = (Preview(Design.from_dict(each)).state for each in (printed, rounded))
    for size in SIZES:
        expected, given = (star_sensitivity(state, size) for state in (one, other))  # type: ignore[arg-type]
        assert np.abs(given - expected).max() < 1e-6 * np.abs(expected).max()


@pytest.mark.slow
def test_stars_of_one_colour_give_the_same_as_stars_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    preview = Preview(design([PINNED]))
    together = star_sensitivity(preview.state, "length_mm")
    monkeypatch.setattr("asterism.previews.star_sensitivity.COLOUR_STEPS", 1000)
    alone = star_sensitivity(preview.state, "length_mm")
    assert np.abs(together - alone).max() < 1e-9 * np.abs(alone).max()


def test_a_linear_response_has_no_sensitivities() -> None:
    preview = Preview(design([]))
    edit = preview.edit(with_painted_stars(preview.design, [[0, 0]], [[7.5, np.nan, np.nan]]))
    next(edit)
    with pytest.raises(ValueError, match="belong to an equilibrium"):
        star_sensitivity(preview.state, "length_mm")
