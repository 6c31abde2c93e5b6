"""Sensitivities of a preview against finite edits of it."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.previews.session import Preview
from asterism.previews.star_sensitivity import SizeName, star_sensitivity

SIZES = {"length_mm": 7.0, "thickness_mm": 0.45, "width_mm": 1.2}
PINNED = {"corners": [0, 2, 4], "target_mm": [[30.0, 15.0, 0.0], [-33.0, 2.0, 3.0], [2.0, -34.0, 0.0]]}


def design(pins: list[dict[str, object]]) -> Design:
    return Design.from_dict({"stars": dict(SIZES), "border": {"rings": 2}, "pins": pins})


def move_by_edit(preview: Preview, star: int, size: SizeName, change: float, is_free: bool) -> Floats:
    """(S, 3) motion of the star centres by an edit of one star, without rigid motions of a free sheet."""
    places = preview.sheet.layout.centres
    located = preview.sheet.space.locate(places)
    before, start = preview.snapshot(), located.jets(preview.state.resting.x)[:, 0]
    sizes = np.full((1, 3), np.nan)
    column = list(SIZES).index(size)
    sizes[0, column] = SIZES[size] + change
    preview.update(with_painted_stars(preview.design, [preview.sheet.layout.sites[star]], sizes))
    moved = located.jets(preview.state.resting.x)[:, 0]
    preview.restore(before)
    if is_free:
        rotation, shift = rigid_fit(moved, start)
        moved = moved @ rotation.T + shift
    return np.asarray(moved - start)


@pytest.mark.slow
@pytest.mark.parametrize("pins", [[], [PINNED]], ids=["free", "pinned"])
@pytest.mark.parametrize(("size", "step"), [("length_mm", 0.2), ("thickness_mm", 0.004), ("width_mm", 0.04)])
def test_the_derivative_is_the_limit_of_edits(pins: list[dict[str, object]], size: SizeName, step: float) -> None:
    preview = Preview(design(pins))
    derivative = star_sensitivity(preview.state, size)
    located = preview.sheet.space.locate(preview.sheet.layout.centres)
    start = located.jets(preview.state.resting.x)[:, 0]
    for star in (0, 11):
        errors = []
        for change in (step, step / 4.0):
            predicted = change * located.jets(derivative[..., star])[:, 0]
            if not pins:
                rotation, shift = rigid_fit(start + predicted, start)
                predicted = (start + predicted) @ rotation.T + shift - start
            move = move_by_edit(preview, star, size, change, not pins)
            errors.append(np.linalg.norm(move - predicted) / np.linalg.norm(predicted))
        # the error falls with the step; what is left are the tolerances of the equilibria
        assert errors[1] < 0.02
        assert errors[1] < 0.5 * errors[0] or errors[0] < 0.01


@pytest.mark.slow
@pytest.mark.parametrize("size", ["length_mm", "thickness_mm", "width_mm"])
def test_rounded_sizes_are_changed_from_their_rounded_values(size: SizeName) -> None:
    """A design whose thickness 0.45 mm is printed as 0.5 mm has the derivatives of one that is drawn so."""
    rounded, printed = design([PINNED]).to_dict(), design([PINNED]).to_dict()
    rounded["stars"]["rounding"] = {"first_layer_mm": 0.3, "layer_mm": 0.2, "line_mm": 0.4}
    printed["stars"]["thickness_mm"] = 0.5
    expected, given = (star_sensitivity(Preview(Design.from_dict(each)).state, size) for each in (printed, rounded))
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
