"""How far off a preview expects its height to be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.session import Preview
from asterism.previews.uncertainty.height_error import HeightDoubts, height_error_percent
from fem.search.compliance import compliance
from fem.supports.loads import point_load
from pattern import gallery
from tests.asterism.previews.laws import plain_law

FLOOR, ACROSS = PREVIEW_MODEL.floor_percent, 100.0


def test_doubts_add_up_as_independent_ones_do() -> None:
    sure = HeightDoubts(height=20.0, lowest=0.0, softness=0.0)
    low, soft, both = (
        replace(sure, **more) for more in ({"lowest": 2.0}, {"softness": 50.0}, {"lowest": 2.0, "softness": 50.0})
    )
    base, one, other, together = (height_error_percent(d, ACROSS) or 0.0 for d in (sure, low, soft, both))
    assert base == pytest.approx(FLOOR * ACROSS / 20.0)
    assert one == pytest.approx(np.hypot(base, 100.0 * 2.0 / 20.0))
    assert together**2 - base**2 == pytest.approx(one**2 - base**2 + other**2 - base**2)
    softer = replace(PREVIEW_MODEL, amplitude_share=2.0 * PREVIEW_MODEL.amplitude_share)
    assert (height_error_percent(soft, ACROSS, softer) or 0.0) > other


def test_flatter_sheets_are_less_sure() -> None:
    high, low = (HeightDoubts(height, lowest=0.3, softness=20.0) for height in (20.0, 2.0))
    assert height_error_percent(low, ACROSS) > 3.0 * height_error_percent(high, ACROSS)
    assert height_error_percent(HeightDoubts(0.0, 0.0, 0.0), ACROSS) is None


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
