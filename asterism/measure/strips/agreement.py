"""Whether kinds of strips agree with a model, and with each other, as far as their own scatter tells."""

from __future__ import annotations

import numpy as np
from scipy.stats import f as fisher

from asterism.measure.strips import arc
from asterism.measure.strips.curvature_model import CurvatureModel, KappaBarKind, StripData
from asterism.measure.strips.noise import finest_deviation, shared_rounding
from asterism.measure.strips.parameter_estimate import ParameterEstimate
from pattern.geometry.arrays import Floats, Ints

# a model that is right is called wrong with this chance
FALSE_ALARM = 0.01


def lack_of_fit(model: CurvatureModel, found: ParameterEstimate, data: StripData) -> float | None:
    """Chance of such a scatter between kinds if the model holds, by the F test of the means of kinds against it."""
    bent = data.take(~data.flat)
    mean = model.mean(found.parameters, bent)
    sensitivity = arc.reading_sensitivity(mean, bent.length)
    variance = found.noise.variance(sensitivity, mean)
    group = bent.kind
    groups = int(group.max(initial=-1)) + 1
    between, within = groups - model.size, len(mean) - groups
    if between < 1 or within < 1:
        return None
    residual, weight = bent.curvature - mean, 1 / variance
    centre = np.bincount(group, weight * residual) / np.bincount(group, weight)
    inside = float(np.sum(weight * (residual - centre[group]) ** 2))
    total = float(np.sum(weight * residual**2))
    alike = shared_rounding(bent.curvature, group, sensitivity, bent.step)
    if inside <= 1e-12 * total and not alike.any():
        return None
    ratio = _apart(centre, weight, alike, group, inside / within) / between
    return float(fisher.sf(ratio, between, within))


def _apart(centre: Floats, weight: Floats, alike: Floats, group: Ints, scale: float) -> float:
    """Squares of what groups are off in the mean (g,), over the variances of their means.

    `weight` (n,) of the readings, whose scatter is `scale` times what the weights say; `alike` (n,) 1/mm, what they
    may be off as a whole.
    """
    as_one = np.bincount(group, weight * alike**2) / np.bincount(group, weight)
    return float(np.sum(centre**2 / (scale / np.bincount(group, weight) + as_one)))


def contradicted(kind: KappaBarKind, found: ParameterEstimate, data: StripData) -> bool:
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
    alike = shared_rounding(peeled.curvature, group, sensitivity, peeled.step)
    if inside <= 1e-12 * np.sum(weight * peeled.curvature**2) and not alike.any():
        return bool((np.abs(off) > finest_deviation(sensitivity, peeled.curvature)).any())
    middle = np.bincount(group, weight * off) / np.bincount(group, weight)
    apart = _apart(middle, weight, alike, group, inside / within)
    return bool(fisher.sf(apart / between, between, within) < FALSE_ALARM)
