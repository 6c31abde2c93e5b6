"""The error that a preview expects of itself, of its shape and of its height."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.linear_response import compliance, rms_of, stiffness_responses
from asterism.fem.supports.loads import point_load
from asterism.pattern import gallery
from asterism.previews.error_estimate import (
    COVERAGE,
    ErrorEstimate,
    ErrorSources,
    HeightDoubts,
    distance_error_percent,
    distance_parts,
    height_error_percent,
)
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.other_forms import OtherForm, close_form
from asterism.previews.search_minima import amplitudes_percent, has_two_near_zero_modes
from asterism.previews.session import Preview
from asterism.previews.warnings import CAUSES, FAR_PERCENT, form_warnings
from tests.asterism.previews.laws import plain_law

UNSURE, MESH = PREVIEW_MODEL.energy_uncertainty, PREVIEW_MODEL.mesh_error_percent
STIFF = np.zeros(2)

# a state with a certified minimum, as far as warnings of other forms ask
MINIMUM: Any = SimpleNamespace(
    equilibrium=SimpleNamespace(guess="cap", converged=True, definite=True), is_supported=True
)


def expected(amplitudes: Floats, **more: Any) -> float:
    return distance_error_percent(ErrorSources(100.0, amplitudes, **more)) or 0.0


def test_amplitudes_take_the_energy():
    """Half the eigenvalue times area times the mean square is the energy."""
    modes, energy, area, diameter = np.array([2e-4, 5e-5]), 20.0, 9000.0, 100.0
    found = amplitudes_percent(modes, energy, area, diameter)
    assert 0.5 * modes[::-1] * area * (found * diameter / 100.0) ** 2 == pytest.approx([energy, energy])


def test_softer_sheets_expect_more():
    found = [expected(np.array([a, 0.7 * a, 0.3 * a])) for a in (1.0, 5.0, 20.0, 40.0, 80.0)]
    assert all(one < other for one, other in pairwise(found))


def test_the_error_of_the_energy_is_a_force_on_each_mode():
    """With the energy k x^2/2 of a mode and an error u E x/a of it, the minimum moves to -u a/2."""
    stiffness, energy = 0.3, 20.0
    amplitude = np.sqrt(2.0 * energy / stiffness)
    x = np.linspace(-amplitude, amplitude, 200001)
    moved = abs(x[(0.5 * stiffness * x**2 + UNSURE * energy * x / amplitude).argmin()])
    parts = distance_parts(ErrorSources(100.0, np.array([amplitude, 0.0])))
    assert parts["soft"] == pytest.approx(moved, rel=1e-3)


def test_contributions_add_as_independent_errors():
    soft, stiffness = np.array([30.0, 12.0, 8.0]), np.array([2.0, 1.0, 0.5, 0.1])
    alone = [expected(soft), expected(STIFF, stiffness_percent=stiffness), expected(STIFF, size_ratio=0.8)]
    together = expected(soft, stiffness_percent=stiffness, size_ratio=0.8)
    assert together**2 - MESH**2 == pytest.approx(sum(each**2 - MESH**2 for each in alone))


def test_only_sheets_that_are_held_narrower_count_as_narrow():
    assert expected(STIFF, size_ratio=1.2) == expected(STIFF, size_ratio=np.inf) == expected(STIFF) == MESH
    assert MESH < expected(STIFF, size_ratio=0.9) < expected(STIFF, size_ratio=0.8)


def test_forms_count_by_the_chance_that_they_are_lower():
    """Of a normal error of the energies: one in two at equal ones, .1587 one standard deviation above."""
    for gap, chance in ((0.0, 0.5), (UNSURE, 0.158655), (-UNSURE, 0.841345)):
        found = expected(STIFF, other_forms=(OtherForm("arc", 1.0, gap, 60.0),))
        assert found == pytest.approx(np.hypot(MESH, COVERAGE * 60.0 * np.sqrt(chance)), rel=1e-5)


def test_the_main_part_is_the_largest():
    other = (OtherForm("arc", 1.0, 0.0, 30.0),)
    cases = {
        "soft": ErrorSources(100.0, np.array([90.0, 30.0])),
        "stiffness": ErrorSources(100.0, STIFF, stiffness_percent=np.full(4, 5.0)),
        "narrow": ErrorSources(100.0, STIFF, size_ratio=0.8),
        "form": ErrorSources(100.0, np.array([90.0, 30.0]), size_ratio=0.8, other_forms=other),
    }
    for name, sources in cases.items():
        estimate = ErrorEstimate.of(sources, PREVIEW_MODEL, is_known=True)
        assert estimate.main_part == name and (estimate.distance_percent or 0.0) > MESH
        (line, *_) = form_warnings(MINIMUM, estimate)
        assert line.startswith("the exact shape may be") and CAUSES[name] in line
    unknown = ErrorEstimate.of(cases["soft"], PREVIEW_MODEL, is_known=False)
    assert unknown.distance_percent is None and unknown.height_percent is None
    assert not list(form_warnings(MINIMUM, unknown))
    (line,) = form_warnings(MINIMUM, ErrorEstimate.of(cases["narrow"], PREVIEW_MODEL, is_known=False))
    assert line.startswith(CAUSES["narrow"])
    small = replace(unknown, distance_percent=0.99 * FAR_PERCENT)
    assert not list(form_warnings(MINIMUM, small))


def test_one_soft_motion_is_forgiven():
    """The turn of a tube's axis alone does not make another form."""
    assert not has_two_near_zero_modes(np.array([80.0, 10.0]))
    assert has_two_near_zero_modes(np.array([80.0, 40.0]))


def test_nothing_is_expected_of_what_is_not_stable():
    assert distance_error_percent(ErrorSources(100.0, np.empty(0))) is None
    assert not has_two_near_zero_modes(np.empty(0))


def test_the_lowest_form_within_the_energies_doubt_might_be_the_right_one():
    far, near, nearer = (OtherForm("arc", 1.0, part * UNSURE, 60.0) for part in (1.1, 0.9, 0.5))
    assert close_form([far], UNSURE) is None
    assert close_form([near, far], UNSURE) is near
    assert close_form([nearer, near, far], UNSURE) is nearer


ACROSS = 100.0
SURE = HeightDoubts(height=20.0, lowest=0.0, softness=0.0, stiffness=0.0)


def expected_height(doubts: HeightDoubts, size_ratio: float = np.inf, model: PreviewModel = PREVIEW_MODEL) -> float:
    return height_error_percent(ErrorSources(ACROSS, np.zeros(2), size_ratio=size_ratio, height=doubts), model) or 0.0


def test_doubts_add_up_as_independent_ones_do() -> None:
    changes: list[dict[str, float]] = [{"lowest": 2.0}, {"softness": 50.0}, {"stiffness": 3.0}]
    base, alone = expected_height(SURE), [expected_height(replace(SURE, **change)) for change in changes]
    together = expected_height(replace(SURE, lowest=2.0, softness=50.0, stiffness=3.0))
    assert base == pytest.approx(PREVIEW_MODEL.mesh_error_percent * ACROSS / 20.0)
    assert alone[0] == pytest.approx(np.hypot(base, 100.0 * 2.0 / 20.0))
    assert together**2 - base**2 == pytest.approx(sum(each**2 - base**2 for each in alone))
    softer = replace(PREVIEW_MODEL, energy_uncertainty=2.0 * PREVIEW_MODEL.energy_uncertainty)
    assert expected_height(replace(SURE, softness=50.0), model=softer) > alone[1]
    assert expected_height(SURE, size_ratio=0.8) > expected_height(SURE, size_ratio=1.2) == base


def test_flatter_sheets_are_less_sure() -> None:
    high, low = (HeightDoubts(height, lowest=0.3, softness=20.0, stiffness=1.0) for height in (20.0, 2.0))
    assert expected_height(low) > 3.0 * expected_height(high)
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
