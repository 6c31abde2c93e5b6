"""Parameters of a model and noise of its readings, in turns until both converge."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.measure.strips import arc
from asterism.measure.strips.curvature_model import CurvatureModel, StripData
from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.kind_effects import KindEffects, effect_sizes, fit_kind_effects, variance_factor
from asterism.measure.strips.likelihood import solve
from asterism.measure.strips.noise import MIN_REPEATS, ReadingNoise, fit_noise, rounding_deviation, shared_rounding
from asterism.pattern.design.materials import bilayer_curvature

# factor of the variance of the means of kinds in the first turn, which uses the scatter within kinds only
_FIRST_MEAN_VARIANCE_FACTOR = 1e6
# turns of parameters and noise
_MAX_TURNS = 40


@dataclass(frozen=True)
class ParameterEstimate:
    """Estimated parameters with their uncertainty.

    Attributes
    ----------
    parameters : (p,) E2/E1, then kappa_bar (1/mm).
    covariance : (p, p), from scatter and from the effects of kinds.
    rounding : (p, p), covariance from the errors of rounding that kinds share.
    noise : noise of the readings.
    free : number of readings that are not flat, minus the number of parameters.
    common : random effects of the kinds of strips.
    of_common : (2, p, p), parts of the covariance from these effects.
    free_common : (2,) degrees of freedom of these effects.
    """

    parameters: Floats
    covariance: Floats
    rounding: Floats
    noise: ReadingNoise
    free: int
    common: KindEffects
    of_common: Floats
    free_common: Floats

    def of_noise(self, index: int) -> float:
        """Part of the variance of a parameter from the scatter of the readings."""
        return max(float(self.covariance[index, index] - self.of_common[:, index, index].sum()), 0.0)

    def freedom(self, index: int) -> float:
        """Degrees of freedom of the variance of a parameter (Satterthwaite, Biometrics Bulletin 2, 1946)."""
        parts = np.array([self.of_noise(index), *self.of_common[:, index, index]])
        free = np.array([max(self.free - self.free_common.sum(), 1.0), *np.maximum(self.free_common, 1.0)])
        if not parts.sum() > 0:
            return float(free[0])
        share = parts / parts.sum()
        return float(1 / np.sum(share**2 / free))


def estimate_parameters(model: CurvatureModel, data: StripData, *, alike: bool = False) -> ParameterEstimate:
    """Fit a model to readings.

    Parameters
    ----------
    alike : strips of a kind have nothing in common but the formula; what kinds are off counts as scatter.

    Raises
    ------
    UndeterminedMaterialError
        There are too few readings, or all look flat.
    """
    bent = data.take(~data.flat)
    parameters = first_guess(model, bent, data)
    free = len(bent.curvature) - model.size
    if free < 1:
        raise UndeterminedMaterialError(
            f"{len(bent.curvature)} bent strips are too few; at least {model.size + 1} readings are needed"
        )
    if np.linalg.matrix_rank(_equal_columns(model.jacobian(parameters, bent))) < model.size:
        raise UndeterminedMaterialError(
            "the strips that are bent cannot tell E1/E2 from kappa_bar: measure more thicknesses, or peel some"
        )
    kind = bent.kind
    alone = alike or len(kind) - int(kind.max() + 1) < MIN_REPEATS
    least = float(rounding_deviation(bent.step).max())
    noise, shared = ReadingNoise(1.0, 0.0), KindEffects()
    larger = np.full(len(kind), 1.0 if alone else _FIRST_MEAN_VARIANCE_FACTOR)
    for _ in range(_MAX_TURNS):
        before, variance = (parameters, noise, shared), _variance(model, data, parameters, noise, shared)
        parameters, covariance = solve(model, data, variance, parameters)
        mean, jacobian = model.mean(parameters, bent), model.jacobian(parameters, bent)
        sensitivity = arc.reading_sensitivity(mean, bent.length)
        residual = bent.curvature - mean
        noise = fit_noise(residual, jacobian, sensitivity, mean, least, kind=kind, times=larger)
        if not alone:
            plain = noise.variance(sensitivity, mean)
            off = shared_rounding(bent.curvature, kind, sensitivity, bent.step)
            sizes = effect_sizes(model.by_fabric(parameters, bent), bent.peeled)
            shared = fit_kind_effects(kind, residual, jacobian, plain, off, sizes, shared)
            larger = variance_factor(kind, plain, shared.variance(sizes))
        if np.all(np.abs(parameters - before[0]) <= 1e-4 * np.sqrt(np.diag(covariance))) and (
            alone or _stays(before[1:], (noise, shared))
        ):
            break
    variance = _variance(model, data, parameters, noise, shared)
    parameters, covariance = solve(model, data, variance, parameters)
    of_bent = _variance(model, bent, parameters, noise, shared)
    rounding = _of_rounding(model, bent, parameters, covariance, of_bent)
    by_common = _of_common(model, bent, parameters, covariance, of_bent, shared)
    return ParameterEstimate(parameters, covariance, rounding, noise, free, shared, *by_common)


def _stays(before: tuple[ReadingNoise, KindEffects], now: tuple[ReadingNoise, KindEffects]) -> bool:
    """Whether noise and effects are those of the previous turn."""
    old, new = (np.array([*vars(one).values(), *vars(other).values()]) for one, other in (before, now))
    return bool(np.all(np.abs(new - old) <= 1e-3 * np.abs(new)))


def _variance(
    model: CurvatureModel, data: StripData, parameters: Floats, noise: ReadingNoise, shared: KindEffects
) -> Floats:
    """(n,) 1/mm^2, variances of the readings in the fit."""
    mean = model.mean(parameters, data)
    variance = noise.variance(arc.reading_sensitivity(mean, data.length), mean)
    sizes = effect_sizes(model.by_fabric(parameters, data), data.peeled)
    return variance * variance_factor(data.kind, variance, shared.variance(sizes))


def _of_common(
    model: CurvatureModel,
    bent: StripData,
    parameters: Floats,
    covariance: Floats,
    variance: Floats,
    shared: KindEffects,
) -> tuple[Floats, Floats]:
    """(2, p, p) part of the covariance from each effect, and (2,) its degrees of freedom."""
    jacobian = model.jacobian(parameters, bent)
    sizes = effect_sizes(model.by_fabric(parameters, bent), bent.peeled)
    kind = bent.kind
    count = int(kind.max()) + 1
    pull = np.zeros((count, model.size))
    np.add.at(pull, kind, jacobian / variance[:, None])
    _, first = np.unique(kind, return_index=True)
    taken = np.einsum("gp,pq,gq->g", pull, covariance, jacobian[first])
    parts, free = [], []
    for effect, size in zip((shared.with_fabric, shared.peeled), sizes[:, first], strict=True):
        moved = covariance @ (pull * (effect * size)[:, None]).T
        parts.append(moved @ moved.T)
        free.append(max(float(np.sum((1 - taken)[size != 0])), 1.0) if effect else 0.0)
    return np.array(parts), np.array(free)


def _of_rounding(
    model: CurvatureModel, bent: StripData, parameters: Floats, covariance: Floats, variance: Floats
) -> Floats:
    """(p, p) covariance from the error of rounding that all readings of a kind share."""
    mean = model.mean(parameters, bent)
    sensitivity = arc.reading_sensitivity(mean, bent.length)
    alike = shared_rounding(bent.curvature, bent.kind, sensitivity, bent.step)
    off = alike / variance
    equal = np.column_stack([np.round(mean / np.abs(mean).max(), 9), bent.length])
    _, group = np.unique(equal, axis=0, return_inverse=True)
    of_group = np.zeros((group.max() + 1, model.size))
    np.add.at(of_group, group.reshape(-1), off[:, None] * model.jacobian(parameters, bent))
    return np.asarray(covariance @ of_group.T @ of_group @ covariance)


def first_guess(model: CurvatureModel, bent: StripData, data: StripData) -> Floats:
    """(p,) initial parameters.

    Raises
    ------
    UndeterminedMaterialError
        All strips with fabric look flat, and the message gives the bound of E1/E2; or none is left.
    """
    with_fabric = bent.take(~bent.peeled)
    if len(with_fabric.curvature) == 0:
        flat = data.take(~data.peeled)
        if len(flat.curvature) == 0:  # all of them are outliers
            raise UndeterminedMaterialError("the strips with their fabric contradict each other: measure again")
        bound = np.max(_of_ratio_one(model, flat) / flat.limit)
        raise UndeterminedMaterialError(
            f"every strip with its fabric looks flat: E1/E2 is above {bound:.0f} ({model.formula}) if kappa_bar is 0, "
            "and no more can be said; print thinner or longer strips"
        )
    peeled = bent.curvature[bent.peeled]
    kept = float(np.median(peeled)) if len(peeled) and model.size > 1 else 0.0
    per_ratio = (with_fabric.curvature - kept) / _of_ratio_one(model, with_fabric)
    return np.concatenate([[max(float(np.median(per_ratio)), 1e-7)], np.full(model.size - 1, kept)])


def _of_ratio_one(model: CurvatureModel, data: StripData) -> Floats:
    """(n,) curvature for E1/E2 = 1 in the limit of stiff plastic, 1/mm."""
    stiff = 1e9
    return stiff * bilayer_curvature(data.thickness, data.fabric, stiff, data.mismatch, model.formula)


def _equal_columns(jacobian: Floats) -> Floats:
    return np.asarray(jacobian / np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300))
