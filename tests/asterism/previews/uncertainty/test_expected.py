"""What a preview expects of itself."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from asterism.previews.uncertainty.expected import (
    ANOTHER_FORM,
    BUCKLED,
    CONTRAST,
    FLOOR,
    FORGIVEN,
    MIRRORED,
    SHARE,
    UNSURE,
    amplitudes_percent,
    another_form_is_near,
    close_form,
    expected_rms_percent,
    share_of,
)
from asterism.previews.uncertainty.other_forms import OtherForm
from pattern import gallery
from pattern.design.design import Design
from pattern.layout.build import layout
from pattern.layout.symmetries import Symmetry, symmetries


def test_amplitudes_take_the_energy():
    """Half the eigenvalue times area times the mean square is the energy."""
    modes, energy, area, diameter = np.array([2e-4, 5e-5]), 20.0, 9000.0, 100.0
    found = amplitudes_percent(modes, energy, area, diameter)
    assert 0.5 * modes[::-1] * area * (found * diameter / 100.0) ** 2 == pytest.approx([energy, energy])


def test_softer_sheets_expect_more():
    expected = [expected_rms_percent(np.array([a, 0.7 * a, 0.3 * a])) for a in (1.0, 5.0, 20.0, 40.0, 80.0)]
    assert all(one < other for one, other in pairwise(expected))


def test_symmetry_and_pins_forgive_soft_motions():
    soft = np.array([30.0, 12.0, 8.0])
    assert expected_rms_percent(soft, share=FORGIVEN) < 0.8 * expected_rms_percent(soft)
    none, forgiven, free = (expected_rms_percent(soft, share=share) ** 2 for share in (0.0, FORGIVEN, SHARE))
    assert (forgiven - none) / (free - none) == pytest.approx((FORGIVEN / SHARE) ** 2)


@pytest.mark.parametrize(
    ("border", "share"),
    [
        ({"rings": 1}, FORGIVEN),
        ({"rectangle_mm": [70.0, 62.0]}, MIRRORED),
        ({"polygon_mm": [[-40.0, -30.0], [45.0, -35.0], [30.0, 40.0]]}, SHARE),
    ],
)
def test_a_mirror_alone_forgives_nothing(border, share):
    design = Design.from_dict(gallery.load("tube").to_dict() | {"border": border})
    same = symmetries(design, layout(design))
    assert share_of(False, same) == share
    assert share_of(True, same) == FORGIVEN


def test_forms_count_by_the_chance_that_they_are_lower():
    """Of a normal error of the energies: one in two at equal ones, .1587 one standard deviation above."""
    stiff = np.zeros(2)
    for gap, chance in ((0.0, 0.5), (UNSURE, 0.158655), (-UNSURE, 0.841345)):
        found = expected_rms_percent(stiff, [OtherForm("arc", 1.0, gap, 60.0)], share=0.0)
        assert found == pytest.approx(np.hypot(FLOOR, 60.0 * np.sqrt(chance)), rel=1e-5)


def test_stars_that_curl_tightly_are_beyond_a_smooth_sheet():
    soft = np.array([3.0, 2.0, 1.0])
    assert expected_rms_percent(soft, share=FORGIVEN, tight=1.0) > 4.0
    assert expected_rms_percent(soft, share=FORGIVEN, tight=1.0, held=True) < 1.0


def test_one_soft_motion_is_forgiven():
    """The turn of a tube's axis alone does not make another form."""
    assert not another_form_is_near(np.array([80.0, 10.0]))
    assert another_form_is_near(np.array([80.0, 40.0]))
    one, two = (expected_rms_percent(np.array([80.0, second]), share=FORGIVEN) for second in (10.0, 40.0))
    assert two > 2.0 * one


def test_held_sheets_take_less_to_have_another_form():
    edges = np.array([16.0, 15.0, 15.0])
    assert another_form_is_near(edges, held=True) and not another_form_is_near(edges)
    assert expected_rms_percent(edges, share=FORGIVEN, held=True) > 2.0 * expected_rms_percent(edges, share=FORGIVEN)


def test_sheets_that_are_held_narrow_may_buckle_otherwise():
    stiff = np.array([6.0, 4.0, 3.0])
    wide, narrower, narrow, narrowest = (
        expected_rms_percent(stiff, held=True, width=width) for width in (np.inf, 0.9, 0.87, 0.6)
    )
    assert wide == expected_rms_percent(stiff, held=True) < narrower < narrow == narrowest
    assert narrow == pytest.approx(np.hypot(wide, BUCKLED)) and narrow > 2.5


def test_sheets_that_hang_on_unequal_stars_expect_more():
    stiff = np.array([6.0, 4.0, 3.0])
    alike, little, much = (expected_rms_percent(stiff, contrast=contrast) for contrast in (0.0, 5.0, 40.0))
    assert alike == expected_rms_percent(stiff) < little < much
    assert much == pytest.approx(np.hypot(alike, 40.0 * CONTRAST))
    folding = expected_rms_percent(stiff, contrast=1000.0)
    assert folding == pytest.approx(np.hypot(alike, ANOTHER_FORM))


def test_nothing_is_expected_of_what_is_not_stable():
    assert expected_rms_percent(np.empty(0)) is None
    assert not another_form_is_near(np.empty(0))


def test_half_a_turn_forgives_as_other_turns_do():
    none, star = np.zeros(2), np.arange(1)
    same, half, mirror = (Symmetry(turn, none, star) for turn in (np.eye(2), -np.eye(2), np.diag([1.0, -1.0])))
    assert share_of(False, [same, half]) == share_of(False, [same, half, mirror]) == FORGIVEN
    assert share_of(False, [same]) == SHARE


def test_the_lowest_form_within_the_energies_doubt_might_be_the_right_one():
    far, near, nearer = (OtherForm("arc", 1.0, part * UNSURE, 60.0) for part in (1.1, 0.9, 0.5))
    assert close_form([far]) is None
    assert close_form([near, far]) is near
    assert close_form([nearer, near, far]) is nearer
