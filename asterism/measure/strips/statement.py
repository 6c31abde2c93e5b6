"""The result of a fit of strips: its summary, its warnings, and the meaning of the conventions."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.stats import norm

from asterism.measure.strips.curvature_model import FORMULAS, StripData
from asterism.measure.strips.strip_fit import Interval, StripFit
from asterism.measure.strips.systematic import shared_errors
from asterism.pattern.design.materials import bilayer_curvature
from asterism.process.version import __version__
from asterism.results.records.strips import (
    KappaBarRecord,
    LeftOutReadingRecord,
    RatioIntervalRecord,
    StripFitRecord,
    StripOptionsRecord,
)

# so many equal readings are copies: strips from one printer scatter by more than a mark of a ruler
MIN_COPIES = 8


def convention_sentences(fit: StripFit) -> list[str]:
    """Sentences that explain the convention of the fitted ratio."""
    other = next(name for name in FORMULAS if name != fit.formula)
    mine, theirs = fit.ratio[fit.formula].value, fit.ratio[other].value
    return [
        f'{mine:.4g} goes with rest_curvature = "{fit.formula}", {theirs:.4g} with "{other}": each with its own '
        "formula gives these strips the curvature they have.",
        f'The ratio is also the stiffness of the arms against the fabric: with "{other}" they are '
        f'{theirs / mine:.2f} times as stiff as with "{fit.formula}".',
        f'Mixed up, {mine:.4g} with "{other}", the fabric would curl the strips '
        f"{_mixed_up(fit, other):.2f} times as much.",
    ]


def fit_warnings(fit: StripFit) -> list[str]:
    """One line for each reason to doubt the numbers."""
    lines = []
    apart = " and ".join(f"{h:g} mm" for h in fit.thicknesses_apart)
    wider = f"the interval of E1/E2 is {fit.widened:.1f} times as wide as by that scatter" if fit.widened > 1 else ""
    if fit.kappa_bar_contradicted and fit.kappa_bar_kind == "zero":
        lines.append("peeled strips curl by themselves: kappa_bar is not 0, try --kappa-bar constant")
    elif fit.disagrees:
        check = f", that of the strips of {apart} first" if apart else ""
        lines.append(
            "the thicknesses disagree with the formula by more than the scatter of their strips "
            f"(chance {fit.lack_of_fit:.1g}): check the thicknesses{check}" + (f"; {wider}" if wider else "")
        )
    elif apart:
        lines.append(f"the strips of {apart} disagree with the others as a whole: check their thickness")
    if fit.kappa_bar_contradicted and fit.kappa_bar_kind == "constant":
        lines.append("peeled strips of different thickness keep different curvatures: try --kappa-bar per-thickness")
    if fit.lack_of_fit is None and fit.widened > 1:
        lines.append(
            "strips of a thickness all read the same: their scatter is not known, and intervals come from the "
            "differences between thicknesses alone"
        )
    lines += _copies(fit)
    if math.isinf(fit.ratio[fit.formula].high):
        lines.append(f"E1/E2 has no upper bound: {_why_no_bound(fit)}")
    called = {"stretch": "stretches", "thickness_mm": "thicknesses of the fabric"}
    return lines + [
        f"strips of {len(values)} {called[key]}: the material says none; add fabric.{key} to it for asterism calibrate"
        for key, values in fit.fabrics.items()
        if len(values) > 1
    ]


def _copies(fit: StripFit) -> Iterator[str]:
    """A line if all readings of a kind of strips are the same number, although they are many."""
    kinds: dict[tuple[float, bool], list[float | None]] = {}
    for reading in fit.used:
        kinds.setdefault((reading.thickness_mm, reading.peeled), []).append(reading.curvature_per_mm)
    for (thickness, peeled), values in sorted(kinds.items()):
        if len(values) >= MIN_COPIES and len(set(values)) == 1 and values[0] is not None:
            yield (
                f"all {len(values)} readings of strips of {thickness:g} mm {'peeled' if peeled else 'with fabric'} are "
                "the same: copies of one strip are no repeats, and the intervals are then too narrow"
            )


def fit_record(fit: StripFit, table: str, options: StripOptionsRecord) -> StripFitRecord:
    """The summary of a fit to the table of this name."""
    return StripFitRecord(
        version=__version__,
        strips=table,
        options=options,
        rest_curvature=fit.formula,
        confidence=fit.confidence,
        modulus_ratio={name: _ratio(interval) for name, interval in fit.ratio.items()},
        kappa_bar_kind=fit.kappa_bar_kind,
        kappa_bar=[
            KappaBarRecord(thickness_mm=h, value_per_mm=each.value, low_per_mm=each.low, high_per_mm=each.high)
            for h, each in fit.kappa_bar.items()
        ],
        reading_error_mm=fit.noise.reading_mm,
        strip_scatter=fit.noise.scatter,
        thickness_scatter=fit.estimate.common.with_fabric,
        peeled_thickness_scatter_per_mm=fit.estimate.common.peeled,
        lack_of_fit_chance=fit.lack_of_fit,
        intervals_widened_by=fit.widened,
        kappa_bar_contradicted=fit.kappa_bar_contradicted,
        thicknesses_apart_mm=list(fit.thicknesses_apart),
        shared_error_percent=shared_errors(fit),
        readings_used=len(fit.used),
        readings_flat=sum(reading.curvature_per_mm is None for reading in fit.used),
        left_out=[
            LeftOutReadingRecord(
                strip=each.reading.strip, row=each.reading.row, peeled=each.reading.peeled, reason=each.reason
            )
            for each in fit.left_out
        ],
    )


def _ratio(interval: Interval) -> RatioIntervalRecord:
    high = interval.high if math.isfinite(interval.high) else None
    return RatioIntervalRecord(value=interval.value, low=interval.low, high=high)


def _why_no_bound(fit: StripFit) -> str:
    estimate = fit.estimate
    value, variance = estimate.parameters[0], estimate.covariance[0, 0] + estimate.rounding[0, 0]
    # whether many strips of the same scatter would give a bound
    if value <= norm.ppf((1 + fit.confidence) / 2) * np.sqrt(variance):
        return "the strips bend too little"
    if estimate.of_common[:, 0, 0].sum() > estimate.of_noise(0):
        return "strips of too few thicknesses"
    return f"{len(fit.used)} readings are too few"


def _mixed_up(fit: StripFit, other: str) -> float:
    """Curvature from the fabric if the ratio is used with the other convention, over the measured curvature."""
    data = StripData.of([r for r in fit.used if not r.peeled], fit.flat_height_mm)
    sizes = (data.thickness, data.fabric, fit.ratio[fit.formula].value, data.mismatch)
    wrong = bilayer_curvature(*sizes, "timoshenko" if other == "timoshenko" else "paper")
    return float(np.mean(wrong / bilayer_curvature(*sizes, fit.formula)))
