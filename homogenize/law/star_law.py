"""The law of stars: its quantities as functions of a star's sizes.

Curvatures are positive with the plastic on the outside. Stiffnesses are per area of the print, which is the area of the
stretched fabric.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.cell.point_group import differs_by_direction
from asterism.homogenize.law.anisotropy import ANISOTROPY_SIZE
from asterism.homogenize.law.hermite_grid import SlopeRule
from asterism.homogenize.law.law import CellErrors, Law, LawTable
from asterism.homogenize.law.plan import LawPlan
from asterism.pattern.design.design import Design


@dataclass(frozen=True)
class LawQuantity:
    """One quantity of the law."""

    meaning: str  # with its unit
    rule: SlopeRule = "smooth"  # of the slopes at the nodes
    # what is interpolated. "log": the logarithm, so that the quantity stays positive. "asinh": inverse hyperbolic sine,
    # linear for small values of either sign and logarithmic for large ones. "itself": the quantity.
    form: Literal["itself", "log", "asinh"] = "itself"
    per_modulus: bool = False  # the quantity is proportional to the modulus of the fabric
    # an error is relative to the cell's value, or to this part of the largest value in the table if that is larger. The
    # part is larger for quantities that change their sign.
    error_floor: float = 0.03


QUANTITIES = {
    "lam": LawQuantity("length of the flat free sheet over its printed length", "monotone", "log"),
    "lam_n": LawQuantity("the same for the natural tube: sqrt(hoop stretch x axial stretch)", "monotone", "log"),
    "kappa": LawQuantity("natural curvature, mean over the directions, 1/mm", form="asinh"),
    "bending": LawQuantity(
        "bending stiffness, secant from the flat sheet to the natural tube, N mm", form="log", per_modulus=True
    ),
    "a11": LawQuantity("membrane stiffness A11 of the natural tube, N/mm", form="log", per_modulus=True),
    "a12": LawQuantity("membrane stiffness A12 of the natural tube, N/mm", per_modulus=True, error_floor=0.1),
    "c3": LawQuantity("sixfold part of the bending energy, N mm^2", per_modulus=True, error_floor=0.1),
    "offset_mm": LawQuantity("height of the star's centre over the reference surface, mm"),
}
QUANTITY_NAMES = tuple(QUANTITIES)
_QUANTITIES = slice(0, len(QUANTITIES))
_RULES: tuple[SlopeRule, ...] = tuple(quantity.rule for quantity in QUANTITIES.values())
_KAPPA = QUANTITY_NAMES.index("kappa")
_LOG, _ASINH = (np.array([q.form == form for q in QUANTITIES.values()]) for form in ("log", "asinh"))
# natural curvature times spacing, above which a star is not scale-separated from its sheet
MAX_SEPARATED_CURL = 1.5
# natural curvature times spacing, above which its logarithm is interpolated
SMALL_CURL = 0.03


@dataclass(frozen=True)
class LawValues:
    """The law at N stars."""

    value: dict[str, Floats]  # (N,) for each of `QUANTITY_NAMES`
    inside: Bools  # (N,) False outside the range of the law, see `LawTable.interpolated`
    outside: dict[int, str]  # for each star outside the range why it is, in words
    # (N,) True if a sheet of such stars curls to a radius below two thirds of their spacing (`MAX_SEPARATED_CURL`). The
    # values are those of the cell, but a sheet whose stars differ need not follow them: the stated accuracy of the law
    # ends here.
    not_scale_separated: Bools


def anisotropy_size(design: Design) -> int:
    """K, the number of columns that the law of such stars has for directions; 0 if they are alike."""
    return ANISOTROPY_SIZE if differs_by_direction(design) else 0


@dataclass(frozen=True, eq=False)
class StarTable(LawTable):
    """The law of stars at one stretch.

    The columns are the forms of `QUANTITIES`, K differences between directions (`homogenize.law.anisotropy`; K is 0 for
    threefold symmetry), and amplitudes (2, W) of `corrugation_waves`: of the flat cell in mm, and their change per
    curvature in mm^2.
    """

    error_names = QUANTITY_NAMES

    @staticmethod
    def columns(plan: LawPlan) -> int:
        waves = CorrugationWaves.of(plan.design.lattice)
        return len(QUANTITIES) + anisotropy_size(plan.design) + 2 * len(waves)

    @property
    def spacing_mm(self) -> float:
        """Of the stars."""
        return self.plan.design.lattice.spacing_mm

    @cached_property
    def node_values(self) -> Floats:
        """(n1, ..., nA, Q) values of `QUANTITY_NAMES` at the nodes; at length 0 those of the bare fabric."""
        return from_stored(self.stored[..., _QUANTITIES], self.spacing_mm)

    def __call__(self, *sizes: ArrayLike) -> LawValues:
        """The law at stars of these sizes.

        `sizes`: `STAR_SIZES` in their order (length, thickness and width in mm), each (N,) or a number.
        """
        asked = self.rows(sizes)
        value = from_stored(self.interpolated(asked, _QUANTITIES, _RULES), self.spacing_mm)
        inside = self.inside(asked)
        return LawValues(
            {name: value[:, q] for q, name in enumerate(QUANTITY_NAMES)},
            inside,
            {int(star): self._why_outside(asked[star]) for star in np.flatnonzero(~inside)},
            self.is_tight(value[:, _KAPPA]),
        )

    def corrugation(self, *sizes: ArrayLike) -> Floats:
        """(N, 2, W) amplitudes of the stars' heights over the mean surface, for the waves `StarLaw.waves`.

        The amplitudes are `c[:, 0] + k c[:, 1]`, in mm, where k (1/mm) is the sum of the principal curvatures of the
        sheet. Flat cells give the first, natural tubes the second. Outside the range of the law they are those of the
        nearest sizes in it.
        """
        parts = self._smooth(sizes, len(QUANTITIES) + anisotropy_size(self.plan.design), self.stored.shape[-1])
        return parts.reshape(len(parts), 2, -1)

    def anisotropy(self, *sizes: ArrayLike) -> Floats:
        """(N, K) differences between directions, see `homogenize.law.anisotropy`; K is 0 for threefold symmetry.

        Outside the range of the law they are those of the nearest sizes in it.
        """
        return self._smooth(sizes, len(QUANTITIES), len(QUANTITIES) + anisotropy_size(self.plan.design))

    def _smooth(self, sizes: Sequence[ArrayLike], start: int, stop: int) -> Floats:
        return self.interpolated(self.rows(sizes), slice(start, stop), ["smooth"] * (stop - start))

    def is_tight(self, kappa: Floats) -> Bools:
        """(...) whether stars of these natural curvatures are not scale-separated."""
        return np.asarray(np.abs(kappa) * self.spacing_mm > MAX_SEPARATED_CURL)

    def errors(self, sizes: Floats, stored: Floats) -> CellErrors:
        values = self(*sizes.T)
        law = np.column_stack([values.value[name] for name in QUANTITY_NAMES])
        cells = from_stored(stored[:, _QUANTITIES], self.spacing_mm)
        stated = self.node_values[self.solved & ~self.is_tight(self.node_values[..., _KAPPA])]
        floor = np.array([q.error_floor for q in QUANTITIES.values()]) * np.abs(stated).max(axis=0)
        percent = 100 * (law - cells) / np.maximum(np.abs(cells), np.maximum(floor, 1e-12))
        return CellErrors(
            percent,
            values.inside,
            self.is_tight(cells[:, _KAPPA]) | values.not_scale_separated,
            values.value,
            dict(zip(QUANTITY_NAMES, cells.T, strict=True)),
        )

    def _why_outside(self, sizes: Floats) -> str:
        if (beyond := self.beyond(sizes)) is not None:
            name, size, covered = beyond
            return f"{name} = {size:g} is outside the law's {covered}"
        place = ", ".join(f"{key} = {size:g}" for key, size in self.plan.named(sizes).items())
        return f"no cell was solved near {place}"


def to_stored(rows: Floats, spacing_mm: float) -> Floats:
    """The interpolated forms (..., Q) of rows (..., Q) of `QUANTITY_NAMES`."""
    return np.where(
        _LOG, np.log(np.where(_LOG, rows, 1.0)), np.where(_ASINH, np.arcsinh(rows * spacing_mm / SMALL_CURL), rows)
    )


def from_stored(stored: Floats, spacing_mm: float) -> Floats:
    """The inverse of `to_stored`."""
    unit = np.where(_ASINH, SMALL_CURL / spacing_mm, 1.0)
    return unit * np.where(
        _LOG, np.exp(np.where(_LOG, stored, 0.0)), np.where(_ASINH, np.sinh(np.where(_ASINH, stored, 0.0)), stored)
    )


@dataclass(frozen=True)
class StarLaw(Law[StarTable]):
    """The law of stars of one material and lattice."""

    @property
    def even_stretches(self) -> tuple[float, ...]:
        """Those of the tables that are the same in x and y, increasing."""
        return tuple(sorted(each for each in self.stretches if isinstance(each, float)))

    @cached_property
    def waves(self) -> CorrugationWaves:
        """The waves whose amplitudes `StarTable.corrugation` gives."""
        return CorrugationWaves.of(self.plan.design.lattice)

    def evaluate(self, design: Design, *sizes: ArrayLike) -> LawValues:
        """The law at stars of these sizes, with stiffnesses for the modulus of the design's fabric.

        Raises `LawError` as `check` does.

        >>> from asterism.homogenize.law.law_file import load_law
        >>> from asterism.pattern.design.design import Design
        >>> design = Design.from_dict({"stars": {"length_mm": 9.0}, "border": {"rings": 1}})
        >>> found = load_law().evaluate(design, 9.0, 0.42, 1.2)
        >>> found.value["bending"].round(3), bool(found.inside[0])  # N mm
        (array([3.314]), True)
        """
        values, scale = self.check(design)(*sizes), self.modulus_ratio(design)
        scaled = {name: scale * values.value[name] for name, quantity in QUANTITIES.items() if quantity.per_modulus}
        return replace(values, value=values.value | scaled)

    def corrugation(self, design: Design, *sizes: ArrayLike) -> Floats:
        """(N, 2, W) `StarTable.corrugation` for the stars of a design, which may be turned by half a turn."""
        parts = self.check(design).corrugation(*sizes)
        arms = design.lattice.arms
        turned = (design.lattice.orientation_deg - self.plan.design.lattice.orientation_deg) * arms / 180.0
        return np.where(self.waves.odd, -parts, parts) if arms % 2 and round(turned) % 2 else parts

    def anisotropy(self, design: Design, *sizes: ArrayLike) -> Floats:
        """(N, K) `StarTable.anisotropy` for the stars of a design; half a turn does not change it."""
        return self.check(design).anisotropy(*sizes)
