"""Fit of E1/E2 and kappa_bar to strips: peeled strips give kappa_bar, and strips with fabric, less kappa_bar, E2/E1.

The fit is weighted least squares through means of kinds of strips, with intervals by Student's distribution. Strips of
a kind may share an error, mostly that of their thickness. Therefore the scatter of the means about the fit gives the
intervals, and not that of the strips. Single strips take the place of the means if there are too few kinds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Self, get_args

import numpy as np
from pydantic import ValidationError
from scipy.optimize import least_squares
from scipy.stats import t as student

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.errors import Error
from asterism.measure.strip_table import DIRECTIONS, Reading
from asterism.pattern.design.errors import from_validation
from asterism.pattern.design.materials import Plastic, bilayer_curvature
from asterism.process.settings import KappaBarKind, StripFitSettings, StripFormula

# strips whose arc is lower look flat
FLAT_HEIGHT_MM = 0.5


@dataclass(frozen=True)
class StripData:
    """Strips, or means of strips of a kind: one thickness, fabric and stretch. Arrays (n,)."""

    curvature: Floats  # 1/mm; 0 for flat strips
    sensitivity: Floats  # 1/mm^2, change of the curvature by a change of the box
    limit: Floats  # 1/mm, bound of errors that repeats share: of flat strips, and of rounding to the marks of a ruler
    thickness: Floats  # mm, of the plastic
    fabric: Floats  # mm, thickness of the fabric
    mismatch: Floats  # 1 - 1/s^2 for the stretch s
    count: Floats  # strips of each mean

    @classmethod
    def of(cls, readings: list[Reading]) -> Self:
        """Single strips."""
        curvature = np.array([r.curvature_per_mm or 0.0 for r in readings])
        # of an arc up to a half circle, and beyond, where its width is 2/curvature
        sensitivity = np.maximum(8 / np.array([r.length_mm for r in readings]) ** 2, curvature**2 / 2)
        flat = np.array([r.curvature_per_mm is None for r in readings])
        strips = cls(
            curvature,
            sensitivity,
            flat * FLAT_HEIGHT_MM * sensitivity,
            np.array([r.thickness_mm for r in readings]),
            np.array([r.fabric_thickness_mm for r in readings]),
            1 - np.array([r.stretch for r in readings]) ** -2,
            np.ones(len(readings)),
        )
        # Repeats average the error of rounding if they scatter by marks of the ruler: for a normal scatter s and marks
        # at a distance d, their mean is off by about d/2 exp(-2 pi^2 s^2/d^2) (Widrow, Kollar, Quantization Noise).
        step = np.array([r.step_mm for r in readings])
        kinds, kind = strips.kinds()
        squares = np.sum(((curvature - kinds.curvature[kind]) / sensitivity) ** 2)
        scatter = max(squares / max(len(kind) - len(kinds.count), 1) - np.max(step) ** 2 / 12, 0.0)
        shared = step / 2 * sensitivity * np.exp(-2 * np.pi**2 * scatter / np.maximum(step, 1e-9) ** 2)
        return replace(strips, limit=np.maximum(strips.limit, shared))

    def kinds(self) -> tuple[StripData, Ints]:
        """Means of the kinds, and the kind of each strip."""
        sizes = np.column_stack([self.thickness, self.fabric, self.mismatch])
        _, first, kind = np.unique(sizes, axis=0, return_index=True, return_inverse=True)
        kind = kind.reshape(-1)
        count = np.bincount(kind).astype(float)
        same = {name: values[first] for name, values in vars(self).items()}
        means = {name: np.bincount(kind, getattr(self, name)) / count for name in ("curvature", "sensitivity", "limit")}
        return StripData(**(same | means | {"count": count})), kind

    def usual_error(self, curvature: Floats) -> Floats:
        """(n,) 1/mm, usual errors at some curvatures (n,), for weights; the scatter of the strips scales them."""
        # 0.3 mm of a side of a box, which repeats average, and a part of the curvature that equal strips may share by a
        # wrong thickness
        reading = (0.3 * self.sensitivity) ** 2 / self.count
        return np.asarray(np.sqrt(reading + (0.03 * curvature) ** 2 + self.limit**2 / 3))

    def beyond(self, curvature: Floats) -> Floats:
        """(n,) 1/mm, deviations from some curvatures (n,), as far as they exceed `limit`."""
        off = self.curvature - curvature
        return np.asarray(np.sign(off) * np.maximum(np.abs(off) - self.limit, 0.0))


IMPLAUSIBLE = "no plastic on this fabric curls such strips so: check their units, lengths, thicknesses and boxes"
# probability with which intervals contain the true values
CONFIDENCE = 0.95
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
    """Parameters (p,) of a curve through strips."""

    values: Floats
    units: StripData  # the means that were fitted, or single strips
    effect: Floats  # (p, n) derivatives of the parameters by the curvatures of `units`
    variance: Floats  # (p,)
    freedom: Floats  # (p,) degrees of freedom of the variances
    bound: Floats  # (p,) largest effect of the errors that repeats share

    def interval(self, index: int) -> Interval:
        """The confidence interval of a parameter."""
        quantile = student.ppf((1 + CONFIDENCE) / 2, self.freedom[index])
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

    Raises UndeterminedMaterialError: there are no more strips than parameters, or the curve does not follow them.
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


FORMULAS: tuple[StripFormula, ...] = get_args(StripFormula)
# a reading that is left out or doubtful, and why
NamedReading = tuple[Reading, str]


@dataclass(frozen=True)
class StripFit:
    """The material that fits a table of strips."""

    settings: StripFitSettings
    ratio: dict[StripFormula, Interval]  # E1/E2 for each convention
    # one entry a thickness, or a single entry with the key None; empty if it is taken for 0
    kappa_bar: dict[float | None, Interval]
    freedom: float  # degrees of freedom of the interval of E1/E2
    used: tuple[Reading, ...]
    left_out: tuple[NamedReading, ...]  # readings whose box does not fit the length of the strip
    outliers: tuple[NamedReading, ...]  # readings that are used although they are far from the others
    warnings: tuple[str, ...]  # one line for each reason to doubt the numbers

    @property
    def found(self) -> Interval:
        """E1/E2 in the convention of the settings."""
        return self.ratio[self.settings.rest_curvature]

    def plastic(self, modulus_ratio: float | None = None) -> Plastic:
        """The plastic of a design, with the fitted ratio or another one."""
        kept: Any = self.kappa_bar[None].value if None in self.kappa_bar else 0.0
        if self.settings.kappa_bar == "per-thickness":
            kept = {"thickness_mm": tuple(self.kappa_bar), "per_mm": tuple(i.value for i in self.kappa_bar.values())}
        ratio, formula = modulus_ratio or self.found.value, self.settings.rest_curvature
        return Plastic(modulus_ratio=ratio, rest_curvature=formula, kappa_bar_per_mm=kept)


def fit_directions(readings: list[Reading], settings: StripFitSettings) -> tuple[StripFit, ...]:
    """Fit a material to strips along the grain, and to those across it; one fit if they have no directions.

    Each direction is a fit of its own, with all peeled strips: strips of one thickness may share an error, whatever
    their direction.
    """
    covered = [r for r in readings if not r.peeled and not r.left_out]
    lie = {r.direction for r in covered}
    if lie <= {None}:
        return (fit_readings(readings, settings),)
    if settings.kappa_bar == "constant" and len(covered) == len([r for r in readings if not r.left_out]):
        raise UndeterminedMaterialError(
            "strips in two directions and none peeled cannot tell E1/E2 from kappa_bar: "
            "peel some, or give --kappa-bar zero"
        )
    fits = []
    for direction in DIRECTIONS:
        part = [r for r in readings if r.peeled or r.direction == direction]
        try:
            fits.append(fit_readings(part, settings))
        except UndeterminedMaterialError as error:
            raise UndeterminedMaterialError(f"strips {direction} the grain: {error}") from None
    return tuple(fits)


@np.errstate(all="ignore")  # the material is checked
def fit_readings(readings: list[Reading], settings: StripFitSettings) -> StripFit:
    """Fit a material to strips of one direction.

    Raises UndeterminedMaterialError: the readings do not determine E1/E2.
    """
    formula, kappa_bar = settings.rest_curvature, settings.kappa_bar
    used = [r for r in readings if not r.left_out]
    left_out = [(r, r.left_out) for r in readings if r.left_out]
    if not used:
        reasons = "; ".join(f"{r.name}: {reason}" for r, reason in left_out[:3])
        raise UndeterminedMaterialError(f"no reading can be used: {reasons}")
    bare, covered = [r for r in used if r.peeled], [r for r in used if not r.peeled]
    _check_kinds(bare, covered, kappa_bar)
    strips = StripData.of(covered)
    if all(r.curvature_per_mm is None for r in covered):
        bound = np.max(_of_ratio_one(strips, formula) / strips.limit)
        raise UndeterminedMaterialError(
            f"every strip with its fabric looks flat: E1/E2 is above {bound:.0f} ({formula}) if kappa_bar is 0, "
            "and no more can be said; print thinner or longer strips"
        )
    keys: list[float | None] = []
    if kappa_bar == "constant":
        keys.append(None)
    elif kappa_bar == "per-thickness":
        keys += sorted({r.thickness_mm for r in bare})
    kept, outliers, doubts = None, _outliers(covered, strips), list[str]()
    if bare:
        peeled = StripData.of(bare)
        if keys:
            kept = fit_curve(lambda values, some: _of_key(some, keys) @ values, np.zeros(len(keys)), peeled)
        outliers = _outliers(bare, peeled) + outliers
        found = kept.values if kept else np.empty(0)
        if apart := kinds_apart(peeled, lambda some: _of_key(some, keys) @ found):
            what = "keep another curvature than the others: try --kappa-bar per-thickness"
            what = what if keys else "curl by themselves: kappa_bar is not 0, try --kappa-bar constant"
            doubts.append(f"peeled strips of {apart} {what}")
    solutions = {name: _with_fabric(strips, name, keys, kept) for name in FORMULAS}
    ratio = {}
    for name, (solution, _) in solutions.items():
        inverse = solution.interval(0)
        if not inverse.value > 0:
            no_effect = "strips with their fabric curl no more than peeled ones: E1/E2 is not determined"
            raise UndeterminedMaterialError(no_effect if kept else IMPLAUSIBLE)
        ratio[name] = Interval(1 / inverse.value, 1 / inverse.high, 1 / inverse.low if inverse.low > 0 else np.inf)
    mine, curve = solutions[formula]
    if apart := kinds_apart(strips, lambda some: curve(mine.values, some)):
        doubts.append(
            f"strips of {apart} with fabric differ from the fit by more than their scatter: check their thickness"
        )
    if mine.units is strips:
        doubts.append(
            "the interval of E1/E2 leaves out errors that strips of a thickness share: print more thicknesses"
        )
    if np.isinf(ratio[formula].high):
        doubts.append("E1/E2 has no upper bound: the strips bend too little, or they are too few or of too few kinds")
    fit = StripFit(
        settings,
        ratio,
        {key: kept.interval(i) if kept else mine.interval(1) for i, key in enumerate(keys)},
        float(mine.freedom[0]),
        tuple(used),
        tuple(left_out),
        tuple(outliers),
        (*(f"{one.name} (row {one.row}): {reason}; it is used: check it" for one, reason in outliers), *doubts),
    )
    try:
        fit.plastic()
    except ValidationError as error:
        raise UndeterminedMaterialError(f"{IMPLAUSIBLE}; {from_validation(error)}") from None
    return fit


def _check_kinds(bare: list[Reading], covered: list[Reading], kappa_bar: KappaBarKind) -> None:
    """Refuse tables without the kinds of strips that determine the material."""
    thicknesses = {r.thickness_mm for r in covered}
    if not covered:
        raise UndeterminedMaterialError("no strip was measured with its fabric: E1/E2 is not determined")
    if kappa_bar == "constant" and not bare and len(thicknesses) < 2:
        raise UndeterminedMaterialError(
            "strips of one thickness and none peeled cannot tell E1/E2 from kappa_bar: "
            "peel some, or give --kappa-bar zero"
        )
    if kappa_bar == "per-thickness" and (missing := thicknesses - {r.thickness_mm for r in bare}):
        raise UndeterminedMaterialError(
            f"--kappa-bar per-thickness: no strip of {min(missing):g} mm was measured peeled"
        )


def _with_fabric(
    strips: StripData, formula: StripFormula, keys: list[float | None], kept: Solution | None
) -> tuple[Solution, Curve]:
    """E2/E1 of strips with their fabric, and their curve. Values of kappa_bar that are not `kept` follow."""

    def curve(values: Floats, some: StripData) -> Floats:
        ratio = 1 / values[0] if values[0] else np.inf
        by_fabric = bilayer_curvature(some.thickness, some.fabric, ratio, some.mismatch, formula)
        return np.asarray(by_fabric + _of_key(some, keys) @ (kept.values if kept else values[1:]))

    residual = _of_key(strips, keys) @ kept.values if kept else 0.0
    guess = np.median(((strips.curvature - residual) / _of_ratio_one(strips, formula))[strips.curvature != 0])
    start = np.array([max(float(guess), 1e-7), *np.zeros(0 if kept else len(keys))])
    solution = fit_curve(curve, start, strips)
    return solution.with_errors_of(kept, _of_key(solution.units, keys)) if kept else solution, curve


def _outliers(readings: list[Reading], strips: StripData) -> list[NamedReading]:
    distance, _ = far_strips(strips)
    return [
        (one, f"{one.curvature_per_mm or 0:.5f} /mm is {far:.1f} standard deviations from strips like it")
        for one, far in zip(readings, distance, strict=True)
        if far > FAR
    ]


def _of_key(strips: StripData, keys: list[float | None]) -> Floats:
    """(n, q), 1 where a value of kappa_bar, for a thickness or for all, is that of a strip."""
    n = len(strips.thickness)
    return np.array([np.ones(n) if h is None else strips.thickness == h for h in keys]).reshape(-1, n).T


def _of_ratio_one(strips: StripData, formula: StripFormula) -> Floats:
    """(n,) 1/mm, curvature for E1/E2 = 1 in the limit of stiff plastic."""
    stiff = 1e9
    return stiff * bilayer_curvature(strips.thickness, strips.fabric, stiff, strips.mismatch, formula)
