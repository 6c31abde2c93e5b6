"""The law at one stretch: its quantities over length, thickness and width of a star, and their slopes.

It is never extrapolated silently: outside its range, and next to cells that have no answer, its values are marked.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from homogenize.law.hermite_grid import Bools, Floats, HermiteGrid, SlopeRule
from homogenize.law.law_range import min_length

SIZE_KEYS = ("length_mm", "thickness_mm", "width_mm")


@dataclass(frozen=True)
class LawQuantity:
    """One function of the law.

    Attributes
    ----------
    meaning : with its unit.
    rule : how it is interpolated.
    form : what is interpolated: `log` of its ratio to the bare fabric's, so that it stays positive; `asinh`, which is
        the logarithm of large values and linear in small ones of either sign; or itself.
    per_modulus : it is proportional to the fabric's modulus.
    """

    meaning: str
    rule: SlopeRule = "smooth"
    form: Literal["itself", "log", "asinh"] = "itself"
    per_modulus: bool = False


QUANTITIES = {
    "lam": LawQuantity("length of the flat free sheet over its printed length", "monotone", "log"),
    "lam_n": LawQuantity("the same of the tube that the sheet wants to be: sqrt(hoop x axial)", "monotone", "log"),
    "kappa": LawQuantity("natural curvature, mean over directions, 1/mm", form="asinh"),
    "bending": LawQuantity(
        "bending stiffness: secant from flat to the natural tube, N mm", form="log", per_modulus=True
    ),
    "a11": LawQuantity("membrane stiffness of the natural tube, N/mm", form="log", per_modulus=True),
    "a12": LawQuantity("membrane stiffness across, N/mm", per_modulus=True),
    "c3": LawQuantity("sixfold part of the bending energy, N mm^2", per_modulus=True),
    "offset_mm": LawQuantity("height of the star's centre over the reference surface, mm"),
}
QUANTITY_NAMES = tuple(QUANTITIES)
_LOG, _ASINH = (np.array([q.form == form for q in QUANTITIES.values()]) for form in ("log", "asinh"))
# natural curvature times spacing, above which the scales of star and sheet do not separate
MAX_SEPARATED_CURL = 1.5
# curvature from which its logarithm is interpolated, times the spacing of the stars
SMALL_CURL = 0.03
NODE_TOLERANCE = 1e-9  # mm, or logarithms: places so near to a node are on it, and in all boxes around it


@dataclass(frozen=True)
class LawValues:
    """The law at N stars.

    Attributes
    ----------
    value : for each of `QUANTITY_NAMES` (N,).
    slope : the derivatives by length, thickness and width in mm, (N, 3).
    inside : (N,) False where the law does not reach; there the values are those of the nearest sizes in its range,
        and the slopes across the range are zero. Between bare fabric and first cells that are far from it (`reach`),
        the values are still those of the curve that joins them.
    outside : one line for each such star.
    tight : (N,) True if a sheet of such stars curls within its own spacing (`MAX_SEPARATED_CURL`): the values are those
        of its cell, but sheets of different stars need not follow them. The law's stated accuracy ends there.
    """

    value: dict[str, Floats]
    slope: dict[str, Floats]
    inside: Bools
    outside: tuple[str, ...]
    tight: Bools


@dataclass(frozen=True)
class LawTable:
    """The law at one stretch.

    Attributes
    ----------
    spacing_mm : of the stars.
    axes : nodes of length, thickness and width, mm.
    nodes : (n0, n1, n2, Q) values of `QUANTITY_NAMES`; all of length 0 are the bare fabric's.
    reliefs : (n0, n1, n2, 2, W) mm and mm^2, amplitudes of the waves of `CorrugationWaves`, flat, and more per
        curvature.
    good : (n0, n1, n2) False where a cell, of scattered ones the nearest, has no answer and the others on its line of
        lengths stand in: between two answers that is the interpolation of a coarser grid; elsewhere the law does not
        reach.
    units : (Q,) that the forms of the quantities are in, see `quantity_units`.
    anisotropies : (n0, n1, n2, K) what differs between directions, `homogenize.law.anisotropy`; mostly nothing, K = 0.
    """

    stretch: float
    spacing_mm: float
    axes: tuple[Floats, Floats, Floats]
    nodes: Floats
    reliefs: Floats
    good: Bools
    units: Floats
    anisotropies: Floats

    @cached_property
    def _grid(self) -> HermiteGrid:
        stored = to_stored(self.nodes, self.units)
        rules = [quantity.rule for quantity in QUANTITIES.values()]
        return HermiteGrid((self.axes[0], np.log(self.axes[1]), np.log(self.axes[2])), stored, rules)

    @cached_property
    def _reliefs(self) -> HermiteGrid:
        return self._smooth(self.reliefs.reshape(*self.reliefs.shape[:3], -1))

    @cached_property
    def _anisotropies(self) -> HermiteGrid:
        return self._smooth(self.anisotropies)

    def _smooth(self, columns: Floats) -> HermiteGrid:
        rules: list[SlopeRule] = ["smooth"] * columns.shape[-1]
        return HermiteGrid((self.axes[0], np.log(self.axes[1]), np.log(self.axes[2])), columns, rules)

    @cached_property
    def least_length_mm(self) -> float:
        """The shortest arms that the law answers for; 0 if all are."""
        return min_length(self.axes[0], self.spacing_mm)

    @cached_property
    def _limits(self) -> Floats:
        """(2, 3) least and largest sizes, with room for rounding."""
        low, high = (np.array([axis[end] for axis in self.axes]) for end in (0, -1))
        low[0] = self.least_length_mm
        return np.array([low - 1e-9 * (high + 1), high + 1e-9 * (high + 1)])

    @cached_property
    def _whole(self) -> Bools:
        """(boxes,) False where a corner has no answer and is not between two that have one on its line of lengths."""
        whole = self.good.copy()
        whole[1:-1] |= self.good[:-2] & self.good[2:]
        for axis in range(3):
            if whole.shape[axis] > 1:
                n = whole.shape[axis]
                whole = np.take(whole, range(n - 1), axis) & np.take(whole, range(1, n), axis)
        return whole.ravel()

    def __call__(self, length_mm: ArrayLike, thickness_mm: ArrayLike, width_mm: ArrayLike) -> LawValues:
        """The law at stars of these sizes, each (N,) or a number."""
        asked = _rows(length_mm, thickness_mm, width_mm)
        low, high = self._limits
        within = (asked >= low) & (asked <= high)
        # without arms there is neither thickness nor width, and bare fabric is always known
        within |= asked[:, :1] == 0.0
        sizes, places = self._places(asked)
        value, slope = self._grid(places)
        slope[:, 1:] /= sizes[:, 1:, None]
        slope *= within[:, :, None]
        slope *= _rate(value, self.units)[:, None]
        value = from_stored(value, self.units)
        solved = self._is_solved(places) | (asked[:, 0] == 0.0)
        inside = within.all(axis=1) & solved
        outside = () if inside.all() else tuple(self._why(int(n), asked[n], within[n]) for n in np.flatnonzero(~inside))
        return LawValues(
            {name: value[:, q] for q, name in enumerate(QUANTITY_NAMES)},
            {name: slope[:, :, q] for q, name in enumerate(QUANTITY_NAMES)},
            inside,
            outside,
            np.abs(value[:, QUANTITY_NAMES.index("kappa")]) * self.spacing_mm > MAX_SEPARATED_CURL,
        )

    def _is_solved(self, places: Floats) -> Bools:
        """(N,) whether a place on the grid is in a box that has its answers, or on the rim of one."""
        solved = self._whole[self._grid.box(places)[0]]
        for sides in () if solved.all() else product((-NODE_TOLERANCE, NODE_TOLERANCE), repeat=3):
            solved |= self._whole[self._grid.box(places + np.array(sides))[0]]
        return solved

    def relief(self, length_mm: ArrayLike, thickness_mm: ArrayLike, width_mm: ArrayLike) -> Floats:
        """(N, 2, W) mm and mm^2, amplitudes of the stars' heights over the mean surface, of the waves `Law.waves`.

        `relief[:, 0] + k * relief[:, 1]` where the sum of the sheet's principal curvatures is k (1/mm, positive with
        the plastic outside): flat cells give the first, natural tubes the second. Beyond the law's range those of the
        nearest sizes in it.
        """
        found = self._reliefs(self._places(_rows(length_mm, thickness_mm, width_mm))[1])[0]
        return found.reshape(len(found), *self.reliefs.shape[3:])

    def anisotropy(self, length_mm: ArrayLike, thickness_mm: ArrayLike, width_mm: ArrayLike) -> Floats:
        """(N, K) what differs between directions, see `homogenize.law.anisotropy`; K is 0 where nothing does.

        Beyond the law's range that of the nearest sizes in it.
        """
        sizes = _rows(length_mm, thickness_mm, width_mm)
        if self.anisotropies.shape[-1] == 0:
            return np.empty((len(sizes), 0))
        return self._anisotropies(self._places(sizes)[1])[0]

    def _places(self, asked: Floats) -> tuple[Floats, Floats]:
        """Sizes (N, 3) within the range, and their places on the grid."""
        sizes = np.clip(np.nan_to_num(asked, nan=0.0), [a[0] for a in self.axes], [a[-1] for a in self.axes])
        return sizes, np.column_stack([sizes[:, 0], np.log(sizes[:, 1]), np.log(sizes[:, 2])])

    def _why(self, star: int, sizes: Floats, within: Bools) -> str:
        ends = np.array([[self.least_length_mm, *(axis[0] for axis in self.axes[1:])], [a[-1] for a in self.axes]])
        for name, size, (low, high), fine in zip(SIZE_KEYS, sizes, ends.T, within, strict=True):
            if not fine:
                its = f"{low:g}" if low == high else f"{low:g} to {high:g}"
                return f"star {star}: {name} = {size:g} is outside the law's {its}"
        l_h_w = ", ".join(f"{name} = {size:g}" for name, size in zip(SIZE_KEYS, sizes, strict=True))
        return f"star {star}: no cell was solved near {l_h_w}"


def _rows(*sizes: ArrayLike) -> Floats:
    """(N, 3) of three sizes, each (N,) or a number."""
    return np.column_stack(
        [x.ravel() for x in np.broadcast_arrays(*(np.atleast_1d(np.asarray(x, float)) for x in sizes))]
    )


def quantity_units(fabric: Floats, spacing_mm: float) -> Floats:
    """(Q,) the bare fabric's value for logarithms, the small curvature for asinh."""
    return np.where(_LOG, fabric, np.where(_ASINH, SMALL_CURL / spacing_mm, 1.0))


def to_stored(rows: Floats, units: Floats) -> Floats:
    """Rows (..., Q) of `QUANTITY_NAMES` in the forms that are interpolated."""
    x = rows / units
    return np.where(_LOG, np.log(np.where(_LOG, x, 1.0)), np.where(_ASINH, np.arcsinh(x), x))


def from_stored(stored: Floats, units: Floats) -> Floats:
    """The inverse of `to_stored`."""
    return units * np.where(
        _LOG, np.exp(np.where(_LOG, stored, 0.0)), np.where(_ASINH, np.sinh(np.where(_ASINH, stored, 0.0)), stored)
    )


def _rate(stored: Floats, units: Floats) -> Floats:
    """Derivative of `from_stored`."""
    return units * np.where(_LOG, np.exp(np.where(_LOG, stored, 0.0)), np.cosh(np.where(_ASINH, stored, 0.0)))
