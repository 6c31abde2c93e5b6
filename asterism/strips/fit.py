"""E1/E2 and kappa_bar from strips, with intervals, in both conventions."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pydantic import ValidationError
from scipy.stats import f as fisher
from scipy.stats import t as student

from asterism.strips import arc
from asterism.strips.errors import NoMaterial
from asterism.strips.estimate import Estimate, estimate
from asterism.strips.model import FORMULAS, KAPPA_BAR_KINDS, Data, Formula, KappaBarKind, Model
from asterism.strips.noise import Noise, together
from asterism.strips.outliers import outliers
from asterism.strips.strip import Reading
from pattern.errors import from_validation
from pattern.layout import Floats, Ints
from pattern.materials import Plastic

FLAT_HEIGHT_MM = 0.5
# a model that is right is called wrong with this chance
_FALSE_ALARM = 0.01
LITTLE = "strips with their fabric curl no more than peeled ones: E1/E2 cannot be told"
UNLIKELY = "no plastic on this fabric curls such strips so: check their units, lengths, thicknesses and boxes"


@dataclass(frozen=True)
class Interval:
    """A value and the range it lies in with the chosen confidence; `high` may be infinite."""

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
    """What a table of strips says about a material.

    Attributes
    ----------
    ratio : E1/E2 for each convention.
    kappa_bar : one entry a thickness, or a single one with the key None; empty if it was taken for 0.
    noise : of the readings.
    used, left_out : the readings.
    lack_of_fit : how likely strips as they were measured are if the formula holds; None if there are no repeats.
    widened : factor by which the intervals were widened because thicknesses disagree more than their strips do.
    kappa_bar_contradicted : kappa_bar was taken for one number or for 0, and the peeled strips say that it is not.
    thicknesses_apart : mm, of strips that lie away from the others as a whole; they are used.
    """

    formula: Formula
    kappa_bar_kind: KappaBarKind
    confidence: float
    ratio: dict[Formula, Interval]
    kappa_bar: dict[float | None, Interval]
    estimate: Estimate
    model: Model
    noise: Noise
    used: tuple[Reading, ...]
    left_out: tuple[LeftOut, ...]
    lack_of_fit: float | None
    widened: float
    kappa_bar_contradicted: bool
    thicknesses_apart: tuple[float, ...] = ()
    flat_height_mm: float = field(default=FLAT_HEIGHT_MM)

    @property
    def fabrics(self) -> dict[str, set[float]]:
        """What the strips were printed on, by the keys of a design's fabric; each has one value in most."""
        return {
            "stretch": {reading.stretch for reading in self.used},
            "thickness_mm": {reading.fabric_thickness_mm for reading in self.used},
        }

    def plastic(self, modulus_ratio: float | None = None) -> Plastic:
        """The plastic as a design has it, with another ratio if one is given."""
        kept: Any = self.kappa_bar[None].value if None in self.kappa_bar else 0.0
        if self.kappa_bar_kind == "per-thickness":
            values = tuple(interval.value for interval in self.kappa_bar.values())
            kept = {"thickness_mm": tuple(float(h) for h in self.model.thicknesses), "per_mm": values}
        ratio = modulus_ratio or self.ratio[self.formula].value
        return Plastic(modulus_ratio=ratio, rest_curvature=self.formula, kappa_bar_per_mm=kept)


def fit_strips(
    readings: list[Reading],
    formula: Formula = "paper",
    kappa_bar: KappaBarKind = "constant",
    *,
    confidence: float = 0.95,
    flat_height_mm: float = FLAT_HEIGHT_MM,
    keep_outliers: bool = False,
) -> StripFit:
    """Fit a material to strips.

    Parameters
    ----------
    formula : convention of the rest curvature of the material; the other one's ratio is given beside it.
    kappa_bar : one number, one for each thickness, or zero.
    confidence : of the intervals.
    flat_height_mm : a lower arc is not told from a flat strip.
    keep_outliers : use readings that lie too far from the others, too.

    Raises
    ------
    NoMaterial
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
        with np.errstate(all="ignore"):  # what comes of it is looked at below
            found = _fit(readings, formula, kappa_bar, confidence, flat_height_mm, keep_outliers)
    except np.linalg.LinAlgError:
        raise NoMaterial(UNLIKELY) from None
    if not all(np.isfinite(interval.value) for interval in found.ratio.values()):
        raise NoMaterial(UNLIKELY)
    try:
        found.plastic()
    except ValidationError as error:
        raise NoMaterial(f"{UNLIKELY}; {from_validation(error)}") from None
    return found


def _fit(
    readings: list[Reading],
    formula: Formula,
    kappa_bar: KappaBarKind,
    confidence: float,
    flat_height_mm: float,
    keep_outliers: bool,
) -> StripFit:
    """The same, which may come to numbers that no material has."""
    left_out = [LeftOut(r, r.left_out) for r in readings if r.left_out]
    usable = [r for r in readings if not r.left_out]
    if not usable:
        raise NoMaterial("no reading can be used: " + "; ".join(f"{o.reading.name}: {o.reason}" for o in left_out[:3]))
    data = Data.of(usable, flat_height_mm)
    thicknesses_apart: tuple[float, ...] = ()
    if not keep_outliers:
        model = Model.of(data, formula, kappa_bar)
        odd, distance, apart = outliers(model, data)
        expected = model.mean(estimate(model, data.take(~odd)).parameters, data)
        for i in np.flatnonzero(odd):
            seen = "flat" if data.flat[i] else f"{data.curvature[i]:.5f} /mm"
            reason = f"{seen}, the others say {expected[i]:.5f}: {distance[i]:.1f} standard deviations"
            left_out.append(LeftOut(usable[i], reason))
        usable = [reading for reading, bad in zip(usable, odd, strict=True) if not bad]
        thicknesses_apart = tuple(float(h) for h in np.unique(data.thickness[apart]))
        data = data.take(~odd)
    results, widened, lack = {}, {}, {}
    for name in FORMULAS:
        model = Model.of(data, name, kappa_bar)
        results[name] = model, estimate(model, data)
        lack[name], widened[name] = _lack_of_fit(*results[name], data)
    ratio = {}
    for name, (_, found) in results.items():
        inverse = _interval(found, 0, confidence, widened[name])
        if inverse.value <= 0:
            raise NoMaterial(LITTLE if data.peeled.any() else UNLIKELY)
        ratio[name] = Interval(1 / inverse.value, 1 / inverse.high, 1 / inverse.low if inverse.low > 0 else np.inf)
    model, found = results[formula]
    keys: list[float | None] = [float(h) for h in model.thicknesses] if kappa_bar == "per-thickness" else [None]
    kept = {key: _interval(found, 1 + i, confidence, widened[formula]) for i, key in enumerate(keys[: model.size - 1])}
    return StripFit(
        formula,
        kappa_bar,
        confidence,
        ratio,
        kept,
        found,
        model,
        found.noise,
        tuple(usable),
        tuple(left_out),
        lack[formula],
        widened[formula],
        _contradicted(kappa_bar, found, data),
        thicknesses_apart,
        flat_height_mm,
    )


def _interval(found: Estimate, index: int, confidence: float, widened: float) -> Interval:
    variance = found.covariance[index, index] * widened**2 + found.rounding[index, index]
    half = student.ppf((1 + confidence) / 2, found.free) * np.sqrt(variance)
    value = float(found.parameters[index])
    return Interval(value, value - float(half), value + float(half))


def _lack_of_fit(model: Model, found: Estimate, data: Data) -> tuple[float | None, float]:
    """Chance of such a scatter between thicknesses if the model holds, and the factor by which it widens intervals.

    The F test of the means of equal strips against the model; Birge's ratio widens where it fails.
    """
    bent = data.take(~data.flat)
    mean = model.mean(found.parameters, bent)
    sensitivity = arc.reading_sensitivity(mean, bent.length)
    variance = found.noise.variance(sensitivity, mean)
    group = bent.kind
    groups = int(group.max(initial=-1)) + 1
    between, within = groups - model.size, len(mean) - groups
    if between < 1 or within < 1:
        return None, 1.0
    residual, weight = bent.curvature - mean, 1 / variance
    centre = np.bincount(group, weight * residual) / np.bincount(group, weight)
    inside = float(np.sum(weight * (residual - centre[group]) ** 2))
    total = float(np.sum(weight * residual**2))
    alike = together(bent.curvature, group, sensitivity, bent.step)
    if inside <= 1e-12 * total and not alike.any():
        return None, 1.0
    ratio = _apart(centre, weight, alike, group, inside / within) / between
    chance = float(fisher.sf(ratio, between, within))
    return chance, float(np.sqrt(ratio)) if chance < _FALSE_ALARM else 1.0


def _apart(centre: Floats, weight: Floats, alike: Floats, group: Ints, scale: float) -> float:
    """Squares of what groups are off in the mean (g,), over the variances of their means.

    `weight` (n,) of the readings, whose scatter is `scale` times what the weights say; `alike` (n,) 1/mm, what they
    may be off as a whole.
    """
    as_one = np.bincount(group, weight * alike**2) / np.bincount(group, weight)
    return float(np.sum(centre**2 / (scale / np.bincount(group, weight) + as_one)))


def _contradicted(kind: KappaBarKind, found: Estimate, data: Data) -> bool:
    """Peeled strips of different thickness differ, or from 0 if that was said, by more than their scatter explains."""
    peeled = data.take(data.peeled & ~data.flat)
    groups, group = np.unique(peeled.thickness, return_inverse=True)
    within, between = len(group) - len(groups), len(groups) - (kind == "constant")
    if kind == "per-thickness" or between < 1 or within < 1:
        return False
    sensitivity = arc.reading_sensitivity(peeled.curvature, peeled.length)
    weight = 1 / found.noise.variance(sensitivity, peeled.curvature)
    centre = np.bincount(group, weight * peeled.curvature) / np.bincount(group, weight)
    inside = np.sum(weight * (peeled.curvature - centre[group]) ** 2)
    if kind == "constant":
        off = centre[group] - np.sum(weight * peeled.curvature) / np.sum(weight)
    else:  # boxes are never less than nothing high: what looks flat leaves the others with a mean of their own
        off = np.maximum(np.abs(centre[group]) - peeled.limit, 0.0)
    alike = together(peeled.curvature, group, sensitivity, peeled.step)
    if inside == 0 and not alike.any():
        return bool((off != 0).any())
    middle = np.bincount(group, weight * off) / np.bincount(group, weight)
    apart = _apart(middle, weight, alike, group, inside / within)
    return bool(fisher.sf(apart / between, between, within) < _FALSE_ALARM)
