"""How far off a preview expects its height to be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.fem.search.linear_response import compliance, rms_of, stiffness_responses
from asterism.fem.supports.loads import point_load
from asterism.pattern import gallery
from asterism.previews.error_estimate import ErrorSources, HeightDoubts, height_error_percent
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.session import Preview
from tests.asterism.previews.laws import plain_law

ACROSS = 100.0
SURE = HeightDoubts(height=20.0, lowest=0.0, softness=0.0, stiffness=0.0)


def expected(doubts: HeightDoubts, size_ratio: float = np.inf, model: PreviewModel = PREVIEW_MODEL) -> float:
    return height_error_percent(ErrorSources(ACROSS, np.zeros(2), size_ratio=size_ratio, height=doubts), model) or 0.0


def test_doubts_add_up_as_independent_ones_do() -> None:
    changes: list[dict[str, float]] = [{"lowest": 2.0}, {"softness": 50.0}, {"stiffness": 3.0}]
    base, alone = expected(SURE), [expected(replace(SURE, **change)) for change in changes]
    together = expected(replace(SURE, lowest=2.0, softness=50.0, stiffness=3.0))
    assert base == pytest.approx(PREVIEW_MODEL.mesh_error_percent * ACROSS / 20.0)
    assert alone[0] == pytest.approx(np.hypot(base, 100.0 * 2.0 / 20.0))
    assert together**2 - base**2 == pytest.approx(sum(each**2 - base**2 for each in alone))
    softer = replace(PREVIEW_MODEL, energy_uncertainty=2.0 * PREVIEW_MODEL.energy_uncertainty)
    assert expected(replace(SURE, softness=50.0), model=softer) > alone[1]
    assert expected(SURE, size_ratio=0.8) > expected(SURE, size_ratio=1.2) == base


def test_flatter_sheets_are_less_sure() -> None:
    high, low = (HeightDoubts(height, lowest=0.3, softness=20.0, stiffness=1.0) for height in (20.0, 2.0))
    assert expected(low) > 3.0 * expected(high)
    assert height_error_percent(ErrorSources(ACROSS, np.zeros(2), height=replace(SURE, height=0.0))) is None
    assert height_error_percent(ErrorSources(ACROSS, np.zeros(2))) is None


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
    moves = stiffness_responses(preview.shell, preview.equilibrium.x, preview.state.factor)
    parted = preview.shell.restrict(pull - push) @ moves
    assert doubts["stiffness"] == pytest.approx(np.linalg.norm(parted), rel=1e-6)
    percent = 100.0 / summary["diameter_mm"] * rms_of(preview.shell, preview.equilibrium.x, moves)
    assert list(summary["stiffness_percent"].values()) == pytest.approx(percent, rel=1e-6)
