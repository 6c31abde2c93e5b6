"""Readings that do not belong to the others."""

from __future__ import annotations

import numpy as np
from scipy.stats import t as student

from asterism.strips import arc
from asterism.strips.errors import NoMaterial
from asterism.strips.estimate import estimate, first_guess
from asterism.strips.model import Data, Model
from pattern.layout import Floats

# the chance that one of all good readings is called an outlier
FALSE_ALARM = 0.01
_BIWEIGHT = 4.685
# the middle of so few deviations may be far too small a scale
_FEW = 24


def outliers(model: Model, data: Data) -> tuple[np.ndarray, Floats]:
    """Which readings (n,) lie too far from the fit of the others, and how many standard deviations away they are.

    A robust fit (Tukey's biweight, from least absolute deviations) proposes; what decides is the distance of each
    reading from a fit without the proposed ones, by Student's distribution with Bonferroni's correction.

    Raises
    ------
    NoMaterial
        Too few readings, or more than a third contradict the others.
    """
    good = ~(_robust_distance(model, data) > 4.0)
    if len(good) < _FEW:
        good[:] = True
    for _ in range(10):
        _check_majority(good)
        found = estimate(model, data.take(good))
        mean, jacobian = model.mean(found.parameters, data), model.jacobian(found.parameters, data)
        variance = found.noise.variance(arc.reading_sensitivity(mean, data.length), mean)
        of_fit = np.einsum("np,pq,nq->n", jacobian, found.covariance, jacobian)
        # a reading that took part pulls the fit towards itself
        spread = np.sqrt(np.maximum(variance + np.where(good, -1, 1) * of_fit, 1e-3 * variance))
        distance = np.abs(_beyond(data, mean)) / spread
        # scale without the reading itself, for those that took part
        free = max(found.free, 2)
        alone = distance * np.sqrt(np.maximum((free - 1) / np.maximum(free - distance**2, 1e-9), 0.0))
        distance = np.where(good & ~data.flat, np.where(distance**2 < free, alone, np.inf), distance)
        limit = student.ppf(1 - FALSE_ALARM / (2 * len(distance)), free - 1)
        again = distance <= limit
        if np.array_equal(again, good):
            break
        good = again
    _check_majority(good)
    return ~good, distance


def _check_majority(good: np.ndarray) -> None:
    if np.sum(~good) > len(good) / 3:
        raise NoMaterial(f"{np.sum(~good)} of {len(good)} readings contradict the others: measure again")


def _beyond(data: Data, mean: Floats) -> Floats:
    """(n,) deviation of each reading; a flat strip deviates by what the fit is beyond its limit."""
    return np.where(data.flat, np.maximum(np.abs(mean) - data.limit, 0.0), data.curvature - mean)


def _robust_distance(model: Model, data: Data) -> Floats:
    """(n,) deviations from a robust fit over their robust scale."""
    bent = data.take(~data.flat)
    start = first_guess(model, bent, data)
    best, best_distance = np.inf, np.zeros(len(data.curvature))
    # the scatter may be that of the boxes, the same for all, or grow with the curvature
    for mix in (0.0, 0.5, 1.0):
        parameters = start
        for turn in range(40):
            mean = model.mean(parameters, bent)
            share = _share(mix, mean, bent)
            standard = (bent.curvature - mean) / share
            scale = max(1.4826 * float(np.median(np.abs(standard))), 1e-12)
            u = standard / scale
            absolute = 1 / np.maximum(np.abs(u), 1e-3)
            weight = absolute if turn < 20 else np.maximum(1 - (u / _BIWEIGHT) ** 2, 0.0) ** 2
            root = np.sqrt(weight) / share
            jacobian = model.jacobian(parameters, bent) * root[:, None]
            parameters = parameters + np.linalg.lstsq(jacobian, (bent.curvature - mean) * root, rcond=None)[0]
        likelihood = np.log(scale) + np.mean(np.log(share))
        if likelihood < best:
            mean = model.mean(parameters, data)
            best, best_distance = likelihood, np.abs(_beyond(data, mean)) / (scale * _share(mix, mean, data))
    return best_distance


def _share(mix: float, mean: Floats, data: Data) -> Floats:
    """(n,) standard deviations up to a common factor."""
    reading = arc.reading_sensitivity(mean, data.length) ** 2
    return np.sqrt((1 - mix) * reading / reading.mean() + (mix + 0.01) * mean**2 / np.mean(mean**2) + 1e-3)
