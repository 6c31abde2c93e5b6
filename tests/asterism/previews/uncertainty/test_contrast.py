"""How far a free sheet follows what the law says of unequal stars."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from asterism.previews.session import Preview
from asterism.shape.diameter import diameter
from fem.search.relax import follow
from pattern.design.design import Design
from pattern.geometry.rigid_fit import rigid_fit
from tests.asterism.previews.laws import plain_law

GROWING = {"from": 5.0, "to": 9.0, "profile": "radial", "over_mm": 40.0, "centre_mm": [0.0, 0.0]}
ERROR = 1e-4


def sheet(**stars: Any) -> Preview:
    return Preview(Design.from_dict({"border": {"rings": 2}, "stars": {"length_mm": 7.0, **stars}}), plain_law())


def test_equal_stars_leave_nothing_to_contrast():
    assert sheet().shape().summary["contrast_percent"] == 0.0


def test_held_sheets_are_not_asked():
    design = {"border": {"rings": 2}, "stars": {"length_mm": GROWING}, "pins": [{"where": "border", "scale": 0.8}]}
    assert Preview(Design.from_dict(design), plain_law()).shape().summary["contrast_percent"] == 0.0


@pytest.mark.parametrize("size", ["length_mm", "thickness_mm"])
def test_it_is_how_far_the_sheet_goes_for_another_law(size):
    """One whose contractions are wrong by a ten thousandth of the deviation of that size from the mean."""
    field = GROWING if size == "length_mm" else {**GROWING, "from": 0.4, "to": 0.3}
    preview = sheet(**{size: field})
    shape = preview.shape()
    summary, across = shape.summary, diameter(shape.positions)
    shell, values, start = preview.shell, preview.values, preview.equilibrium.x
    sizes = values.sizes[:, ("length_mm", "thickness_mm").index(size)]
    wrong = np.append(1.0 + ERROR * (sizes / sizes.mean() - 1.0), 1.0)
    value = values.value | {name: wrong * values.value[name] for name in ("lam", "lam_n")}
    shell = shell.with_fields(preview.sheet.fields(replace(values, value=value)))
    found = follow(shell, start, shell.factor())
    at = shell.space.locate(shell.points.reshape(-1, 2)).value
    before, after = at @ start, at @ found.x
    turn, shift = rigid_fit(after, before)
    apart = ((after @ turn.T + shift - before) ** 2).sum(axis=1)
    far = np.sqrt(np.average(apart, weights=shell.assembly.weights.ravel()))
    assert found.is_minimum
    assert summary["contrast_percent"] > 1.0
    assert far / ERROR == pytest.approx(summary["contrast_percent"] / 100.0 * across, rel=0.02)
