"""What a preview expects of itself."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.search.near_zero_modes import amplitudes_percent, has_two_near_zero_modes
from asterism.previews.uncertainty.distance_error import distance_error_percent
from asterism.previews.uncertainty.other_forms import OtherForm, close_form

UNSURE, FLOOR = PREVIEW_MODEL.energy_uncertainty, PREVIEW_MODEL.floor_percent
SHARE = PREVIEW_MODEL.amplitude_share
WITHOUT_SHARE = replace(PREVIEW_MODEL, amplitude_share=0.0)


def test_amplitudes_take_the_energy():
    """Half the eigenvalue times area times the mean square is the energy."""
    modes, energy, area, diameter = np.array([2e-4, 5e-5]), 20.0, 9000.0, 100.0
    found = amplitudes_percent(modes, energy, area, diameter)
    assert 0.5 * modes[::-1] * area * (found * diameter / 100.0) ** 2 == pytest.approx([energy, energy])


def test_softer_sheets_expect_more():
    expected = [distance_error_percent(np.array([a, 0.7 * a, 0.3 * a])) for a in (1.0, 5.0, 20.0, 40.0, 80.0)]
    assert all(one < other for one, other in pairwise(expected))


def test_a_share_of_all_amplitudes_counts():
    soft = np.array([30.0, 12.0, 8.0])
    none, found = distance_error_percent(soft, model=WITHOUT_SHARE), distance_error_percent(soft)
    assert found == pytest.approx(np.hypot(none, SHARE * np.linalg.norm(soft)))


def test_forms_count_by_the_chance_that_they_are_lower():
    """Of a normal error of the energies: one in two at equal ones, .1587 one standard deviation above."""
    stiff = np.zeros(2)
    for gap, chance in ((0.0, 0.5), (UNSURE, 0.158655), (-UNSURE, 0.841345)):
        found = distance_error_percent(stiff, [OtherForm("arc", 1.0, gap, 60.0)], model=WITHOUT_SHARE)
        assert found == pytest.approx(np.hypot(FLOOR, 60.0 * np.sqrt(chance)), rel=1e-5)


def test_one_soft_motion_is_forgiven():
    """The turn of a tube's axis alone does not make another form."""
    assert not has_two_near_zero_modes(np.array([80.0, 10.0]))
    assert has_two_near_zero_modes(np.array([80.0, 40.0]))


def test_sheets_that_hang_on_unequal_stars_expect_more():
    stiff = np.array([6.0, 4.0, 3.0])
    alike, little, much = (distance_error_percent(stiff, sensitivity_percent=contrast) for contrast in (0.0, 5.0, 40.0))
    assert alike == distance_error_percent(stiff) < little < much
    assert much == pytest.approx(np.hypot(alike, 40.0 * SHARE))


def test_nothing_is_expected_of_what_is_not_stable():
    assert distance_error_percent(np.empty(0)) is None
    assert not has_two_near_zero_modes(np.empty(0))


def test_the_lowest_form_within_the_energies_doubt_might_be_the_right_one():
    far, near, nearer = (OtherForm("arc", 1.0, part * UNSURE, 60.0) for part in (1.1, 0.9, 0.5))
    assert close_form([far], UNSURE) is None
    assert close_form([near, far], UNSURE) is near
    assert close_form([nearer, near, far], UNSURE) is nearer
