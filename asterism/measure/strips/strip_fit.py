"""Fit of E1/E2 and kappa_bar to strips: peeled strips give kappa_bar, and strips with fabric, less kappa_bar, E2/E1."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from pydantic import ValidationError

from asterism.equilibrium.arrays import Floats
from asterism.measure.strips.least_squares import (
    FAR,
    IMPLAUSIBLE,
    Curve,
    Interval,
    Solution,
    UndeterminedMaterialError,
    far_strips,
    fit_curve,
    kinds_apart,
)
from asterism.measure.strips.strip_data import StripData
from asterism.measure.strips.strip_table import Reading
from asterism.pattern.design.errors import from_validation
from asterism.pattern.design.materials import Plastic, bilayer_curvature

StripFormula = Literal["paper", "timoshenko"]
KappaBarKind = Literal["constant", "per-thickness", "zero"]
FORMULAS: tuple[StripFormula, ...] = get_args(StripFormula)
KAPPA_BAR_KINDS: tuple[KappaBarKind, ...] = get_args(KappaBarKind)
# strips whose arc is lower count as flat
FLAT_HEIGHT_MM = 0.5


class NamedReading(NamedTuple):
    """A reading that is left out or doubtful, and why."""

    reading: Reading
    reason: str


@dataclass(frozen=True)
class StripFit:
    """The material that fits a table of strips.

    Attributes
    ----------
    ratio : E1/E2 for each convention.
    kappa_bar : one entry a thickness, or a single entry with the key None; empty if it is taken for 0.
    freedom : degrees of freedom of the interval of E1/E2.
    used, left_out : readings that are used, and those whose box does not fit the length of the strip.
    outliers : readings that are used although they are far from the others.
    warnings : one line for each reason to doubt the numbers.
    """

    formula: StripFormula
    kappa_bar_kind: KappaBarKind
    confidence: float
    flat_height_mm: float
    ratio: dict[StripFormula, Interval]
    kappa_bar: dict[float | None, Interval]
    freedom: float
    used: tuple[Reading, ...]
    left_out: tuple[NamedReading, ...]
    outliers: tuple[NamedReading, ...]
    warnings: tuple[str, ...]

    def plastic(self, modulus_ratio: float | None = None) -> Plastic:
        """The plastic of a design, with the fitted ratio or another one."""
        kept: Any = self.kappa_bar[None].value if None in self.kappa_bar else 0.0
        if self.kappa_bar_kind == "per-thickness":
            kept = {"thickness_mm": tuple(self.kappa_bar), "per_mm": tuple(i.value for i in self.kappa_bar.values())}
        ratio = modulus_ratio or self.ratio[self.formula].value
        return Plastic(modulus_ratio=ratio, rest_curvature=self.formula, kappa_bar_per_mm=kept)


@np.errstate(all="ignore")  # the material is checked
def fit_readings(
    readings: list[Reading],
    formula: StripFormula = "paper",
    kappa_bar: KappaBarKind = "constant",
    *,
    confidence: float = 0.95,
    flat_height_mm: float = FLAT_HEIGHT_MM,
) -> StripFit:
    """Fit a material to strips; parameters as those of `fit_strips`.

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
    used = [r for r in readings if not r.left_out]
    left_out = [NamedReading(r, r.left_out) for r in readings if r.left_out]
    if not used:
        reasons = "; ".join(f"{r.name}: {reason}" for r, reason in left_out[:3])
        raise UndeterminedMaterialError(f"no reading can be used: {reasons}")
    bare, covered = [r for r in used if r.peeled], [r for r in used if not r.peeled]
    _check_kinds(bare, covered, kappa_bar)
    strips = StripData.of(covered, flat_height_mm)
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
        peeled = StripData.of(bare, flat_height_mm)
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
        inverse = solution.interval(0, confidence)
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
        formula,
        kappa_bar,
        confidence,
        flat_height_mm,
        ratio,
        {key: kept.interval(i, confidence) if kept else mine.interval(1, confidence) for i, key in enumerate(keys)},
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
        NamedReading(one, f"{one.curvature_per_mm or 0:.5f} /mm is {far:.1f} standard deviations from strips like it")
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
