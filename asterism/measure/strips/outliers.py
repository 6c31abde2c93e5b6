"""Outliers among the readings, and kinds of strips that deviate as a whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import t as student

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.strips import arc
from asterism.measure.strips.curvature_model import CurvatureModel, StripData
from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.noise import finest_deviation, rounding_deviation
from asterism.measure.strips.parameter_estimate import estimate_parameters, first_guess

# probability that a table of good readings has an outlier
OUTLIER_FALSE_ALARM = 0.01
# Tukey's biweight gives no weight to readings beyond so many standard deviations
_BIWEIGHT_CUTOFF = 4.685
# marks of the ruler by which a good reading may deviate: at the width and at the height of its box
_MAX_RULER_MARKS = 1.5
# with fewer readings, the median of the deviations may be far too small a scale
_MIN_READINGS_FOR_SCALE = 24


def outliers(model: CurvatureModel, data: StripData) -> tuple[np.ndarray, Floats, np.ndarray]:
    """Outliers, distances in standard deviations, and readings of kinds that deviate as a whole.

    If most readings of a kind deviate too far to the same side, something that they share is wrong, such as their
    thickness. These readings are not outliers, unless they deviate too far from the median of their kind.

    Returns
    -------
    odd : (n,) bool, the outliers.
    distance : (n,) distances from the fit of the other readings, in standard deviations.
    apart : (n,) bool, readings of kinds that deviate as a whole.

    Raises
    ------
    UndeterminedMaterialError
        There are too few readings, or more than a third contradict the others.
    """
    apart, own = np.zeros(len(data.curvature), dtype=bool), data
    while True:
        odd, beyond, mean = _outliers(model, own)
        new = _apart(data.kind, odd, beyond) & ~apart
        if not new.any():
            # a flat strip has no deviation within its kind
            odd &= ~(apart & data.flat)
            if np.sum(odd) > len(odd) / 3:
                raise UndeterminedMaterialError(
                    f"{np.sum(odd)} of {len(odd)} readings contradict the others: measure again, "
                    "or give --keep-outliers to use them all"
                )
            return odd, np.abs(beyond), apart
        apart |= new
        own = replace(own, curvature=own.curvature + np.where(new, _to_middle(data.kind, own.curvature, mean), 0.0))


def _apart(kind: Ints, odd: np.ndarray, beyond: Floats) -> np.ndarray:
    """(n,) bool, readings of kinds of which most readings, and at least two, are outliers on the same side."""
    repeated = np.zeros(len(kind), dtype=bool)
    for side in (-1.0, 1.0):
        count = np.bincount(kind, odd & (np.sign(beyond) == side))
        repeated |= ((count >= 2) & (count > np.bincount(kind) / 2))[kind]
    return repeated


def _to_middle(kind: Ints, curvature: Floats, mean: Floats) -> Floats:
    """(n,) 1/mm, shift that moves the median of a kind to the fit; 0 for kinds that look flat."""
    off = mean - curvature
    middle = [np.median(here) if len(here := off[(kind == k) & ~np.isnan(off)]) else 0.0 for k in range(kind.max() + 1)]
    return np.array(middle)[kind]


def _outliers(model: CurvatureModel, data: StripData) -> tuple[np.ndarray, Floats, Floats]:
    """Outliers (n,), their signed distances from the fit in standard deviations, and the fit (1/mm).

    A robust fit (Tukey's biweight, from least absolute deviations) proposes outliers. The decision uses the distance of
    each reading from a fit without them, by Student's distribution with Bonferroni's correction.
    """
    good = ~(_robust_distance(model, data) > 4.0)
    if len(good) < _MIN_READINGS_FOR_SCALE:
        good[:] = True
    for _ in range(10):
        estimate = estimate_parameters(model, data.take(good), alike=True)
        mean, jacobian = model.mean(estimate.parameters, data), model.jacobian(estimate.parameters, data)
        sensitivity = arc.reading_sensitivity(mean, data.length)
        variance = estimate.noise.variance(sensitivity, mean)
        of_fit = np.einsum("np,pq,nq->n", jacobian, estimate.covariance, jacobian)
        # a reading that took part in the fit attracts it
        spread = np.sqrt(np.maximum(variance + np.where(good, -1, 1) * of_fit, 1e-3 * variance))
        spread = np.maximum(spread, finest_deviation(sensitivity, mean))
        distance = np.abs(_beyond(data, mean)) / spread
        # scale without the reading itself, for readings that took part
        free = max(estimate.free, 2)
        alone = distance * np.sqrt(np.maximum((free - 1) / np.maximum(free - distance**2, 1e-9), 0.0))
        distance = np.where(good & ~data.flat, np.where(distance**2 < free, alone, np.inf), distance)
        limit = student.ppf(1 - OUTLIER_FALSE_ALARM / (2 * len(distance)), free - 1)
        # a deviation to the next mark of the ruler, at both sides of a box, is no contradiction
        mark = data.step * sensitivity
        again = (distance <= limit) | (np.abs(_beyond(data, mean)) <= _MAX_RULER_MARKS * mark)
        if np.array_equal(again, good):
            break
        good = again
    side = np.where(data.flat, -np.sign(mean), np.sign(data.curvature - mean))
    return ~good, side * distance, mean


def _beyond(data: StripData, mean: Floats) -> Floats:
    """(n,) deviations of the readings; that of a flat strip is the distance of the fit from its bound."""
    return np.where(data.flat, np.maximum(np.abs(mean) - data.limit, 0.0), data.curvature - mean)


def _robust_distance(model: CurvatureModel, data: StripData) -> Floats:
    """(n,) deviations from a robust fit over their robust scale."""
    bent = data.take(~data.flat)
    start = first_guess(model, bent, data)
    best, best_distance = np.inf, np.zeros(len(data.curvature))
    # the scatter may be constant, from the boxes, or proportional to the curvature
    for mix in (0.0, 0.5, 1.0):
        parameters = start
        for turn in range(40):
            mean = model.mean(parameters, bent)
            share = _share(mix, mean, bent)
            standard = (bent.curvature - mean) / share
            scale = max(1.4826 * float(np.median(np.abs(standard))), 1e-12)
            u = standard / scale
            absolute = 1 / np.maximum(np.abs(u), 1e-3)
            weight = absolute if turn < 20 else np.maximum(1 - (u / _BIWEIGHT_CUTOFF) ** 2, 0.0) ** 2
            root = np.sqrt(weight) / share
            jacobian = model.jacobian(parameters, bent) * root[:, None]
            if not np.isfinite(jacobian).all():  # LAPACK would print a message
                raise np.linalg.LinAlgError("the robust fit has left all numbers")
            parameters = parameters + np.linalg.lstsq(jacobian, (bent.curvature - mean) * root, rcond=None)[0]
        likelihood = np.log(scale) + np.mean(np.log(share))
        if likelihood < best:
            mean = model.mean(parameters, data)
            # if most readings are equal, the next mark is within the error of rounding
            sensitivity = arc.reading_sensitivity(mean, data.length)
            least = np.maximum(rounding_deviation(data.step) * sensitivity, finest_deviation(sensitivity, mean))
            spread = np.maximum(scale * _share(mix, mean, data), least)
            best, best_distance = likelihood, np.abs(_beyond(data, mean)) / spread
    return best_distance


def _share(mix: float, mean: Floats, data: StripData) -> Floats:
    """(n,) standard deviations, up to a common factor."""
    reading = arc.reading_sensitivity(mean, data.length) ** 2
    return np.asarray(np.sqrt((1 - mix) * reading / reading.mean() + (mix + 0.01) * mean**2 / np.mean(mean**2) + 1e-3))
