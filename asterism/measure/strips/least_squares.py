"""Weighted least squares through means of kinds of strips, with intervals by Student's distribution.

Strips of a kind may share an error, mostly that of their thickness. Therefore the scatter of the means about the fit
gives the intervals, and not that of the strips. Single strips take the place of the means if there are too few kinds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple, Self

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.measure.strips.strip_data import StripData

IMPLAUSIBLE = "no plastic on this fabric curls such strips so: check their units, lengths, thicknesses and boxes"
# strips and kinds that are further off, in standard deviations, are named
FAR = 5.0
Curve = Callable[[Floats, StripData], Floats]


class UndeterminedMaterialError(Error):
    """The strips do not determine a material; the message is one line."""

    exit_status = 1


class Interval(NamedTuple):
    """An estimate with its confidence interval; `high` may be infinite."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Solution:
    """Parameters (p,) of a curve through strips.

    Attributes
    ----------
    units : the means that were fitted, or single strips.
    effect : (p, n) derivatives of the parameters by the curvatures of `units`.
    variance, freedom : (p,) variances and their degrees of freedom.
    bound : (p,) largest effect of the errors that repeats share.
    """

    values: Floats
    units: StripData
    effect: Floats
    variance: Floats
    freedom: Floats
    bound: Floats

    def interval(self, index: int, confidence: float) -> Interval:
        """The confidence interval of a parameter."""
        quantile = student.ppf((1 + confidence) / 2, self.freedom[index])
        half = float(quantile * np.sqrt(self.variance[index]) + self.bound[index])
        value = float(self.values[index])
        return Interval(value, value - half, value + half)

    def with_errors_of(self, other: Solution, shift: Floats) -> Self:
        """The same with the errors of other parameters (q,), by which the curve at `units` moves as `shift` (n, q).

        The degrees of freedom are those of Satterthwaite (Biometrics Bulletin 2, 1946).
        """
        effect = self.effect @ shift
        parts = np.column_stack([self.variance, effect**2 * other.variance])
        freedom = np.column_stack([self.freedom, np.broadcast_to(other.freedom, effect.shape)])
        total = parts.sum(axis=1)
        together = total**2 / np.maximum(np.sum(parts**2 / freedom, axis=1), 1e-300)
        return replace(
            self,
            variance=total,
            freedom=np.where(total > 0, together, self.freedom),
            bound=self.bound + np.abs(effect) @ other.bound,
        )


def fit_curve(curve: Curve, start: Floats, strips: StripData) -> Solution:
    """The least squares of a curve of parameters (p,), from `start`.

    Raises
    ------
    UndeterminedMaterialError
        There are no more strips than parameters, or the curve does not follow them.
    """
    kinds = strips.kinds()[0]
    units = kinds if len(kinds.count) > len(start) else strips
    freedom = len(units.count) - len(start)
    if freedom < 1:
        needed = f"at least {len(start) + 1}, not {len(units.count)}"
        raise UndeterminedMaterialError(f"too few strips with fabric, or too few of them peeled: {needed}")
    scale, error = np.where(start == 0, 0.01, start), units.usual_error(units.curvature)

    def off(parameters: Floats) -> Floats:
        return (curve(parameters * scale, units) - units.curvature) / error

    try:
        found = least_squares(off, start / scale, "3-point", method="lm", xtol=1e-12, ftol=1e-12, gtol=1e-12)
        inverse = np.linalg.pinv(found.jac) * scale[:, None]
    except (ValueError, np.linalg.LinAlgError):  # the curve is not finite
        raise UndeterminedMaterialError(IMPLAUSIBLE) from None
    return Solution(
        found.x * scale,
        units,
        inverse / error,
        np.sum(inverse**2, axis=1) * 2 * found.cost / freedom,
        np.full(len(start), float(freedom)),
        np.abs(inverse) @ (units.limit / error),
    )


def far_strips(strips: StripData) -> tuple[Floats, float]:
    """(n,) distances of strips from the median of their kind, in standard deviations, and these over the usual errors.

    The standard deviation is that of the median distance of all repeats, but at least the usual error.
    """
    kinds, kind = strips.kinds()
    centre = np.array([np.median(strips.curvature[kind == k]) for k in range(len(kinds.count))])[kind]
    far = np.abs(strips.curvature - centre) / strips.usual_error(centre)
    repeats = far[kinds.count[kind] > 1]
    scale = max(1.4826 * float(np.median(repeats)), 1.0) if len(repeats) else 1.0
    return far / scale, scale


def kinds_apart(strips: StripData, fitted: Callable[[StripData], Floats]) -> str:
    """Thicknesses of kinds whose means are further from the fitted curve than the scatter of their strips explains."""
    kinds = strips.kinds()[0]
    single = replace(kinds, count=np.ones(len(kinds.count))).usual_error(fitted(kinds))
    far = kinds.beyond(fitted(kinds)) * np.sqrt(kinds.count) / single / far_strips(strips)[1]
    return " and ".join(f"{h:g} mm" for h in np.unique(kinds.thickness[np.abs(far) > FAR]))
