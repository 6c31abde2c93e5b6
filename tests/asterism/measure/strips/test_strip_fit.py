"""Materials from strips whose material is known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from asterism.measure.strips.curvature_model import FORMULAS, StripFormula
from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.likelihood import flat_terms
from asterism.measure.strips.reading import Reading
from asterism.measure.strips.specimen import THICKNESSES_MM
from asterism.measure.strips.statement import fit_warnings
from asterism.measure.strips.strip_fit import StripFit, fit_readings
from asterism.measure.strips.synthetic import synthetic_readings
from asterism.measure.strips.systematic import shared_errors
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature

PAPER = 3200.0


def inside(fit: StripFit, ratio: float = PAPER) -> bool:
    found = fit.ratio[fit.formula]
    return found.low <= ratio <= found.high


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_papers_strips_give_3200(seed: int) -> None:
    fit = fit_readings(synthetic_readings(seed))
    found = fit.ratio["paper"]
    assert inside(fit)
    assert (found.high - found.low) / found.value < 0.08
    assert found.value == pytest.approx(PAPER, rel=0.04)
    assert fit.kappa_bar[None].value == pytest.approx(0.003, rel=0.1)
    # what Timoshenko's formula makes of the same strips
    assert 0.44 < fit.ratio["timoshenko"].value / found.value < 0.5


@pytest.mark.slow
def test_intervals_contain_the_true_material_of_the_usual_tables() -> None:
    """Of 12 tables 95 % are 11; fewer than 10 has a chance of 1 in 50. The slow tests count more and other tables."""
    fits = [fit_readings(synthetic_readings(seed, reading_mm=0.3, scatter=0.03)) for seed in range(12)]
    assert sum(inside(fit) for fit in fits) >= 10
    kept = [fit.kappa_bar[None] for fit in fits]
    assert sum(interval.low <= 0.003 <= interval.high for interval in kept) >= 10


@pytest.mark.slow
@pytest.mark.parametrize(
    ("reading_mm", "scatter", "flat_mm"), [(0.3, 0.03, 0.0), (0.05, 0.05, 0.0), (0.4, 0.0, 0.0), (0.5, 0.02, 0.5)]
)
def test_intervals_hold_the_truth_as_often_as_they_say(reading_mm: float, scatter: float, flat_mm: float) -> None:
    """Of 60 tables: 95 % are 57; fewer than 52 (more than 60 is impossible) has a chance of 1 in 100."""
    fits = [
        fit_readings(
            synthetic_readings(seed, reading_mm=reading_mm, scatter=scatter, flat_mm=flat_mm),
            flat_height_mm=flat_mm or 0.5,
        )
        for seed in range(60)
    ]
    assert sum(inside(fit) for fit in fits) >= 52
    kept = [fit.kappa_bar[None] for fit in fits]
    assert sum(interval.low <= 0.003 <= interval.high for interval in kept) >= 52


@pytest.mark.slow
@pytest.mark.parametrize(("reading_mm", "step_mm", "count"), [(0.05, 0.5, 10), (0.3, 1.0, 10), (0.02, 1.0, 4)])
def test_boxes_read_to_the_marks_of_a_ruler_are_good_tables(reading_mm: float, step_mm: float, count: int) -> None:
    """Most peeled strips read the same; the next mark is no contradiction, and all may be off together."""
    rng = np.random.default_rng(3)
    fits, kept = [], rng.uniform(0.0021, 0.0045, 40)
    for seed, kappa in enumerate(kept):
        plastic = Plastic(kappa_bar_per_mm=float(kappa))
        fits.append(
            fit_readings(synthetic_readings(seed, plastic, count=count, reading_mm=reading_mm, step_mm=step_mm))
        )
    # of 40 tables 95 % are 38; fewer than 33 has a chance of 1 in 1000
    assert sum(inside(fit) for fit in fits) >= 33
    intervals = [fit.kappa_bar[None] for fit in fits]
    assert sum(one.low <= kappa <= one.high for one, kappa in zip(intervals, kept, strict=True)) >= 33
    assert sum(len(fit.left_out) == 0 for fit in fits) >= 33
    assert min(fit.noise.reading_mm for fit in fits) >= step_mm / np.sqrt(12.0)


@pytest.mark.parametrize("off_mm", [0.0, 0.01, 0.02])
def test_equal_readings_of_a_ruler_do_not_widen_intervals_without_end(off_mm: float) -> None:
    """All strips of a kind read the same marks, and one thickness is not what the table says."""
    strips = synthetic_readings(0, count=3, reading_mm=0.0, scatter=0.0, step_mm=0.5)
    off = [replace(one, thickness_mm=one.thickness_mm + off_mm * (one.thickness_mm == 0.35)) for one in strips]
    fit = fit_readings(off)
    found = fit.ratio["paper"]
    assert fit.widened < 5.0 and 2500.0 < found.low < PAPER < found.high < 4000.0


@pytest.mark.slow
def test_good_strips_read_to_whole_millimetres_lose_no_reading() -> None:
    """A kappa_bar for each thickness: ten strips of which most read the same mark."""
    lost = 0
    for seed in range(30):
        strips = synthetic_readings(seed, reading_mm=0.3, step_mm=1.0)
        lost += bool(fit_readings(strips, kappa_bar="per-thickness").left_out)
    assert lost <= 2  # of 30 tables .3 are to lose one


@pytest.mark.slow
def test_half_of_the_narrow_intervals_miss_and_good_strips_are_rarely_called_outliers() -> None:
    """An interval that always holds the truth says nothing."""
    narrow = [fit_readings(synthetic_readings(seed, count=5), confidence=0.5) for seed in range(40)]
    assert 10 <= sum(inside(fit) for fit in narrow) <= 30
    # whatever the confidence of the intervals
    assert sum(len(fit.left_out) for fit in narrow) <= 4
    for fit, seed in zip(narrow[:3], range(3), strict=True):
        assert fit_readings(synthetic_readings(seed, count=5)).left_out == fit.left_out


@pytest.mark.slow
@settings(max_examples=10, deadline=None)
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
    # short enough that no arc closes
    exact = synthetic_readings(0, plastic, reading_mm=0.0, scatter=0.0, length=20.0, stretch=stretch, count=3)
    exact = [replace(r, curvature_per_mm=_curvature(r, plastic)) for r in exact]
    fit = fit_readings(exact, formula)
    assert fit.ratio[formula].value == pytest.approx(ratio, rel=1e-5)
    assert fit.kappa_bar[None].value == pytest.approx(kept, abs=1e-7)


def _curvature(reading: object, plastic: Plastic) -> float:
    r = reading
    if r.peeled:  # type: ignore[attr-defined]
        return float(plastic.kappa_bar_per_mm)  # type: ignore[arg-type]
    return float(rest_curvature(r.thickness_mm, Fabric(stretch=r.stretch), plastic))  # type: ignore[attr-defined]


@settings(max_examples=3, deadline=None)
@given(order=st.permutations(range(40)))
def test_the_order_of_the_strips_does_not_matter(order: list[int]) -> None:
    strips = synthetic_readings(5, count=5)
    one, other = fit_readings(strips), fit_readings([strips[i] for i in order])
    assert other.ratio["paper"].value == pytest.approx(one.ratio["paper"].value, rel=1e-6)
    assert other.ratio["paper"].high == pytest.approx(one.ratio["paper"].high, rel=1e-6)


def test_outliers_are_named_and_left_out() -> None:
    strips = synthetic_readings(2)
    wrong = {6: 0.045, 17: 0.009, 40: 0.035}
    strips = [replace(r, curvature_per_mm=wrong.get(i, r.curvature_per_mm)) for i, r in enumerate(strips)]
    fit = fit_readings(strips)
    assert {out.reading.name for out in fit.left_out} == {strips[i].name for i in wrong}
    assert all("standard deviations" in out.reason for out in fit.left_out)
    assert inside(fit)
    kept = fit_readings(strips, keep_outliers=True)
    assert not kept.left_out and len(kept.used) == 80
    width = [found.high - found.low for found in (fit.ratio["paper"], kept.ratio["paper"])]
    assert width[1] > 2 * width[0]


def test_readings_that_contradict_each_other_are_refused() -> None:
    wild = np.random.default_rng(0).uniform(0.05, 0.1, 80)
    strips = [replace(r, curvature_per_mm=wild[i]) if i % 5 < 2 else r for i, r in enumerate(synthetic_readings(2))]
    with pytest.raises(
        UndeterminedMaterialError, match="contradict the others: measure again, or give --keep-outliers"
    ):
        fit_readings(strips)


def test_a_kappa_bar_for_each_thickness() -> None:
    table = {"thickness_mm": THICKNESSES_MM, "per_mm": (0.006, 0.004, 0.002, 0.001)}
    strips = synthetic_readings(4, Plastic(kappa_bar_per_mm=table))
    fit = fit_readings(strips, kappa_bar="per-thickness")
    assert inside(fit)
    assert list(fit.kappa_bar) == list(THICKNESSES_MM)
    for value, interval in zip(table["per_mm"], fit.kappa_bar.values(), strict=True):
        assert interval.low - 1e-4 < value < interval.high + 1e-4
    assert (
        fit_readings(strips).kappa_bar_contradicted and not fit_readings(synthetic_readings(4)).kappa_bar_contradicted
    )
    plastic = fit.plastic()
    assert float(rest_curvature(0.3, Fabric(), plastic)) == pytest.approx(
        float(rest_curvature(0.3, Fabric(), Plastic(kappa_bar_per_mm=0.006))), rel=0.03
    )


def test_peeled_strips_that_curl_contradict_zero() -> None:
    said = fit_warnings(fit_readings(synthetic_readings(4), kappa_bar="zero"))
    assert any("try --kappa-bar constant" in line for line in said) and not any("thicknesses" in line for line in said)
    assert not fit_readings(synthetic_readings(4, Plastic()), kappa_bar="zero").kappa_bar_contradicted


@pytest.mark.parametrize(
    ("strips", "formula"),
    [
        ([(0.3, 1.0, False)] * 4 + [(0.3, 0.0, True)], "paper"),
        ([(0.3, 0.4, False)] * 3, "paper"),
        ([(0.45, 0.4, False)] * 3, "paper"),
        ([(0.05, 1.0, False)] * 3, "timoshenko"),
        ([(0.4, 0.0, False), (0.05, 0.01, False), (0.3, 0.0, False), (5.0, 0.02, False)], "timoshenko"),
    ],
)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_strips_that_no_plastic_makes_are_refused(
    strips: list[tuple[float, float, bool]], formula: StripFormula
) -> None:
    like = synthetic_readings(0)[0]
    given = [replace(like, thickness_mm=h, curvature_per_mm=k, peeled=bare) for h, k, bare in strips]
    with pytest.raises(UndeterminedMaterialError, match=r"no plastic on this fabric|contradict the others"):
        fit_readings(given, formula, "zero")


def test_without_peeled_strips_the_thicknesses_tell() -> None:
    strips = [r for r in synthetic_readings(6) if not r.peeled]
    fit = fit_readings(strips)
    assert inside(fit)
    both = fit_readings(synthetic_readings(6)).ratio["paper"]
    assert fit.ratio["paper"].high - fit.ratio["paper"].low > 2 * (both.high - both.low)
    bare = [r for r in synthetic_readings(6, Plastic()) if not r.peeled]
    assert inside(fit_readings(bare, kappa_bar="zero"))


@pytest.mark.slow
def test_flat_strips_count_with_their_bound() -> None:
    """Thick strips that look flat keep E1/E2 from being too small; taken for straight they would spoil it."""
    plastic = Plastic(modulus_ratio=20000.0, kappa_bar_per_mm=0.0)
    hits, straight = 0, 0
    for seed in range(12):
        strips = synthetic_readings(seed, plastic, reading_mm=0.15, length=45.0, flat_mm=0.5)
        flat = [r for r in strips if r.curvature_per_mm is None]
        assert len(flat) > 15
        hits += inside(fit_readings(strips, kappa_bar="zero"), 20000.0)
        zeros = [replace(r, curvature_per_mm=r.curvature_per_mm or 0.0) for r in strips]
        try:
            straight += inside(fit_readings(zeros, kappa_bar="zero", keep_outliers=True), 20000.0)
        except UndeterminedMaterialError as refused:  # so far from the formula that they tell nothing
            assert "contradict the formula" in str(refused)
    assert hits >= 10
    assert straight < hits


def test_only_flat_strips_leave_a_bound() -> None:
    strips = [replace(r, curvature_per_mm=None) for r in synthetic_readings(0)]
    with pytest.raises(UndeterminedMaterialError, match="above") as caught:
        fit_readings(strips)
    # the thinnest strip: 88.3/ratio < 8 * 0.5 / 60^2
    bound = float(rest_curvature(0.3, Fabric(), Plastic(modulus_ratio=1.0))) / (8 * 0.5 / 60**2)
    assert f"above {bound:.0f}" in str(caught.value)


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
        fit_readings([r for r in synthetic_readings(0) if keep(r)], kappa_bar=kappa_bar)


@pytest.mark.parametrize(
    "wrong", [{"formula": "stoney"}, {"kappa_bar": "none"}, {"confidence": 95.0}, {"flat_height_mm": 0.0}]
)
def test_impossible_choices_are_named(wrong) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        fit_readings(synthetic_readings(0), **wrong)


def test_a_wrong_thickness_widens_the_interval() -> None:
    strips = [replace(r, thickness_mm=0.43) if r.thickness_mm == 0.45 else r for r in synthetic_readings(1)]
    fit = fit_readings(strips, keep_outliers=True)
    assert fit.lack_of_fit is not None and fit.lack_of_fit < 0.01 and fit.widened > 1.5
    good = fit_readings(synthetic_readings(1))
    assert not good.disagrees and good.widened < 1.3


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_strips_of_a_wrong_thickness_are_no_outliers(seed: int) -> None:
    """They are used, named, and the wide interval holds the truth; a stray one among them still is an outlier."""
    strips = [replace(r, thickness_mm=0.26) if r.thickness_mm == 0.3 else r for r in synthetic_readings(seed)]
    fit = fit_readings(strips)
    assert not fit.left_out and fit.thicknesses_apart == (0.26,) and fit.widened > 1.5 and inside(fit)
    assert any("check the thicknesses, that of the strips of 0.26 mm first" in line for line in fit_warnings(fit))
    strips[4] = replace(strips[4], curvature_per_mm=0.05)
    again = fit_readings(strips)
    assert [out.reading.name for out in again.left_out] == [strips[4].name] and inside(again)
    assert not fit_readings(synthetic_readings(seed)).thicknesses_apart


@pytest.mark.slow
@pytest.mark.parametrize(("reading_mm", "scatter"), [(0.3, 0.03), (0.1, 0.02), (0.02, 0.003)])
def test_intervals_hold_the_truth_though_thicknesses_are_off(reading_mm: float, scatter: float) -> None:
    """Of 40 tables 95 % are 38; fewer than 33 has a chance of 1 in 1000."""
    fits = [
        fit_readings(synthetic_readings(seed, reading_mm=reading_mm, scatter=scatter, off_mm=0.01))
        for seed in range(40)
    ]
    assert sum(inside(fit) for fit in fits) >= 33
    kept = [fit.kappa_bar[None] for fit in fits]
    assert sum(interval.low <= 0.003 <= interval.high for interval in kept) >= 33
    # thicknesses off by 3 % change curvatures by 9 %, and four tell their mean to a few percent
    half = [(fit.ratio["paper"].high - fit.ratio["paper"].low) / 2 / PAPER for fit in fits]
    assert 0.05 < np.median(half) < 0.15


def test_better_measurements_never_widen_intervals_of_wrong_thicknesses() -> None:
    """What thicknesses are off by is counted once, however little the strips of each scatter."""
    part = dict(zip(THICKNESSES_MM, (1.0, 1.1, 0.9, 1.08), strict=True))
    widths = []
    for scatter in (0.02, 0.005, 0.001, 0.0002):
        exact = synthetic_readings(0, reading_mm=0.0, scatter=0.0)
        rng = np.random.default_rng(5)
        off = [
            replace(
                one,
                curvature_per_mm=(_curvature(one, Plastic()) * part[one.thickness_mm] * (not one.peeled) + 0.003)
                * (1 + scatter * rng.standard_normal()),
            )
            for one in exact
        ]
        fit = fit_readings(off)
        found = fit.ratio["paper"]
        assert fit.disagrees and not fit.left_out and inside(fit)
        assert not any("bound" in line for line in fit_warnings(fit))
        widths.append(found.high - found.low)
    assert max(widths) < 1.1 * min(widths) and max(widths) < 0.35 * PAPER


def test_strips_that_all_read_the_same_are_used() -> None:
    """Computed curvatures, written to so many digits, and means written for every strip of a thickness."""
    strips = synthetic_readings(0)
    for digits in (5, 6, 7):
        exact = [
            replace(one, curvature_per_mm=round(_curvature(one, Plastic(kappa_bar_per_mm=0.003)), digits))
            for one in strips
        ]
        fit = fit_readings(exact)
        assert not fit.left_out and fit.ratio["paper"].value == pytest.approx(PAPER, rel=0.002)
        assert not fit.kappa_bar_contradicted
    means: dict[tuple[float, bool], list[float]] = {}
    for one in strips:
        means.setdefault((one.thickness_mm, one.peeled), []).append(one.curvature_per_mm or 0.0)
    same = fit_readings(
        [replace(one, curvature_per_mm=float(np.mean(means[one.thickness_mm, one.peeled]))) for one in strips]
    )
    assert not same.left_out and inside(same) and any("all read the same" in line for line in fit_warnings(same))
    # forty copies of four means know no more than the four, and not much less than the strips themselves
    width = [found.high - found.low for found in (fit_readings(strips).ratio["paper"], same.ratio["paper"])]
    assert 0.3 * width[0] < width[1] < 5 * width[0]


def test_mistakes_that_explain_a_table_are_named() -> None:
    swapped = [replace(one, thickness_mm=0.8, fabric_thickness_mm=one.thickness_mm) for one in synthetic_readings(0)]
    with pytest.raises(UndeterminedMaterialError, match="thickness_mm and fabric_thickness_mm were swapped"):
        fit_readings(swapped)
    unsigned = [
        replace(one, curvature_per_mm=abs(one.curvature_per_mm or 0.0))
        for one in synthetic_readings(0, Plastic(kappa_bar_per_mm=-0.004), reading_mm=0.1)
    ]
    with pytest.raises(UndeterminedMaterialError, match="with a minus, in peeled_curvature_per_mm"):
        fit_readings(unsigned)
    wild = dict(zip(THICKNESSES_MM, (0.1, 1.0, 3.0, 0.5), strict=True))
    with pytest.raises(UndeterminedMaterialError, match=r"contradict the formula, by \d+ % of their curvature"):
        fit_readings(
            [
                one
                if one.peeled
                else replace(one, curvature_per_mm=(one.curvature_per_mm or 0.0) * wild[one.thickness_mm])
                for one in synthetic_readings(0)
            ]
        )


def test_two_readings_are_said_to_be_too_few() -> None:
    strips = [one for one in synthetic_readings(0, Plastic()) if not one.peeled and one.thickness_mm == 0.3][:2]
    strips[1] = replace(strips[1], curvature_per_mm=1.3 * (strips[1].curvature_per_mm or 0.0))
    fit = fit_readings(strips, kappa_bar="zero")
    assert "E1/E2 has no upper bound: 2 readings are too few" in fit_warnings(fit)


def test_flat_strips_of_a_wrong_thickness_are_no_outliers() -> None:
    """Strips that are thicker than they are said to be look flat, all of them."""
    strips = synthetic_readings(1, Plastic(), reading_mm=0.1)
    strips = [replace(r, curvature_per_mm=None) if r.thickness_mm == 0.35 and not r.peeled else r for r in strips]
    fit = fit_readings([r for r in strips if not r.peeled], kappa_bar="zero")
    assert not fit.left_out and fit.thicknesses_apart == (0.35,)
    assert any("0.35 mm disagree with the others" in line or "of 0.35 mm first" in line for line in fit_warnings(fit))


def test_shared_errors_follow_the_formula() -> None:
    """Eq. (1): the ratio goes with `1 - 1/s^2`, with `h2 (h1 + h2)` and with `(h1 + h2) / h1^3`."""
    changes = shared_errors(fit_readings(synthetic_readings(0, reading_mm=0.01, scatter=0.0)))
    assert changes["stretch"] == pytest.approx(100 * ((1 - 1 / (1.01 * 1.35) ** 2) / (1 - 1 / 1.35**2) - 1), abs=0.02)
    assert 9.5 < changes["fabric_thickness"] < 11.5
    assert -9.5 < changes["plastic_thickness"] < -5


@given(mean=st.floats(-3, 3), limit=st.floats(0.05, 2), spread=st.floats(0.2, 2))
def test_flat_terms_are_derivatives(mean: float, limit: float, spread: float) -> None:
    def minus_log(m: float) -> float:
        # the same for both signs; on this side the tails are exact
        return -float(np.log(norm.cdf((limit - abs(m)) / spread) - norm.cdf((-limit - abs(m)) / spread)))

    step = 1e-4
    low, here, high = (minus_log(mean + d) for d in (-step, 0.0, step))
    first, second = (float(t[0]) for t in flat_terms(np.array([mean]), np.array([limit]), np.array([spread])))
    assert first == pytest.approx((high - low) / (2 * step), rel=1e-4, abs=1e-6)
    assert second == pytest.approx((high - 2 * here + low) / step**2, rel=1e-2, abs=1e-4)


@pytest.mark.parametrize(("copies", "told"), [(4, False), (40, True)])
def test_copies_of_one_strip_are_no_repeats(copies: int, told: bool) -> None:
    kinds = [(0.3, False, 0.0302), (0.3, True, 0.003), (0.4, False, 0.0172), (0.4, True, 0.003)]
    readings = [
        Reading(f"{k}-{h}", 2, h, 60.0, 1.35, 0.8, peeled, curvature)
        for h, peeled, curvature in kinds
        for k in range(copies)
    ]
    lines = [line for line in fit_warnings(fit_readings(readings)) if "copies of one strip" in line]
    assert len(lines) == (4 if told else 0)
    assert not told or lines[0].startswith("all 40 readings of strips of 0.3 mm with fabric are the same")
