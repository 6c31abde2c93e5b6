"""The law at one stretch: its quantities as functions of a star's sizes, with their derivatives.

A table never extrapolates: outside its range, and next to cells without an answer, it marks its values.

Curvatures are positive with the plastic on the outside. Stiffnesses are per area of the print, which is the area of the
stretched fabric.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.law.axes import AXES, coordinates, min_length, named_sizes
from asterism.homogenize.law.hermite_grid import HermiteGrid, SlopeRule


@dataclass(frozen=True)
class LawQuantity:
    """One quantity of the law.

    Attributes
    ----------
    meaning : with its unit.
    rule : of the slopes at the nodes.
    form : what is interpolated. "log": logarithm of the ratio to the bare fabric's value, so that the quantity stays
        positive. "asinh": inverse hyperbolic sine, linear for small values of either sign and logarithmic for large
        ones. "itself": the quantity.
    per_modulus : the quantity is proportional to the modulus of the fabric.
    """

    meaning: str
    rule: SlopeRule = "smooth"
    form: Literal["itself", "log", "asinh"] = "itself"
    per_modulus: bool = False


QUANTITIES = {
    "lam": LawQuantity("length of the flat free sheet over its printed length", "monotone", "log"),
    "lam_n": LawQuantity("the same for the natural tube: sqrt(hoop stretch x axial stretch)", "monotone", "log"),
    "kappa": LawQuantity("natural curvature, mean over the directions, 1/mm", form="asinh"),
    "bending": LawQuantity(
        "bending stiffness, secant from the flat sheet to the natural tube, N mm", form="log", per_modulus=True
    ),
    "a11": LawQuantity("membrane stiffness A11 of the natural tube, N/mm", form="log", per_modulus=True),
    "a12": LawQuantity("membrane stiffness A12 of the natural tube, N/mm", per_modulus=True),
    "c3": LawQuantity("sixfold part of the bending energy, N mm^2", per_modulus=True),
    "offset_mm": LawQuantity("height of the star's centre over the reference surface, mm"),
}
QUANTITY_NAMES = tuple(QUANTITIES)
_LOG, _ASINH = (np.array([q.form == form for q in QUANTITIES.values()]) for form in ("log", "asinh"))
# natural curvature times spacing, above which a star is not scale-separated from its sheet
MAX_SEPARATED_CURL = 1.5
# natural curvature times spacing, above which its logarithm is interpolated
SMALL_CURL = 0.03
# mm, or difference of logarithms: a place so near to a node counts as on it, and in all boxes around it
NODE_TOLERANCE = 1e-9


@dataclass(frozen=True)
class LawValues:
    """The law at N stars.

    Attributes
    ----------
    value : (N,) for each of `QUANTITY_NAMES`.
    slope : (N, A) derivatives by the sizes of `axes.AXES`, for each of `QUANTITY_NAMES`.
    inside : (N,) False outside the range of the law. Values there are those of the nearest sizes in the range, and
        derivatives across the range are zero. Between the bare fabric and the shortest cells of a law that begins far
        from it (`law_range`), values are those of the curve that joins both.
    outside : one line for each star outside the range.
    not_scale_separated : (N,) True if a sheet of such stars curls to a radius below two thirds of their spacing
        (`MAX_SEPARATED_CURL`). The values are those of the cell, but a sheet whose stars differ need not follow them:
        the stated accuracy of the law ends here.
    """

    value: dict[str, Floats]
    slope: dict[str, Floats]
    inside: Bools
    outside: tuple[str, ...]
    not_scale_separated: Bools


@dataclass(frozen=True)
class LawTable:
    """The law at one stretch, as a function of A sizes (`axes.AXES`).

    Attributes
    ----------
    stretch : of the fabric, equal in x and y.
    spacing_mm : of the stars.
    axis_nodes : (n1,), ..., (nA,) increasing nodes of each axis.
    node_values : (n1, ..., nA, Q) values of `QUANTITY_NAMES`; at length 0 those of the bare fabric.
    corrugations : (n1, ..., nA, 2, W) amplitudes of `corrugation_waves`: of the flat cell in mm, and their change per
        curvature in mm^2.
    solved : (n1, ..., nA) False if the cell, or the nearest of scattered cells, has no answer. Its values then come
        from the other cells on its line of lengths. Between two answers this is an interpolation on a coarser grid;
        elsewhere the node lies outside the range of the law.
    units : (Q,) units of the interpolated forms, see `quantity_units`.
    anisotropies : (n1, ..., nA, K) differences between directions, see `anisotropy`; K is 0 for threefold symmetry.
    """

    stretch: float
    spacing_mm: float
    axis_nodes: tuple[Floats, ...]
    node_values: Floats
    corrugations: Floats
    solved: Bools
    units: Floats
    anisotropies: Floats

    @cached_property
    def _quantity_grid(self) -> HermiteGrid:
        rules = [quantity.rule for quantity in QUANTITIES.values()]
        return self._grid(to_stored(self.node_values, self.units), rules)

    @cached_property
    def _corrugation_grid(self) -> HermiteGrid:
        return self._smooth_grid(self.corrugations.reshape(*self.corrugations.shape[:-2], -1))

    @cached_property
    def _anisotropy_grid(self) -> HermiteGrid:
        return self._smooth_grid(self.anisotropies)

    def _smooth_grid(self, columns: Floats) -> HermiteGrid:
        return self._grid(columns, ["smooth"] * columns.shape[-1])

    def _grid(self, values: Floats, rules: list[SlopeRule]) -> HermiteGrid:
        nodes = [axis.coordinate(values) for axis, values in zip(AXES, self.axis_nodes, strict=True)]
        return HermiteGrid(nodes, values, rules)

    @cached_property
    def min_length_mm(self) -> float:
        """The shortest arms that the law covers; 0 if it covers all."""
        return min_length(self.axis_nodes[0], self.spacing_mm)

    @cached_property
    def _limits(self) -> Floats:
        """(2, A) smallest and largest sizes of the range."""
        limits = np.array([[nodes[end] for nodes in self.axis_nodes] for end in (0, -1)])
        limits[0, 0] = self.min_length_mm
        return limits

    @cached_property
    def _solved_boxes(self) -> Bools:
        """(boxes,) True if every corner has an answer, or lies between two answers on its line of lengths."""
        boxes = self.solved.copy()
        boxes[1:-1] |= self.solved[:-2] & self.solved[2:]
        for axis in range(boxes.ndim):
            if (n := boxes.shape[axis]) > 1:
                boxes = np.take(boxes, range(n - 1), axis) & np.take(boxes, range(1, n), axis)
        return boxes.ravel()

    @property
    def size_ranges(self) -> dict[str, tuple[float, float]]:
        """Smallest and largest size in mm that the table covers, by the keys of design files."""
        low, high = self._limits
        return {axis.key: (float(a), float(b)) for axis, a, b in zip(AXES, low, high, strict=True)}

    def __call__(self, *sizes: ArrayLike) -> LawValues:
        """The law at stars of these sizes.

        Parameters
        ----------
        sizes : length, thickness and width in mm (the order of `axes.AXES`), each (N,) or a number.

        Examples
        --------
        >>> from asterism.homogenize.law.law_file import load_law
        >>> table = load_law().at(1.35)
        >>> found = table([0.0, 9.0], 0.42, 1.2)
        >>> found.value["lam"].round(3)
        array([0.741, 0.823])
        >>> found.value["kappa"].round(4)  # 1/mm; bare fabric stays flat
        array([0.    , 0.0258])
        >>> table(9.0, 0.42, 5.0).outside
        ("star 0: width_mm = 5 is outside the law's 0.8 to 1.6",)
        """
        asked = _rows(sizes)
        low, high = self._limits
        rounding = NODE_TOLERANCE * (high + 1)
        within = (asked >= low - rounding) & (asked <= high + rounding)
        within |= asked[:, :1] == 0.0  # bare fabric has neither thickness nor width
        clipped, places = self._places(asked)
        value, slope = self._quantity_grid(places)
        for number, axis in enumerate(AXES):
            if axis.logarithmic:
                slope[:, number] /= clipped[:, number, None]
        slope *= within[:, :, None]
        slope *= _rate(value, self.units)[:, None]
        value = from_stored(value, self.units)
        inside = within.all(axis=1) & (self._is_solved(places) | (asked[:, 0] == 0.0))
        outside = tuple(self._why_outside(int(n), asked[n], within[n]) for n in np.flatnonzero(~inside))
        return LawValues(
            {name: value[:, q] for q, name in enumerate(QUANTITY_NAMES)},
            {name: slope[:, :, q] for q, name in enumerate(QUANTITY_NAMES)},
            inside,
            outside,
            np.abs(value[:, QUANTITY_NAMES.index("kappa")]) * self.spacing_mm > MAX_SEPARATED_CURL,
        )

    def _is_solved(self, places: Floats) -> Bools:
        """(N,) whether a place lies in a solved box, or on its boundary."""
        solved = self._solved_boxes[self._quantity_grid.box(places)[0]]
        for sides in () if solved.all() else product((-NODE_TOLERANCE, NODE_TOLERANCE), repeat=len(AXES)):
            solved |= self._solved_boxes[self._quantity_grid.box(places + np.array(sides))[0]]
        return solved

    def corrugation(self, *sizes: ArrayLike) -> Floats:
        """(N, 2, W) amplitudes of the stars' heights over the mean surface, for the waves `Law.waves`.

        The amplitudes are `c[:, 0] + k c[:, 1]`, in mm, where k (1/mm) is the sum of the principal curvatures of the
        sheet. Flat cells give the first, natural tubes the second. Outside the range of the law they are those of the
        nearest sizes in it.

        Parameters
        ----------
        sizes : see `__call__`.
        """
        parts = self._corrugation_grid(self._places(_rows(sizes))[1])[0]
        return parts.reshape(len(parts), *self.corrugations.shape[-2:])

    def anisotropy(self, *sizes: ArrayLike) -> Floats:
        """(N, K) differences between directions, see `homogenize.law.anisotropy`; K is 0 for threefold symmetry.

        Outside the range of the law they are those of the nearest sizes in it.

        Parameters
        ----------
        sizes : see `__call__`.
        """
        rows = _rows(sizes)
        if self.anisotropies.shape[-1] == 0:
            return np.empty((len(rows), 0))
        return self._anisotropy_grid(self._places(rows)[1])[0]

    def _places(self, asked: Floats) -> tuple[Floats, Floats]:
        """Sizes (N, A) clipped to the nodes, and their coordinates (N, A) on the grid."""
        low, high = ([nodes[end] for nodes in self.axis_nodes] for end in (0, -1))
        sizes = np.clip(np.nan_to_num(asked, nan=0.0), low, high)
        return sizes, coordinates(sizes)

    def _why_outside(self, star: int, sizes: Floats, within: Bools) -> str:
        for (key, size), (low, high), is_within in zip(named_sizes(sizes).items(), self._limits.T, within, strict=True):
            if not is_within:
                covered = f"{low:g}" if low == high else f"{low:g} to {high:g}"
                return f"star {star}: {key} = {size:g} is outside the law's {covered}"
        place = ", ".join(f"{key} = {size:g}" for key, size in named_sizes(sizes).items())
        return f"star {star}: no cell was solved near {place}"


def _rows(sizes: tuple[ArrayLike, ...]) -> Floats:
    """(N, A) of A sizes, each (N,) or a number."""
    if len(sizes) != len(AXES):
        raise TypeError(f"sizes: {len(sizes)} given, the law has {', '.join(axis.key for axis in AXES)}")
    arrays = np.broadcast_arrays(*(np.atleast_1d(np.asarray(size, float)) for size in sizes))
    return np.column_stack([array.ravel() for array in arrays])


def quantity_units(fabric: Floats, spacing_mm: float) -> Floats:
    """(Q,) the bare fabric's value for "log", the small curvature for "asinh", and 1 for "itself"."""
    return np.where(_LOG, fabric, np.where(_ASINH, SMALL_CURL / spacing_mm, 1.0))


def to_stored(rows: Floats, units: Floats) -> Floats:
    """The interpolated forms (..., Q) of rows (..., Q) of `QUANTITY_NAMES`."""
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
