"""Fit of E1/E2 and kappa_bar to strips, with confidence intervals, in both conventions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pydantic import ValidationError
from scipy.stats import t as student

from asterism.measure.strips.agreement import FALSE_ALARM, contradicted, lack_of_fit
from asterism.measure.strips.curvature_model import (
    FORMULAS,
    KAPPA_BAR_KINDS,
    CurvatureModel,
    KappaBarKind,
    StripData,
    StripFormula,
)
from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.mistakes import check_mistakes
from asterism.measure.strips.noise import ReadingNoise
from asterism.measure.strips.outliers import outliers
from asterism.measure.strips.parameter_estimate import ParameterEstimate, estimate_parameters
from asterism.measure.strips.reading import Reading
from asterism.pattern.design.errors import from_validation
from asterism.pattern.design.materials import Plastic

# strips whose arc is lower count as flat
FLAT_HEIGHT_MM = 0.5
NO_EFFECT_OF_FABRIC = "strips with their fabric curl no more than peeled ones: E1/E2 is not determined"
IMPLAUSIBLE = "no plastic on this fabric curls such strips so: check their units, lengths, thicknesses and boxes"


@dataclass(frozen=True)
class Interval:
    """An estimate with its confidence interval; `high` may be infinite."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class LeftOut:
    """A reading that was not used, and why."""

    reading: Reading
    reason: str


@dataclass(frozen=True)
class StripFit:
    """The material that fits a table of strips.

    Attributes
    ----------
    ratio : E1/E2 for each convention.
    kappa_bar : one entry a thickness, or a single entry with the key None; empty if it is taken for 0.
    noise : noise of the readings.
    used, left_out : readings that are used, and the others.
    lack_of_fit : probability of the measured deviations if the formula holds; None without repeats, or if all repeats
        are equal.
    widened : width of the interval of E1/E2 over its width from the scatter of single strips alone; larger than 1
        because strips of a thickness may share an error.
    kappa_bar_contradicted : the peeled strips contradict the model of kappa_bar.
    thicknesses_apart : mm, thicknesses whose strips deviate as a whole; they are used.
    """

    formula: StripFormula
    kappa_bar_kind: KappaBarKind
    confidence: float
    ratio: dict[StripFormula, Interval]
    kappa_bar: dict[float | None, Interval]
    estimate: ParameterEstimate
    model: CurvatureModel
    noise: ReadingNoise
    used: tuple[Reading, ...]
    left_out: tuple[LeftOut, ...]
    lack_of_fit: float | None
    widened: float
    kappa_bar_contradicted: bool
    thicknesses_apart: tuple[float, ...] = ()
    flat_height_mm: float = field(default=FLAT_HEIGHT_MM)

    @property
    def disagrees(self) -> bool:
        """Whether the kinds of strips deviate from the formula by more than their scatter explains."""
        return self.lack_of_fit is not None and self.lack_of_fit < FALSE_ALARM

    @property
    def fabrics(self) -> dict[str, set[float]]:
        """Values of the fabrics by the keys of a design's fabric; most tables have one value each."""
        return {
            "stretch": {reading.stretch for reading in self.used},
            "thickness_mm": {reading.fabric_thickness_mm for reading in self.used},
        }

    def plastic(self, modulus_ratio: float | None = None) -> Plastic:
        """The plastic of a design, with the fitted ratio or another one."""
        kept: Any = self.kappa_bar[None].value if None in self.kappa_bar else 0.0
        if self.kappa_bar_kind == "per-thickness":
            values = tuple(interval.value for interval in self.kappa_bar.values())
            kept = {"thickness_mm": tuple(float(h) for h in self.model.thicknesses), "per_mm": values}
        ratio = modulus_ratio or self.ratio[self.formula].value
        return Plastic(modulus_ratio=ratio, rest_curvature=self.formula, kappa_bar_per_mm=kept)


def fit_readings(
    readings: list[Reading],
    formula: StripFormula = "paper",
    kappa_bar: KappaBarKind = "constant",
    *,
    confidence: float = 0.95,
    flat_height_mm: float = FLAT_HEIGHT_MM,
    keep_outliers: bool = False,
) -> StripFit:
    """Fit a material to strips.

    Parameters
    ----------
    formula : convention of the material's rest curvature; the result has the ratio of the other convention too.
    kappa_bar : one number, one for each thickness, or zero.
    confidence : confidence of the intervals, from 0 to 1.
    flat_height_mm : strips whose arc is lower count as flat.
    keep_outliers : use outliers too.

    Raises
    ------
    UndeterminedMaterialError
        The readings do not determine E1/E2.
    ValueError
        No such formula or kind of kappa_bar, or a confidence or height out of range.
    """
    for option, given, allowed in (("formula", formula, FORMULAS), ("kappa_bar", kappa_bar, KAPPA_BAR_KINDS)):
        if given not in allowed:
            raise ValueError(f"{option}: must be one of {', '.join(allowed)}, not {given!r}")
    if not (0 < confidence < 1 and 0 < flat_height_mm < np.inf):
        numbers = f"{confidence}, {flat_height_mm}"
        raise ValueError(f"confidence: must be between 0 and 1, and flat_height_mm above 0, not {numbers}")
    try:
        with np.errstate(all="ignore"):  # the results are checked below
            fit = _fit(readings, formula, kappa_bar, confidence, flat_height_mm, keep_outliers)
    except np.linalg.LinAlgError:
        raise UndeterminedMaterialError(IMPLAUSIBLE) from None
    if not all(np.isfinite(interval.value) for interval in fit.ratio.values()):
        raise UndeterminedMaterialError(IMPLAUSIBLE)
    try:
        fit.plastic()
    except ValidationError as error:
        raise UndeterminedMaterialError(f"{IMPLAUSIBLE}; {from_validation(error)}") from None
    return fit


def _fit(
    readings: list[Reading],
    formula: StripFormula,
    kappa_bar: KappaBarKind,
    confidence: float,
    flat_height_mm: float,
    keep_outliers: bool,
) -> StripFit:
    """The fit without the final checks."""
    left_out = [LeftOut(r, r.left_out) for r in readings if r.left_out]
    usable = [r for r in readings if not r.left_out]
    if not usable:
        raise UndeterminedMaterialError(
            "no reading can be used: " + "; ".join(f"{o.reading.name}: {o.reason}" for o in left_out[:3])
        )
    data = StripData.of(usable, flat_height_mm)
    thicknesses_apart: tuple[float, ...] = ()
    if not keep_outliers:
        model = CurvatureModel.of(data, formula, kappa_bar)
        odd, distance, apart = outliers(model, data)
        expected = model.mean(estimate_parameters(model, data.take(~odd)).parameters, data)
        for i in np.flatnonzero(odd):
            seen = "flat" if data.flat[i] else f"{data.curvature[i]:.5f} /mm"
            reason = f"{seen}, the others say {expected[i]:.5f}: {distance[i]:.1f} standard deviations"
            left_out.append(LeftOut(usable[i], reason))
        usable = [reading for reading, bad in zip(usable, odd, strict=True) if not bad]
        thicknesses_apart = tuple(float(h) for h in np.unique(data.thickness[apart]))
        data = data.take(~odd)
    results, lack = {}, {}
    for name in FORMULAS:
        model = CurvatureModel.of(data, name, kappa_bar)
        results[name] = model, estimate_parameters(model, data)
        lack[name] = lack_of_fit(*results[name], data)
    ratio = {}
    for name, (_, estimate) in results.items():
        inverse = _interval(estimate, 0, confidence)
        if inverse.value <= 0:
            raise UndeterminedMaterialError(NO_EFFECT_OF_FABRIC if data.peeled.any() else IMPLAUSIBLE)
        ratio[name] = Interval(1 / inverse.value, 1 / inverse.high, 1 / inverse.low if inverse.low > 0 else np.inf)
    model, estimate = results[formula]
    check_mistakes(model, estimate, data, lack[formula])
    keys: list[float | None] = [float(h) for h in model.thicknesses] if kappa_bar == "per-thickness" else [None]
    kept = {key: _interval(estimate, 1 + i, confidence) for i, key in enumerate(keys[: model.size - 1])}
    return StripFit(
        formula,
        kappa_bar,
        confidence,
        ratio,
        kept,
        estimate,
        model,
        estimate.noise,
        tuple(usable),
        tuple(left_out),
        lack[formula],
        _widened(estimate, confidence),
        contradicted(kappa_bar, estimate, data),
        thicknesses_apart,
        flat_height_mm,
    )


def _interval(estimate: ParameterEstimate, index: int, confidence: float) -> Interval:
    variance = estimate.covariance[index, index] + estimate.rounding[index, index]
    half = student.ppf((1 + confidence) / 2, estimate.freedom(index)) * np.sqrt(variance)
    value = float(estimate.parameters[index])
    return Interval(value, value - float(half), value + float(half))


def _widened(estimate: ParameterEstimate, confidence: float) -> float:
    """Width of the interval of E2/E1 over its width from the scatter of single strips alone."""
    if not estimate.of_common[0].any():
        return 1.0
    chance, free = (1 + confidence) / 2, estimate.free - estimate.free_common.sum()
    wider = student.ppf(chance, estimate.freedom(0)) / student.ppf(chance, max(free, 1.0))
    all_of_it = estimate.covariance[0, 0] + estimate.rounding[0, 0]
    # equal readings have no scatter
    scatter = max(estimate.of_noise(0) + estimate.rounding[0, 0], 1e-12 * all_of_it)
    return float(wider * np.sqrt(all_of_it / scatter))
