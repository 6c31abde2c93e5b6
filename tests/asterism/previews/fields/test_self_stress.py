"""What stars gain by Gaussian curvature goes with the pull of the fabric, the arms' length and the bumps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.previews.fields.self_stress import gaussian_moduli, pulls
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.model import PREVIEW_MODEL
from equilibrium.arrays import Floats
from pattern import gallery
from pattern.layout.build import layout
from tests.asterism.previews.laws import plain_law

ACROSS, GREEN = PREVIEW_MODEL.gaussian_arm_factor, PREVIEW_MODEL.gaussian_strain_factor
SOFTER, MOST = PREVIEW_MODEL.gaussian_softening_exponent, PREVIEW_MODEL.max_gaussian_area

DESIGN = gallery.load("tube")
PLAN = layout(DESIGN)
VALUES = star_values(DESIGN, PLAN, plain_law())
SPACING = PLAN.spacing_mm


def changed(length: float, **stars: float) -> StarValues:
    """All stars with arms of a length and other values of the law; the bare fabric as it was."""
    value = {name: of.copy() for name, of in VALUES.value.items()}
    for name, number in stars.items():
        value[name][:-1] = number
    sizes = VALUES.sizes.copy()
    sizes[:, 0] = length
    return replace(VALUES, value=value, sizes=sizes)


def areas(values: StarValues) -> Floats:
    """(S,) mm^2, moduli over the fabric's pull."""
    return np.asarray(gaussian_moduli(values, SPACING) / pulls(values))


BARE = {name: float(VALUES.value[name][-1]) for name in ("a11", "a12", "lam_n")}


def test_of_short_stars_that_do_not_bump_it_is_that_of_a_sheet_in_its_plane() -> None:
    as_stiff = {name: BARE[name] for name in ("a11", "a12")}
    flat = changed(5.0, lam_n=1.04 * BARE["lam_n"], **as_stiff)
    assert areas(flat) == pytest.approx(ACROSS * 25.0 - GREEN * SPACING**2 * 0.04)
    softer = changed(5.0, lam_n=1.04 * BARE["lam_n"], **{name: stiff / 1.05 for name, stiff in as_stiff.items()})
    assert areas(softer) == pytest.approx(1.05**SOFTER * areas(flat))
    pull = 0.5 * (BARE["a11"] + BARE["a12"]) * (1.04**2 - 1.0) * BARE["lam_n"] ** 2
    assert pulls(flat) == pytest.approx(pull)


def test_it_has_a_largest_value_and_is_never_negative() -> None:
    soft = {name: 0.5 * BARE[name] for name in ("a11", "a12")}
    assert areas(changed(10.0, lam_n=1.1 * BARE["lam_n"], **soft)) == pytest.approx(MOST * SPACING**2)
    assert not gaussian_moduli(changed(3.0, lam_n=1.2 * BARE["lam_n"]), SPACING).any()
    assert not gaussian_moduli(changed(8.0, lam_n=0.9 * BARE["lam_n"]), SPACING).any()


def test_it_is_larger_on_a_larger_print_by_the_square_of_its_size() -> None:
    values = changed(5.0, lam_n=1.04 * BARE["lam_n"])
    twice = replace(values, sizes=values.sizes * [2.0, 1.0, 1.0])
    assert gaussian_moduli(twice, 2.0 * SPACING) == pytest.approx(4.0 * gaussian_moduli(values, SPACING))
