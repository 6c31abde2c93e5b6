"""What stars gain by Gaussian curvature goes with the pull of the fabric alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.pattern import gallery
from asterism.pattern.layout.build import layout
from asterism.previews.fields.sheet_fields import gaussian_moduli, pulls
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.model import PREVIEW_MODEL
from tests.asterism.previews.laws import plain_law

AREA = PREVIEW_MODEL.gaussian_area

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


def test_it_is_the_pull_of_the_fabric_by_a_share_of_the_squared_spacing() -> None:
    for length in (4.0, 10.0):
        stars = changed(length, lam_n=1.04 * BARE["lam_n"])
        assert areas(stars) == pytest.approx(AREA * SPACING**2)
        pull = 0.5 * (BARE["a11"] + BARE["a12"]) * (1.04**2 - 1.0) * BARE["lam_n"] ** 2
        assert pulls(stars) == pytest.approx(pull)


def test_bumps_do_not_change_it() -> None:
    soft = {name: 0.5 * BARE[name] for name in ("a11", "a12")}
    stars, bumps = changed(5.0, lam_n=1.1 * BARE["lam_n"]), changed(5.0, lam_n=1.1 * BARE["lam_n"], **soft)
    assert gaussian_moduli(bumps, SPACING) == pytest.approx(gaussian_moduli(stars, SPACING))


def test_it_is_never_negative_and_bare_sites_have_none() -> None:
    assert not gaussian_moduli(changed(8.0, lam_n=0.9 * BARE["lam_n"]), SPACING).any()
    assert not gaussian_moduli(changed(0.0, lam_n=1.1 * BARE["lam_n"]), SPACING).any()
