"""Tests of the fit: agreement of the kinds of strips with the model and with each other.

A kind is all strips of one thickness, fabric and stretch, either with fabric or peeled. The scatter within the kinds is
the measure of their disagreement.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import f as fisher

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.strips import arc
from asterism.measure.strips.curvature_model import CurvatureModel, KappaBarKind, StripData
from asterism.measure.strips.noise import finest_deviation, shared_rounding
from asterism.measure.strips.parameter_estimate import ParameterEstimate

# probability with which the tests reject a model that holds
FALSE_ALARM = 0.01


def lack_of_fit(model: CurvatureModel, estimate: ParameterEstimate, data: StripData) -> float | None:
    """Probability of the scatter between kinds if the model holds, by an F test; None without repeats."""
    bent = data.take(~data.flat)
    mean = model.mean(estimate.parameters, bent)
    sensitivity = arc.reading_sensitivity(mean, bent.length)
    variance = estimate.noise.variance(sensitivity, mean)
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
    """Sum of the squared deviations of the group means, over the variances of these means.

    Parameters
    ----------
    centre : (g,) deviations of the means.
    weight : (n,) weights of the readings.
    alike : (n,) 1/mm, standard deviation of the error that all readings of a group share.
    scale : variance of the readings over that of the weights.
    """
    as_one = np.bincount(group, weight * alike**2) / np.bincount(group, weight)
    return float(np.sum(centre**2 / (scale / np.bincount(group, weight) + as_one)))


def contradicted(kind: KappaBarKind, estimate: ParameterEstimate, data: StripData) -> bool:
    """Whether the peeled strips contradict the model of kappa_bar by more than their scatter explains."""
    peeled = data.take(data.peeled & ~data.flat)
    groups, group = np.unique(peeled.thickness, return_inverse=True)
    within, between = len(group) - len(groups), len(groups) - (kind == "constant")
    if kind == "per-thickness" or between < 1 or within < 1:
        return False
    sensitivity = arc.reading_sensitivity(peeled.curvature, peeled.length)
    weight = 1 / estimate.noise.variance(sensitivity, peeled.curvature)
    centre = np.bincount(group, weight * peeled.curvature) / np.bincount(group, weight)
    inside = np.sum(weight * (peeled.curvature - centre[group]) ** 2)
    if kind == "constant":
        off = centre[group] - np.sum(weight * peeled.curvature) / np.sum(weight)
    else:  # heights of boxes are never negative, so that strips below the limit are missing in the mean
        off = np.maximum(np.abs(centre[group]) - peeled.limit, 0.0)
    alike = shared_rounding(peeled.curvature, group, sensitivity, peeled.step)
    if inside <= 1e-12 * np.sum(weight * peeled.curvature**2) and not alike.any():
        return bool((np.abs(off) > finest_deviation(sensitivity, peeled.curvature)).any())
    middle = np.bincount(group, weight * off) / np.bincount(group, weight)
    apart = _apart(middle, weight, alike, group, inside / within)
    return bool(fisher.sf(apart / between, between, within) < FALSE_ALARM)
