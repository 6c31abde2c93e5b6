"""Parameters of a model and the noise of its readings, each from the other until both stay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.strips import arc
from asterism.strips.errors import NoMaterial
from asterism.strips.likelihood import solve
from asterism.strips.model import Data, Model
from asterism.strips.noise import Noise, noise, of_rounding, together
from pattern.layout import Floats
from pattern.materials import bilayer_curvature


@dataclass(frozen=True)
class Estimate:
    """What readings say.

    Attributes
    ----------
    parameters : (p,) E2/E1, then kappa_bar (1/mm).
    covariance, rounding : (p, p), of the scatter, and of what rounding does to equal readings alike.
    noise : of the readings.
    free : readings that are not flat, less parameters: degrees of freedom of the noise.
    """

    parameters: Floats
    covariance: Floats
    rounding: Floats
    noise: Noise
    free: int


def estimate(model: Model, data: Data) -> Estimate:
    """Fit a model to readings.

    Raises
    ------
    NoMaterial
        They are too few, or all flat.
    """
    bent = data.take(~data.flat)
    parameters = first_guess(model, bent, data)
    free = len(bent.curvature) - model.size
    if free < 1:
        raise NoMaterial(
            f"{len(bent.curvature)} bent strips are too few; at least {model.size + 1} readings are needed"
        )
    if np.linalg.matrix_rank(_equal_columns(model.jacobian(parameters, bent))) < model.size:
        raise NoMaterial(
            "the strips that are bent cannot tell E1/E2 from kappa_bar: measure more thicknesses, or peel some"
        )
    found = Noise(1.0, 0.0)
    for _ in range(20):
        mean = model.mean(parameters, data)
        variance = found.variance(arc.reading_sensitivity(mean, data.length), mean)
        previous = parameters
        parameters, covariance = solve(model, data, variance, parameters)
        mean = model.mean(parameters, bent)
        sensitivity = arc.reading_sensitivity(mean, bent.length)
        least = float(of_rounding(bent.step).max())
        found = noise(bent.curvature - mean, model.jacobian(parameters, bent), sensitivity, mean, least)
        if np.all(np.abs(parameters - previous) <= 1e-4 * np.sqrt(np.diag(covariance))):
            break
    mean = model.mean(parameters, data)
    variance = found.variance(arc.reading_sensitivity(mean, data.length), mean)
    parameters, covariance = solve(model, data, variance, parameters)
    return Estimate(parameters, covariance, _of_rounding(model, bent, parameters, covariance, found), found, free)


def _of_rounding(model: Model, bent: Data, parameters: Floats, covariance: Floats, found: Noise) -> Floats:
    """(p, p) what is added to the covariance, as rounding moves all readings together that should be equal."""
    mean = model.mean(parameters, bent)
    sensitivity = arc.reading_sensitivity(mean, bent.length)
    alike = together(bent.curvature, bent.kind, sensitivity, bent.step)
    off = alike / found.variance(sensitivity, mean)
    equal = np.column_stack([np.round(mean / np.abs(mean).max(), 9), bent.length])
    _, group = np.unique(equal, axis=0, return_inverse=True)
    of_group = np.zeros((group.max() + 1, model.size))
    np.add.at(of_group, group.reshape(-1), off[:, None] * model.jacobian(parameters, bent))
    return np.asarray(covariance @ of_group.T @ of_group @ covariance)


def first_guess(model: Model, bent: Data, data: Data) -> Floats:
    """(p,) parameters of the right size.

    Raises
    ------
    NoMaterial
        Every strip with its fabric is flat, and the message gives the bound that is left; or there is none.
    """
    with_fabric = bent.take(~bent.peeled)
    if len(with_fabric.curvature) == 0:
        flat = data.take(~data.peeled)
        if len(flat.curvature) == 0:  # they were outliers of each other
            raise NoMaterial("the strips with their fabric contradict each other: measure again")
        bound = np.max(_of_ratio_one(model, flat) / flat.limit)
        raise NoMaterial(
            f"every strip with its fabric looks flat: E1/E2 is above {bound:.0f} ({model.formula}) if kappa_bar is 0, "
            "and no more can be said; print thinner or longer strips"
        )
    peeled = bent.curvature[bent.peeled]
    kept = float(np.median(peeled)) if len(peeled) and model.size > 1 else 0.0
    per_ratio = (with_fabric.curvature - kept) / _of_ratio_one(model, with_fabric)
    return np.concatenate([[max(float(np.median(per_ratio)), 1e-7)], np.full(model.size - 1, kept)])


def _of_ratio_one(model: Model, data: Data) -> Floats:
    """(n,) curvature for E1/E2 = 1 in the limit of stiff plastic, 1/mm."""
    stiff = 1e9
    return stiff * bilayer_curvature(data.thickness, data.fabric, stiff, data.mismatch, model.formula)


def _equal_columns(jacobian: Floats) -> Floats:
    return jacobian / np.maximum(np.linalg.norm(jacobian, axis=0), 1e-300)
