"""The model of the strips: their curvatures as functions of E2/E1 and kappa_bar, with derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Self, get_args

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.strips.errors import UndeterminedMaterialError
from asterism.measure.strips.reading import Reading
from asterism.pattern.design.materials import bilayer_curvature

StripFormula = Literal["paper", "timoshenko"]
KappaBarKind = Literal["constant", "per-thickness", "zero"]
FORMULAS: tuple[StripFormula, ...] = get_args(StripFormula)
KAPPA_BAR_KINDS: tuple[KappaBarKind, ...] = get_args(KappaBarKind)


@dataclass(frozen=True)
class StripData:
    """Readings as arrays (n,).

    Attributes
    ----------
    curvature : 1/mm; NaN for flat strips.
    limit : 1/mm, bound of the curvature of a strip that looks flat.
    length : mm, length of the strip.
    thickness, fabric : mm, thickness of the plastic and of the fabric.
    mismatch : 1 - 1/s^2 for the stretch s.
    peeled : bool, measured without fabric.
    step : mm, step of the ruler to which the sides of the box are rounded; 0 if unknown.
    """

    curvature: Floats
    limit: Floats
    length: Floats
    thickness: Floats
    fabric: Floats
    mismatch: Floats
    peeled: np.ndarray
    step: Floats

    @classmethod
    def of(cls, readings: list[Reading], flat_height_mm: float) -> Self:
        """Arrays of readings; an arc lower than `flat_height_mm` looks flat."""
        length = np.array([r.length_mm for r in readings])
        return cls(
            curvature=np.array([np.nan if r.curvature_per_mm is None else r.curvature_per_mm for r in readings]),
            limit=8 * flat_height_mm / length**2,
            length=length,
            thickness=np.array([r.thickness_mm for r in readings]),
            fabric=np.array([r.fabric_thickness_mm for r in readings]),
            mismatch=1 - np.array([r.stretch for r in readings]) ** -2,
            peeled=np.array([r.peeled for r in readings], dtype=bool),
            step=np.array([r.step_mm for r in readings]),
        )

    @property
    def flat(self) -> np.ndarray:
        """(n,) bool, strips that look flat."""
        return np.isnan(self.curvature)

    @property
    def kind(self) -> Ints:
        """(n,) number of the kind, from 0.

        Readings of a kind should be equal: one thickness, fabric and stretch, all with fabric or all peeled.
        """
        kinds = np.column_stack([self.thickness, self.fabric, self.mismatch, self.peeled])
        return np.unique(kinds, axis=0, return_inverse=True)[1].reshape(-1)

    def take(self, which: np.ndarray) -> StripData:
        """The readings with these indices or where a mask holds."""
        return StripData(**{name: values[which] for name, values in vars(self).items()})


@dataclass(frozen=True)
class CurvatureModel:
    """Curvatures as a function of the parameters (E2/E1, kappa_bar...).

    Attributes
    ----------
    thicknesses : mm, thicknesses of the entries of kappa_bar with `per-thickness`; otherwise empty.
    """

    formula: StripFormula
    kappa_bar: KappaBarKind
    thicknesses: Floats

    @classmethod
    def of(cls, data: StripData, formula: StripFormula, kappa_bar: KappaBarKind) -> Self:
        """The model for some readings.

        Raises
        ------
        UndeterminedMaterialError
            The readings do not determine E1/E2 and kappa_bar.
        """
        thicknesses = np.unique(data.thickness)
        if not np.any(~data.peeled):
            raise UndeterminedMaterialError("no strip was measured with its fabric: E1/E2 is not determined")
        if kappa_bar == "constant" and not data.peeled.any() and len(thicknesses) < 2:
            raise UndeterminedMaterialError(
                "strips of one thickness and none peeled cannot tell E1/E2 from kappa_bar: "
                "peel some, or give --kappa-bar zero"
            )
        if kappa_bar == "per-thickness":
            missing = np.setdiff1d(thicknesses, data.thickness[data.peeled])
            if len(missing):
                raise UndeterminedMaterialError(
                    f"--kappa-bar per-thickness: no strip of {missing[0]:g} mm was measured peeled"
                )
            return cls(formula, kappa_bar, thicknesses)
        return cls(formula, kappa_bar, np.empty(0))

    @property
    def size(self) -> int:
        """Number of parameters."""
        return 1 + {"constant": 1, "zero": 0, "per-thickness": len(self.thicknesses)}[self.kappa_bar]

    def mean(self, parameters: Floats, data: StripData) -> Floats:
        """(n,) 1/mm, curvatures of the model."""
        return self.by_fabric(parameters, data) + self._membership(data) @ parameters[1:]

    def jacobian(self, parameters: Floats, data: StripData) -> Floats:
        """(n, size), derivatives of `mean` with respect to the parameters."""
        step = 1e-6 * max(abs(float(parameters[0])), 1e-9)
        ends = (self._bilayer(parameters[0] + sign * step, data) for sign in (1, -1))
        slope = np.subtract(*ends) / (2 * step)
        return np.column_stack([slope, self._membership(data)])

    def by_fabric(self, parameters: Floats, data: StripData) -> Floats:
        """(n,) 1/mm, curvatures of the model without kappa_bar."""
        return self._bilayer(parameters[0], data)

    def _bilayer(self, inverse_ratio: float, data: StripData) -> Floats:
        # an infinite ratio, E2/E1 = 0, leaves the strip straight
        ratio = 1 / inverse_ratio if inverse_ratio else np.inf
        curvature = bilayer_curvature(data.thickness, data.fabric, ratio, data.mismatch, self.formula)
        return np.where(data.peeled, 0.0, curvature)

    def _membership(self, data: StripData) -> Floats:
        """(n, size - 1), 1 where an entry of kappa_bar belongs to a reading."""
        if self.kappa_bar == "per-thickness":
            return np.asarray((data.thickness[:, None] == self.thicknesses).astype(float))
        return np.ones((len(data.thickness), self.size - 1))
