"""Materials from strips whose material is known."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binom

from asterism.measure.strips import arc
from asterism.measure.strips.settings import THICKNESSES_MM, KappaBarKind, StripFitSettings, StripFormula
from asterism.measure.strips.strip_fit import (
    FORMULAS,
    StripFit,
    UndeterminedMaterialError,
    fit_directions,
    fit_readings,
)
from asterism.measure.strips.strip_table import Reading
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature
from tests.asterism.measure.strips.synthetic import synthetic_readings

PAPER = 3200.0
# standard deviation of a thickness, the same for all its strips
WRONG_THICKNESSES: dict[str, Any] = {"reading_mm": 0.1, "scatter": 0.02, "count": 4, "off_mm": 0.01}


def exact(plastic: Plastic, stretch: float = 1.35, count: int = 3) -> list[Reading]:
    """Readings without errors, of curvatures in place of boxes."""
    bare = plastic.model_copy(update={"rest_curvature": "none"})
    return [
        replace(
            one,
            curvature_per_mm=float(
                rest_curvature(one.thickness_mm, Fabric(stretch=stretch), bare if one.peeled else plastic)
            ),
        )
        for one in synthetic_readings(0, stretch=stretch, count=count)
    ]


def fitted(readings: list[Reading], **settings: Any) -> StripFit:
    return fit_readings(readings, StripFitSettings(**settings))


def inside(fit: StripFit, ratio: float = PAPER) -> bool:
    return fit.found.low <= ratio <= fit.found.high


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_papers_strips_give_3200(seed: int) -> None:
    fit = fitted(synthetic_readings(seed))
    found = fit.ratio["paper"]
    assert inside(fit) and not fit.warnings
    assert (found.high - found.low) / found.value < 0.12
    assert found.value == pytest.approx(PAPER, rel=0.04)
    assert fit.kappa_bar[None].value == pytest.approx(0.003, rel=0.1)
    # what Timoshenko's formula makes of the same strips
    assert 0.44 < fit.ratio["timoshenko"].value / found.value < 0.5


@pytest.mark.slow
@settings(max_examples=20)
@given(
    ratio=st.floats(500, 20000),
    kept=st.floats(-0.002, 0.006),
    stretch=st.floats(1.1, 1.9),
    formula=st.sampled_from(FORMULAS),
)
def test_strips_without_errors_give_their_material(
    ratio: float, kept: float, stretch: float, formula: StripFormula
) -> None:
    plastic = Plastic(modulus_ratio=ratio, kappa_bar_per_mm=kept, rest_curvature=formula)
    readings = exact(plastic, stretch)
    for some in (readings, [r for r in readings if not r.peeled]):
        fit = fitted(some, rest_curvature=formula)
        assert fit.ratio[formula].value == pytest.approx(ratio, rel=1e-6)
        assert fit.kappa_bar[None].value == pytest.approx(kept, abs=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "kappa_bar", "is_peeled"),
    [
        ({}, "constant", True),
        ({"reading_mm": 0.05, "scatter": 0.05, "count": 4}, "constant", True),
        (WRONG_THICKNESSES, "constant", True),
        (WRONG_THICKNESSES, "per-thickness", True),
        (WRONG_THICKNESSES, "constant", False),
        # rounded to a ruler, and looking flat: errors that repeats do not average
        ({"reading_mm": 0.05, "step_mm": 0.5}, "constant", True),
        ({"reading_mm": 0.5, "flat_mm": 0.5, "count": 4}, "constant", True),
    ],
)
def test_intervals_hold_the_truth_as_often_as_they_say(
    case: dict[str, Any], kappa_bar: KappaBarKind, is_peeled: bool
) -> None:
    """Fewer of 150 campaigns have a chance of 1 in 1000 at 95 %; more are too many where errors are random."""
    campaigns = [synthetic_readings(seed, Plastic(kappa_bar_per_mm=0.003), **case) for seed in range(150)]
    fits = [fitted([r for r in c if is_peeled or not r.peeled], kappa_bar=kappa_bar) for c in campaigns]
    least, most = binom.ppf([0.001, 0.999], len(fits), 0.95)
    assert sum(inside(fit) for fit in fits) >= least
    kept = [list(fit.kappa_bar.values())[-1] for fit in fits]
    held = sum(low <= 0.003 <= high for _, low, high in kept)
    assert held >= least
    if not {"step_mm", "flat_mm"} & set(case):
        assert held <= most
    # a good table is not called a bad one
    assert sum(len(fit.outliers) > 0 for fit in fits) <= 7


@pytest.mark.slow
@pytest.mark.parametrize("case", [{}, {"off_mm": 0.01}])
def test_strips_in_two_directions_give_both_moduli_as_often_as_their_intervals_say(case: dict[str, Any]) -> None:
    held = np.zeros(2)
    for seed in range(60):
        part = np.sqrt(np.random.default_rng(seed).uniform(1.0, 3.0))
        readings = synthetic_readings(seed, moduli=(7.0 * part, 7.0 / part), **case)
        fits = fit_directions(readings, StripFitSettings())
        truths = (PAPER / part, PAPER * part)
        held += [inside(fit, truth) for fit, truth in zip(fits, truths, strict=True)]
    assert held.min() >= binom.ppf(0.001, 60, 0.95)


def test_directions_that_do_not_determine_a_material() -> None:
    readings = synthetic_readings(0, moduli=(10.0, 5.0))
    only_along = [r for r in readings if r.peeled or r.direction == "along"]
    with pytest.raises(UndeterminedMaterialError, match=r"^strips across the grain: no strip was measured"):
        fit_directions(only_along, StripFitSettings())
    with pytest.raises(UndeterminedMaterialError, match=r"^strips in two directions and none peeled"):
        fit_directions([r for r in readings if not r.peeled], StripFitSettings())


def test_outliers_are_named_and_used() -> None:
    strips = synthetic_readings(2)
    wrong = {6: 0.045, 17: 0.009, 40: 0.035}
    off = [replace(r, curvature_per_mm=wrong.get(i, r.curvature_per_mm)) for i, r in enumerate(strips)]
    fit = fitted(off)
    assert {one.name for one, _ in fit.outliers} == {strips[i].name for i in wrong}
    assert all(any(one.name in line and "it is used" in line for line in fit.warnings) for one, _ in fit.outliers)
    assert len(fit.used) == 80 and not fit.left_out and inside(fit)
    width = [high - low for _, low, high in (fitted(strips).ratio["paper"], fit.ratio["paper"])]
    assert width[1] > 2 * width[0]
    # of few strips too
    few = synthetic_readings(3, count=2)
    few[0] = replace(few[0], curvature_per_mm=0.06)
    assert few[0] in [one for one, _ in fitted(few).outliers]


def test_a_wrong_thickness_is_named_and_widens_the_interval() -> None:
    good = synthetic_readings(1)
    fit = fitted([replace(r, thickness_mm=0.26) if r.thickness_mm == 0.3 else r for r in good])
    assert any("0.26 mm" in line and "check their thickness" in line for line in fit.warnings)
    assert inside(fit) and not fit.outliers
    width = [high - low for _, low, high in (fitted(good).ratio["paper"], fit.ratio["paper"])]
    assert width[1] > 3 * width[0]


def test_a_kappa_bar_for_each_thickness() -> None:
    table = {"thickness_mm": THICKNESSES_MM, "per_mm": (0.006, 0.004, 0.002, 0.001)}
    strips = synthetic_readings(4, Plastic(kappa_bar_per_mm=table))
    fit = fitted(strips, kappa_bar="per-thickness")
    assert inside(fit) and list(fit.kappa_bar) == list(THICKNESSES_MM) and not fit.warnings
    for value, interval in zip(table["per_mm"], fit.kappa_bar.values(), strict=True):
        assert interval.low - 1e-4 < value < interval.high + 1e-4
    kept = fit.plastic().kappa_bar_per_mm
    assert kept.per_mm == tuple(one.value for one in fit.kappa_bar.values())  # type: ignore[union-attr]
    assert any("try --kappa-bar per-thickness" in line for line in fitted(strips).warnings)


def test_peeled_strips_that_curl_contradict_zero() -> None:
    fit = fitted(synthetic_readings(4), kappa_bar="zero")
    assert not fit.kappa_bar and any("try --kappa-bar constant" in line for line in fit.warnings)
    straight = fitted(synthetic_readings(4, Plastic()), kappa_bar="zero")
    assert inside(straight) and not straight.warnings


def test_peeled_strips_that_look_flat_bound_kappa_bar() -> None:
    strips = [replace(r, curvature_per_mm=None) if r.peeled else r for r in synthetic_readings(0, Plastic())]
    fit = fitted(strips)
    assert fit.kappa_bar[None] == pytest.approx((0.0, -4 / 60**2, 4 / 60**2)) and inside(fit)


def test_one_thickness_gives_an_interval_by_its_repeats() -> None:
    strips = [r for r in synthetic_readings(0) if r.thickness_mm == 0.3]
    fit = fitted(strips)
    assert inside(fit) and fit.freedom > 8
    assert any("print more thicknesses" in line for line in fit.warnings)


def test_strips_that_hardly_bend_leave_no_upper_bound() -> None:
    strips = synthetic_readings(0, Plastic(modulus_ratio=1e5), reading_mm=0.5, count=2)
    fit = fitted(strips, kappa_bar="zero")
    assert np.isinf(fit.ratio["paper"].high) and any("no upper bound" in line for line in fit.warnings)


def test_only_flat_strips_leave_a_bound() -> None:
    strips = [replace(r, curvature_per_mm=None) for r in synthetic_readings(0)]
    # the thinnest strip: 88.3/ratio < 8 * 0.5 / 60^2
    bound = float(rest_curvature(0.3, Fabric(), Plastic(modulus_ratio=1.0))) / (8 * 0.5 / 60**2)
    with pytest.raises(UndeterminedMaterialError, match=f"above {bound:.0f}"):
        fitted(strips)


@pytest.mark.parametrize(
    ("keep", "kappa_bar", "problem"),
    [
        (lambda r: r.peeled, "constant", "with its fabric"),
        (lambda r: not r.peeled and r.thickness_mm == 0.3, "constant", "peel some"),
        (lambda r: not (r.peeled and r.thickness_mm == 0.35), "per-thickness", "no strip of 0.35 mm"),
        (lambda r: r.strip == "1", "constant", "too few"),
    ],
)
def test_too_little(keep, kappa_bar, problem) -> None:
    with pytest.raises(UndeterminedMaterialError, match=problem):
        fitted([r for r in synthetic_readings(0) if keep(r)], kappa_bar=kappa_bar)


@pytest.mark.parametrize(
    ("strips", "formula"),
    [
        ([(0.3, 1.0, False)] * 4 + [(0.3, 0.0, True)] * 2, "paper"),
        ([(0.4, 0.0, False), (0.05, 0.01, False), (0.3, 0.0, False), (5.0, 0.02, False)], "timoshenko"),
        ([(0.3, 0.003, False)] * 3 + [(0.3, 0.004, True)] * 3, "paper"),
    ],
)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_strips_that_no_plastic_makes_are_refused(
    strips: list[tuple[float, float, bool]], formula: StripFormula
) -> None:
    like = synthetic_readings(0)[0]
    given = [replace(like, thickness_mm=h, curvature_per_mm=k, peeled=bare) for h, k, bare in strips]
    peeled: KappaBarKind = "constant" if any(bare for *_, bare in strips) else "zero"
    with pytest.raises(UndeterminedMaterialError, match=r"no plastic on this fabric|no more than peeled ones"):
        fitted(given, rest_curvature=formula, kappa_bar=peeled)


angles = st.floats(1e-4, 2 * np.pi - 1e-3)
radii = st.floats(1.0, 1e4)


def drawn_box(angle: float, radius: float, thickness: float = 0.0) -> tuple[float, float]:
    """Box of many points of an arc that lies on both sides of the top of its circle, or of its two sides."""
    turn = np.linspace(-angle / 2, angle / 2, 20001)
    rings = [(r * np.sin(turn), r * np.cos(turn)) for r in (radius - thickness / 2, radius + thickness / 2)]
    x, y = np.concatenate(rings, axis=1)
    return float(np.ptp(x)), float(np.ptp(y))


@given(angle=angles, radius=radii)
def test_a_box_is_that_of_the_drawn_arc_and_gives_it_back(angle: float, radius: float) -> None:
    """Beyond half a circle, too, where the box's width is the diameter."""
    width, height = arc.box(1 / radius, angle * radius)
    assert (width, height) == pytest.approx(drawn_box(angle, radius), rel=1e-6, abs=1e-9 * radius)
    assert float(arc.curvature(width, height)) == pytest.approx(1 / radius, rel=1e-9)
    assert float(arc.arc_length(width, height)) == pytest.approx(angle * radius, rel=1e-6)


def test_a_flat_box() -> None:
    assert float(arc.curvature(60.0, 0.0)) == 0.0
    assert float(arc.arc_length(60.0, 0.0)) == 60.0
    assert [float(side) for side in arc.box(0.0, 60.0)] == pytest.approx([60.0, 0.0])
    assert arc.line_box(60.0, 1.0, 1.1) == (60.0, 0.0)
    with pytest.raises(ValueError, match="does not bend"):
        arc.line_box(4.0, 3.0, 1.1)


@given(angle=st.floats(0.05, 6.0), thickness=st.floats(0.1, 1.5))
def test_outside_of_a_thick_strip(angle: float, thickness: float) -> None:
    radius = 30.0
    width, height = drawn_box(angle, radius, thickness)
    if width > 4 * thickness:
        found = arc.line_box(width, height, thickness)
        # the box of the line is that of its own arc, up to what the drawn points leave out
        assert found == pytest.approx(drawn_box(angle, radius), rel=1e-4, abs=1e-4)
