"""The universal law: dimensionless responses of unit cells as smooth functions of their dimensionless groups."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.universal.groups import (
    GROUP_KEYS,
    GROUPS,
    MAX_ARM_CURL,
    MIN_FABRIC_TO_EDGE,
    arm_curl,
    coordinates_of_groups,
    mismatch,
)
from asterism.homogenize.universal.kriging import Kriging, likely_covariance
from asterism.homogenize.universal.solved_cells import WAVE_NAMES, SolvedCells

_POISSON = 0.3
# on equilateral triangles the paper's hinges are three times as stiff as the plate
_HINGES_OVER_PLATE = 3.0
# fewer usable cells give no law
MIN_CELLS = 40
# of a coordinate: rounding at the limits of the groups
LIMIT_TOLERANCE = 1e-6
# arm length over spacing, below which arms count as so long in the coordinates: shorter ones change little
MIN_SLENDER_ARM = 0.05
# units of what is nearly proportional to the couple; chosen by the left-out errors of 863 cells
ARM_POWER = 1.5
KAPPA_UNIT = 20.0
HEIGHT_UNIT = 5.0
ROLLED_WAVE_UNIT = 0.05
PARTS_WITH_UNITS = ("kappa", "offset_mm", "waves")
# parts whose cells count with the same scatter everywhere: 95 % of the left-out cells are then nearer
PARTS_WITH_EVEN_SCATTER = ("lam", "lam_n", "a11", "waves")
_Q = len(QUANTITY_NAMES)
_ARM, _STRETCH, _BENDING, _COUPLE, _FABRIC, _EDGE = (
    GROUP_KEYS.index(key) for key in ("arm", "stretch", "bending", "couple", "fabric", "edge")
)


@dataclass(frozen=True)
class UniversalLaw:
    """The law and the cells that it goes through.

    Attributes
    ----------
    cells : all solved cells, also those without an answer.
    parts : for each quantity its interpolation, and one for all waves ("waves").
    left_out : (n, Q) quantities that the law would give at each cell that it goes through without that cell; the
        covariance of the interpolation is that of all cells.
    spread_count : so many of the cells, the first ones, are spread evenly over the range.
    made : versions, command and machine.
    """

    cells: SolvedCells
    parts: dict[str, Kriging]
    left_out: Floats
    spread_count: int
    made: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def groups(self) -> Floats:
        """(n, G) groups of the cells that the law goes through."""
        return self.cells.groups[self.cells.usable]

    @cached_property
    def rows(self) -> Floats:
        """(n, R) their dimensionless responses."""
        return self.cells.rows[self.cells.usable]

    @cached_property
    def spread(self) -> Bools:
        """(n,) which of the cells that the law goes through are spread evenly over the range."""
        return np.asarray(np.flatnonzero(self.cells.usable) < self.spread_count)

    def __call__(self, groups: Floats) -> Floats:
        """(N, Q + 2 W) quantities of `law_table.QUANTITY_NAMES` and amplitudes of the waves, for groups (N, G).

        The values are dimensionless, see `cell_rows`. For stars without arms they are those of the bare fabric.
        """
        places = kriging_places(groups)
        stored = np.column_stack(
            [part.values(places, kernel_factors(name, groups)) for name, part in self.parts.items()]
        )
        return from_smooth(stored, groups)

    def covers(self, groups: Floats) -> Bools:
        """(N,) whether groups (N, G) are inside the range, and the nearest of all solved cells can make the law."""
        nearest = self._tree.query(self._scaled(groups))[1]
        return np.asarray(within_limits(groups).all(axis=1) & self.cells.usable[nearest])

    def nearest_cells(self, groups: Floats, count: int) -> Ints:
        """(N, count) numbers of the cells of the law nearest to groups (N, G), in the lengths of its curvature."""
        tree = cKDTree(self._scaled(self.groups))
        return np.reshape(tree.query(self._scaled(groups), min(count, len(self.groups)))[1], (len(groups), -1))

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self._scaled(self.cells.groups))

    def _scaled(self, groups: Floats) -> Floats:
        return kriging_places(np.nan_to_num(groups)) / self.parts["kappa"].covariance.lengths


def universal_law(
    cells: SolvedCells,
    spread_count: int,
    made: dict[str, Any] | None = None,
) -> UniversalLaw:
    """The law through cells. Equal cells give equal numbers.

    Parameters
    ----------
    spread_count, made : see `UniversalLaw`.

    Raises
    ------
    CampaignError
        Too few cells have an answer.
    """
    usable = cells.usable
    if usable.sum() < MIN_CELLS:
        raise CampaignError(f"the universal law needs {MIN_CELLS} cells with an answer, and has {usable.sum()}")
    groups = cells.groups[usable]
    smooth, columns = to_smooth(cells.rows[usable], groups), _columns()
    places = kriging_places(groups)
    parts, left_out = {}, []
    for name, own in columns.items():
        lead = own[int(np.argmax(np.std(smooth[:, own], axis=0)))]  # waves share the covariance of the largest one
        factors = kernel_factors(name, groups)
        covariance = likely_covariance(places, factors, smooth[:, lead], name in PARTS_WITH_EVEN_SCATTER)
        parts[name] = Kriging.through(places, factors, smooth[:, own], covariance)
        left_out.append(parts[name].left_out(smooth[:, own]))
    quantities = from_smooth(np.hstack(left_out), groups)[:, :_Q]
    return UniversalLaw(cells, parts, quantities, spread_count, made or {})


def kriging_places(groups: Floats) -> Floats:
    """(N, G) coordinates that the law is interpolated over, of groups (N, G).

    The bending number is divided by the mismatch of the metrics and by the square of the arm's length, as the load of
    a slender arm over its buckling load is: arms of all lengths and stretches then begin to curl at similar places. The
    arm's length is a logarithm.
    """
    arms = np.maximum(groups[:, _ARM], MIN_SLENDER_ARM)
    with np.errstate(divide="ignore", invalid="ignore"):
        places = coordinates_of_groups(groups)
        shortest, longest = GROUPS[_ARM].limits
        places[:, _ARM] = np.log(arms / shortest) / np.log(longest / shortest)
        low, high = GROUPS[_BENDING].limits
        places[:, _BENDING] -= np.log(mismatch(groups[:, _STRETCH]) * arms**2) / np.log(high / low)
    return np.nan_to_num(places, neginf=0.0, posinf=1.0)


def within_limits(groups: Floats) -> Bools:
    """(N, G) whether groups (N, G) are inside their limits; bare fabric (arm 0) is inside, and its couple is free."""
    with np.errstate(invalid="ignore"):
        places = coordinates_of_groups(groups)
        within = (places >= -LIMIT_TOLERANCE) & (places <= 1.0 + LIMIT_TOLERANCE)
        within[:, _BENDING] &= arm_curl(groups) <= MAX_ARM_CURL * (1.0 + LIMIT_TOLERANCE)
        within[:, _EDGE] &= groups[:, _FABRIC] >= MIN_FABRIC_TO_EDGE * groups[:, _EDGE] * (1.0 - LIMIT_TOLERANCE)
    within[:, _ARM] |= groups[:, _ARM] == 0.0
    return within


def bare_quantities(groups: Floats) -> Floats:
    """(N, Q) dimensionless quantities of the bare fabric: stretched by the print, flat, with the hinges of the paper.

    Moduli refer to areas and strains of the print, so powers of the stretch enter.
    """
    stretch, plate = groups[:, _STRETCH], groups[:, _FABRIC]
    zero = np.zeros(len(groups))
    a11 = stretch**2 / (1.0 - _POISSON**2)
    bare = {
        "lam": 1.0 / stretch,
        "lam_n": 1.0 / stretch,
        "bending": _HINGES_OVER_PLATE * plate**2 / (12.0 * (1.0 - _POISSON**2) * stretch**2),
        "a11": a11,
        "a12": _POISSON * a11,
    }
    return np.column_stack([bare.get(name, zero) for name in QUANTITY_NAMES])


def to_smooth(rows: Floats, groups: Floats) -> Floats:
    """(N, Q + 2 W) what is interpolated, of rows (N, R); smooth over the range.

    Stiffnesses and contraction are logarithms of their ratios to the bare fabric. Curvature, offset and flat waves are
    nearly proportional to the couple and to a power of the arm's length as long as stars do not buckle, and are divided
    by that; the inverse hyperbolic sine bounds the values of buckled stars.
    """
    bare, units = bare_quantities(groups), _couple_units(groups)
    values = {name: rows[:, n] for n, name in enumerate(QUANTITY_NAMES)}
    base = {name: bare[:, n] for n, name in enumerate(QUANTITY_NAMES)}
    smooth = {name: np.log(values[name] / base[name]) for name in ("lam", "lam_n", "bending", "a11")}
    smooth["kappa"] = np.arcsinh(values["kappa"] / (KAPPA_UNIT * units))
    smooth["a12"] = (values["a12"] - base["a12"]) / base["a11"]
    smooth["c3"] = values["c3"] / values["bending"]
    smooth["offset_mm"] = np.arcsinh(values["offset_mm"] / (HEIGHT_UNIT * units))
    waves = np.arcsinh(rows[:, _Q : _Q + len(WAVE_NAMES)] / _wave_units(groups))
    return np.column_stack([*(smooth[name] for name in QUANTITY_NAMES), waves])


def from_smooth(smooth: Floats, groups: Floats) -> Floats:
    """The inverse of `to_smooth`."""
    bare, units = bare_quantities(groups), _couple_units(groups)
    stored = {name: smooth[:, n] for n, name in enumerate(QUANTITY_NAMES)}
    base = {name: bare[:, n] for n, name in enumerate(QUANTITY_NAMES)}
    values = {name: base[name] * np.exp(stored[name]) for name in ("lam", "lam_n", "bending", "a11")}
    values["kappa"] = KAPPA_UNIT * units * np.sinh(stored["kappa"])
    values["a12"] = base["a12"] + base["a11"] * stored["a12"]
    values["c3"] = stored["c3"] * values["bending"]
    values["offset_mm"] = HEIGHT_UNIT * units * np.sinh(stored["offset_mm"])
    waves = _wave_units(groups) * np.sinh(smooth[:, _Q:])
    return np.column_stack([*(values[name] for name in QUANTITY_NAMES), waves])


def _couple_units(groups: Floats) -> Floats:
    """(N,) couple times `arm^ARM_POWER`; 0 for the bare fabric, whose couple is free."""
    couple = np.nan_to_num(groups[:, _COUPLE], posinf=0.0)
    return np.asarray(couple * groups[:, _ARM] ** ARM_POWER)


def _wave_units(groups: Floats) -> Floats:
    """(N, 2 W) units of the waves: of the flat cell, and of the change per curvature."""
    flat, rolled = HEIGHT_UNIT * _couple_units(groups), ROLLED_WAVE_UNIT * groups[:, _ARM] ** ARM_POWER
    half = len(WAVE_NAMES) // 2
    return np.column_stack([np.tile(flat[:, None], half), np.tile(rolled[:, None], half)])


def kernel_factors(name: str, groups: Floats) -> Floats:
    """(N,) factor of the kernel of a part: the arm's length for what is 0 without arms, 1 for what has a unit."""
    return np.ones(len(groups)) if name in PARTS_WITH_UNITS else groups[:, _ARM]


def _columns() -> dict[str, list[int]]:
    """The columns of each part of the law, of the array of `to_smooth`."""
    columns = {name: [number] for number, name in enumerate(QUANTITY_NAMES)}
    return columns | {"waves": list(range(_Q, _Q + len(WAVE_NAMES)))}
