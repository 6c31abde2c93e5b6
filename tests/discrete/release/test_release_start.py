"""Starts of the release: their shapes by formula, and stars returned to the side of their branch."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import DiscreteModel, add_bumps, bump_heights
from asterism.discrete.release.release_start import BRANCH_NUDGE_MM, MIN_BRANCH_BUMP_MM, ReleaseStart
from asterism.pattern import gallery
from tests.discrete.models import model_of

LEFT = (0.3, 1.0)


@cache
def model(held: bool = False) -> DiscreteModel:
    data = gallery.load("tube").to_dict() | {"border": {"rectangle_mm": [70.0, 60.0]}}
    return model_of(data | {"pins": [{"where": "border", "scale": 0.9}] if held else []}, 4.0)


def bent(**how: object) -> tuple[np.ndarray, np.ndarray]:
    """(V,) printed distances along and across the axis at 30 degrees over half the diagonal, and heights in mm."""
    start = ReleaseStart(bumps=False, noise_mm=0.0, axis_deg=30.0, **how)  # type: ignore[arg-type]
    axis = np.array([[np.sqrt(0.75), 0.5], [-0.5, np.sqrt(0.75)]])
    return model().mesh.points @ axis.T / np.hypot(35.0, 30.0), start.initial_state(model()).positions[:, 2]


def test_domes_fall_to_all_sides_and_saddles_only_across_their_ridge() -> None:
    (along, across), z = (each.T for each in bent(bend="dome", sag_mm=7.0))
    np.testing.assert_allclose(z, -7.0 * (across**2 + along**2), atol=1e-9)
    (along, across), z = (each.T for each in bent(bend="saddle", sag_mm=7.0))
    np.testing.assert_allclose(z, -7.0 * (across**2 - along**2), atol=1e-9)


@pytest.mark.parametrize("sag", [5.0, 500.0])
def test_half_angle_of_rolls_is_limited(sag: float) -> None:
    size = np.hypot(35.0, 30.0)
    turn = min(2.0 * sag / size, 2.5)
    (_, across), z = (each.T for each in bent(bend="roll", sag_mm=sag))
    np.testing.assert_allclose(z, size / turn * (np.cos(turn * across) - 1.0), atol=1e-9)


def test_noise_does_not_move_held_components() -> None:
    sheet = model(held=True)
    quiet, noisy = (ReleaseStart(noise_mm=noise).initial_state(sheet).positions for noise in (0.0, 0.5))
    held = sheet.constraints.held
    assert held.any()
    np.testing.assert_array_equal(noisy[held], quiet[held])
    assert np.abs(noisy - quiet)[~held].std() > 0.2


def test_nearly_flat_stars_are_nudged_before_the_last_release() -> None:
    sheet = model()
    low, high = (
        add_bumps(sheet, sheet.flat_state(), np.full(7, height))
        for height in (0.5 * MIN_BRANCH_BUMP_MM, 3.0 * MIN_BRANCH_BUMP_MM)
    )
    assert bump_heights(sheet, low).min() > 0.0 and bump_heights(sheet, low).max() < MIN_BRANCH_BUMP_MM
    try:
        sheet.set_release(0.3)
        nudged, kept = (ReleaseStart(releases=LEFT).restore_branches(sheet, state) for state in (low, high))
        gained = bump_heights(sheet, nudged) - bump_heights(sheet, low)
        assert gained.min() > 0.5 * BRANCH_NUDGE_MM
        np.testing.assert_allclose(kept.positions, high.positions)
    finally:
        sheet.set_release(1.0)
    last = ReleaseStart(releases=LEFT).restore_branches(sheet, low)
    np.testing.assert_allclose(last.positions, low.positions)
