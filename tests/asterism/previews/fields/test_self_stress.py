"""What stars gain by Gaussian curvature goes with the pull of the fabric alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from asterism.equilibrium.arrays import Floats
from asterism.pattern import gallery
from asterism.pattern.layout.build import layout
from asterism.previews.fields.sheet_fields import gaussian_moduli
from asterism.previews.fields.star_values import star_values
from asterism.previews.model import PREVIEW_MODEL
from tests.asterism.previews.laws import plain_law

DESIGN = gallery.load("tube")
PLAN = layout(DESIGN)
VALUES = star_values(DESIGN, PLAN, plain_law())


def moduli(length: float, **stars: float) -> Floats:
    """(S,) of stars with arms of a length and other values of the law; the bare fabric as it was."""
    value = {name: of.copy() for name, of in VALUES.value.items()}
    for name, number in stars.items():
        value[name][:-1] = number
    sizes = VALUES.sizes.copy()
    sizes[:, 0] = length
    return gaussian_moduli(replace(VALUES, value=value, sizes=sizes), PLAN.spacing_mm)


BARE = {name: float(VALUES.value[name][-1]) for name in ("a11", "a12", "lam_n")}


def test_it_is_the_pull_of_the_fabric_by_a_share_of_the_squared_spacing() -> None:
    pull = 0.5 * (BARE["a11"] + BARE["a12"]) * (1.04**2 - 1.0) * BARE["lam_n"] ** 2
    for length in (4.0, 10.0):
        found = moduli(length, lam_n=1.04 * BARE["lam_n"])
        assert found == pytest.approx(PREVIEW_MODEL.gaussian_area * PLAN.spacing_mm**2 * pull)
    # bumps, which are softer, do not change it
    assert moduli(10.0, lam_n=1.04 * BARE["lam_n"], a11=0.5 * BARE["a11"], a12=0.5 * BARE["a12"]) == pytest.approx(
        found
    )


def test_it_is_never_negative_and_bare_sites_have_none() -> None:
    assert not moduli(8.0, lam_n=0.9 * BARE["lam_n"]).any()
    assert not moduli(0.0, lam_n=1.1 * BARE["lam_n"]).any()
