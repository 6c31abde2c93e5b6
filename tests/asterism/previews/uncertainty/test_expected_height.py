"""How far off a preview expects its height to be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.previews.fields.star_values import star_values
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.session import Preview
from asterism.previews.uncertainty.height_error import (
    HeightDoubts,
    height_error_percent,
    inverted_bumps,
)
from fem.search.compliance import compliance
from fem.supports.loads import point_load
from pattern import gallery
from pattern.layout.build import layout
from tests.asterism.previews.laws import SPACING, plain_law

REACH = PREVIEW_MODEL.cell_radius

LOWEST, PART = PREVIEW_MODEL.lowest_point_share, PREVIEW_MODEL.height_share
LONG, FLAT = PREVIEW_MODEL.inverted_min_arm, PREVIEW_MODEL.inverted_max_curvature
DOME = gallery.load("dome")
PLAN = layout(DOME)
VALUES = star_values(DOME, PLAN, plain_law())
KAPPA, LAM = VALUES.value["kappa"][:-1], VALUES.value["lam"][:-1]


def test_doubts_add_up_as_independent_ones_do() -> None:
    sure = HeightDoubts(height=20.0, lowest=0.0, softness=0.0, turning=0.0)
    low, soft, both = (
        replace(sure, **more) for more in ({"lowest": 2.0}, {"softness": 50.0}, {"lowest": 2.0, "softness": 50.0})
    )
    base, one, other, together = (height_error_percent(d) or 0.0 for d in (sure, low, soft, both))
    assert base == pytest.approx(100.0 * PART)
    assert one == pytest.approx(np.hypot(base, 100.0 * LOWEST * 2.0 / 20.0))
    assert together**2 - base**2 == pytest.approx(one**2 - base**2 + other**2 - base**2)
    softer = replace(PREVIEW_MODEL, amplitude_share=2.0 * PREVIEW_MODEL.amplitude_share)
    assert (height_error_percent(soft, softer) or 0.0) > other


def test_flatter_sheets_are_less_sure() -> None:
    high, low = (HeightDoubts(height, lowest=0.3, softness=20.0, turning=0.0) for height in (20.0, 2.0))
    assert height_error_percent(low) > 3.0 * height_error_percent(high)
    assert height_error_percent(HeightDoubts(0.0, 0.0, 0.0, 0.0)) is None


def test_long_stars_turn_where_a_held_sheet_is_flat_and_not_pulled() -> None:
    long = VALUES.sizes[:, 0] >= LONG * SPACING
    assert 0 < long.sum() < len(long)
    bumps = 0.5 * VALUES.bump_curvature[:-1] * VALUES.sizes[:, 0] ** 2  # none of the arms is cut at the cell's end
    size = np.sqrt((bumps**2 * long).mean())
    flat, curled, narrow, wide = 0.9 * FLAT * KAPPA, 1.1 * FLAT * KAPPA, 0.99 * LAM**2, 1.01 * LAM**2
    assert size > 0.1
    assert inverted_bumps(VALUES, PLAN, flat, narrow) == pytest.approx(size)
    assert inverted_bumps(VALUES, PLAN, -curled, narrow) == pytest.approx(size)
    assert inverted_bumps(VALUES, PLAN, curled, narrow) == inverted_bumps(VALUES, PLAN, flat, wide) == 0.0
    assert inverted_bumps(VALUES, replace(PLAN, pins=()), flat, narrow) == 0.0


@pytest.mark.parametrize("name", ["dome", "tube"])
def test_doubts_of_a_preview_are_those_of_its_shape(name: str) -> None:
    """Free sheets are turned before they are measured, and the shell is not."""
    preview = Preview(gallery.load(name), plain_law())
    shape = preview.shape()
    summary = shape.summary
    doubts, z = summary["height_doubts_mm"], shape.positions[:, 2]
    assert doubts["height"] == summary["height_mm"] == pytest.approx(np.ptp(z))
    assert doubts["lowest"] == abs(shape.point_fields["bump_mm"][z.argmin(), 2])
    places, weights = preview.at(shape.printed).bumpy, shape.weights
    places = places - weights @ places
    up = np.linalg.eigh((weights[:, None] * places).T @ places)[1][:, 0] if name == "tube" else np.eye(3)[2]
    along = places @ up
    pull, push = (point_load(preview.sheet.space, shape.printed[i], up) for i in (along.argmax(), along.argmin()))
    apart = compliance(preview.shell, preview.equilibrium.x, preview.state.factor, pull - push)
    absolute_energy = sum(map(abs, summary["energy_parts_n_mm"].values()))
    assert doubts["softness"] == pytest.approx(np.sqrt(2.0 * absolute_energy * apart), rel=1e-6)
    assert doubts["softness"] > 0.1 * doubts["height"]


def test_stars_that_curl_to_the_other_side_turn_as_those_do() -> None:
    other = replace(VALUES, value=VALUES.value | {"kappa": -VALUES.value["kappa"]})
    flat, curled, narrow = 0.9 * FLAT * KAPPA, 1.1 * FLAT * KAPPA, 0.99 * LAM**2
    assert inverted_bumps(other, PLAN, -flat, narrow) == inverted_bumps(VALUES, PLAN, flat, narrow) > 0.0
    assert inverted_bumps(other, PLAN, -curled, narrow) == 0.0
    assert inverted_bumps(other, PLAN, curled, narrow) == inverted_bumps(VALUES, PLAN, flat, narrow)


def test_a_bump_is_no_larger_than_the_cell_of_its_star() -> None:
    far = replace(VALUES, sizes=VALUES.sizes + np.array([SPACING, 0.0, 0.0]))
    bumps = 0.5 * VALUES.bump_curvature[:-1] * (REACH * SPACING) ** 2
    found = inverted_bumps(far, PLAN, 0.9 * FLAT * KAPPA, 0.99 * LAM**2)
    assert found == pytest.approx(np.sqrt((bumps**2).mean()))
