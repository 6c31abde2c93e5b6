"""The universal law: dimensionless responses of unit cells as smooth functions of their dimensionless groups.

It interpolates 4458 solved cells, which the file of the package holds, by kriging with a Matern kernel: a sum of
kernels about the cells (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, eqs. 2.25 and 4.17).
Every kernel carries the factor `u(x) u(x')`. With the arm's length as u the function is exactly zero for stars without
arms, the bare fabric.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import DAMAGED_FILE_ERRORS
from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from asterism.homogenize.universal.groups import (
    GROUP_KEYS,
    GROUPS,
    MAX_ARM_CURL,
    MIN_FABRIC_TO_EDGE,
    arm_curl,
    coordinates_of_groups,
    mismatch,
)

PACKAGED_UNIVERSAL_LAW = Path(__file__).parents[1] / "data" / "universal.npz"
# quantities whose errors a preview states
STATED_QUANTITIES = ("lam_n", "kappa", "bending")
# An error is relative to the value of the cell, or to this dimensionless value if that is larger: a sheet of 10 stars
# across with a curvature of a fiftieth over the spacing rises by a fortieth of its diameter.
KAPPA_ERROR_FLOOR = 0.02
# cells whose left-out errors give the error at a star
NEAREST_CELLS = 12
# places that are evaluated together; with 64, or all at once, 4458 cells take 1.3 and 3.1 times as long
_BLOCK = 16
_POISSON = 0.3
# on equilateral triangles the paper's hinges are three times as stiff as the plate
_HINGES_OVER_PLATE = 3.0
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
_Q = len(QUANTITY_NAMES)
_ARM, _STRETCH, _BENDING, _COUPLE, _FABRIC, _EDGE = (
    GROUP_KEYS.index(key) for key in ("arm", "stretch", "bending", "couple", "fabric", "edge")
)


@dataclass(frozen=True)
class Kriging:
    """C functions of G coordinates that share their lengths.

    Attributes
    ----------
    places : (n, G) coordinates of the cells.
    factors : (n,) u at the cells.
    lengths : (G,) of the kernel.
    weights : (n, C).
    """

    places: Floats
    factors: Floats
    lengths: Floats
    weights: Floats

    def values(self, places: Floats, factors: Floats) -> Floats:
        """(N, C) at places (N, G) with the factors (N,)."""
        # one product gives the squared distances (times 5) of a block of places, which stays in the processor's cache
        own, asked = (np.sqrt(5.0) * each / self.lengths for each in (self.places, places))
        ones = np.ones((len(own), 1))
        others = np.hstack([-2.0 * own, ones, (own**2).sum(axis=1)[:, None]]).T.copy()
        ones = np.ones((len(asked), 1))
        asked = np.hstack([asked, (asked**2).sum(axis=1)[:, None], ones])
        rows = self.factors[:, None] * self.weights
        found = np.empty((len(asked), rows.shape[1]))
        for first in range(0, len(asked), _BLOCK):
            block = slice(first, first + _BLOCK)
            kernel = asked[block] @ others
            np.maximum(kernel, 0.0, out=kernel)
            scaled = np.sqrt(kernel)
            # (1 + r + r^2/3) exp(-r), the Matern kernel with two derivatives; r = sqrt(5) |x - x'|
            kernel *= 1.0 / 3.0
            kernel += scaled
            kernel += 1.0
            np.exp(np.negative(scaled, out=scaled), out=scaled)
            kernel *= scaled
            np.matmul(kernel, rows, out=found[block])
        return factors[:, None] * found


@dataclass(frozen=True)
class UniversalLaw:
    """The law and the cells that it goes through.

    Attributes
    ----------
    solved_groups : (N, G) groups of all solved cells, also those without an answer.
    usable : (N,) the n cells that the law goes through.
    parts : for each quantity its interpolation, and one for all waves ("waves").
    percent : (n, 3) absolute errors of `STATED_QUANTITIES` that the law would have at each of its cells without that
        cell.
    separated : (n,) the cells that are scale-separated; errors of others do not count.
    made : versions, command and machine.
    """

    solved_groups: Floats
    usable: Bools
    parts: dict[str, Kriging]
    percent: Floats
    separated: Bools
    made: dict[str, Any]

    def __call__(self, groups: Floats) -> Floats:
        """(N, Q + 2 W) quantities of `law_table.QUANTITY_NAMES` and amplitudes of the waves, for groups (N, G).

        The values are dimensionless, see `material_law.quantity_scales`. For stars without arms they are those of the
        bare fabric.
        """
        places = _kriging_places(groups)
        stored = np.column_stack(
            [part.values(places, _kernel_factors(name, groups)) for name, part in self.parts.items()]
        )
        return _from_smooth(stored, groups)

    def covers(self, groups: Floats) -> Bools:
        """(N,) whether groups (N, G) are inside the range, and the nearest of all solved cells can make the law."""
        nearest = cKDTree(self._scaled(self.solved_groups)).query(self._scaled(groups))[1]
        return np.asarray(within_limits(groups).all(axis=1) & self.usable[nearest])

    def errors(self, groups: Floats) -> Floats:
        """(N, 3) errors of `STATED_QUANTITIES` at the cells nearest to groups (N, G), see `errors_of_cells`."""
        tree = cKDTree(self._scaled(self.solved_groups[self.usable]))
        return errors_of_cells(self.percent, self.separated, tree.query(self._scaled(groups), NEAREST_CELLS)[1])

    def _scaled(self, groups: Floats) -> Floats:
        """(N, G) places of groups in the lengths of the curvature."""
        return _kriging_places(np.nan_to_num(groups)) / self.parts["kappa"].lengths


def load_universal_law(path: Path = PACKAGED_UNIVERSAL_LAW) -> UniversalLaw:
    """The universal law that comes with the package.

    Raises
    ------
    LawError
        The file is missing or damaged; one line.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            solved_groups = archive["cell_groups"]
            usable = archive["cell_problems"] == json.loads(archive["reasons"].tobytes()).index("")
            groups = solved_groups[usable]
            places = _kriging_places(groups)
            parts = {
                name: Kriging(
                    places, _kernel_factors(name, groups), archive[f"{name}/lengths"], archive[f"{name}/weights"]
                )
                for name in archive["parts"].tolist()
            }
            columns = [QUANTITY_NAMES.index(name) for name in STATED_QUANTITIES]
            cells, given = archive["cell_rows"][usable][:, columns], archive["left_out"][:, columns]
            made = json.loads(archive["made"].tobytes())
    except (OSError, *DAMAGED_FILE_ERRORS):
        raise LawError(f"{path}: the universal law is missing or damaged; install asterism again") from None
    floors = np.array([KAPPA_ERROR_FLOOR if name == "kappa" else 0.0 for name in STATED_QUANTITIES])
    percent = 100.0 * np.abs(given - cells) / np.maximum(np.abs(cells), floors)
    separated = np.abs(cells[:, STATED_QUANTITIES.index("kappa")]) <= MAX_SEPARATED_CURL
    return UniversalLaw(solved_groups, usable, parts, percent, separated, made)


def errors_of_cells(percent: Floats, separated: Bools, near: Ints) -> Floats:
    """(N, 3) rms of `STATED_QUANTITIES` over the scale-separated of the cells `near` (N, k), %.

    Infinite where fewer than half of these cells are scale-separated: nothing is known there.

    Parameters
    ----------
    percent, separated : of `UniversalLaw`.
    """
    weight = separated[near][..., None].astype(float)
    squares = weight * percent[near] ** 2
    count = weight.sum(axis=1)
    rms: Floats = np.sqrt(squares.sum(axis=1) / np.maximum(count, 1.0))
    rms[count[:, 0] < near.shape[1] / 2] = np.inf
    return rms


def _kriging_places(groups: Floats) -> Floats:
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


def _from_smooth(smooth: Floats, groups: Floats) -> Floats:
    """(N, Q + 2 W) quantities and waves, of what is interpolated, which is smooth over the range.

    Stiffnesses and contraction are logarithms of their ratios to the bare fabric. Curvature, offset and flat waves are
    nearly proportional to the couple and to a power of the arm's length as long as stars do not buckle, and are divided
    by that; the inverse hyperbolic sine bounds the values of buckled stars.
    """
    bare = bare_quantities(groups)
    # couple times `arm^ARM_POWER`; 0 for the bare fabric, whose couple is free
    units = np.nan_to_num(groups[:, _COUPLE], posinf=0.0) * groups[:, _ARM] ** ARM_POWER
    stored = {name: smooth[:, n] for n, name in enumerate(QUANTITY_NAMES)}
    base = {name: bare[:, n] for n, name in enumerate(QUANTITY_NAMES)}
    values = {name: base[name] * np.exp(stored[name]) for name in ("lam", "lam_n", "bending", "a11")}
    values["kappa"] = KAPPA_UNIT * units * np.sinh(stored["kappa"])
    values["a12"] = base["a12"] + base["a11"] * stored["a12"]
    values["c3"] = stored["c3"] * values["bending"]
    values["offset_mm"] = HEIGHT_UNIT * units * np.sinh(stored["offset_mm"])
    waves = smooth[:, _Q:]
    half = waves.shape[1] // 2  # of the flat cell, then of the change per curvature
    flat, rolled = HEIGHT_UNIT * units, ROLLED_WAVE_UNIT * groups[:, _ARM] ** ARM_POWER
    wave_units = np.column_stack([np.tile(flat[:, None], half), np.tile(rolled[:, None], half)])
    return np.column_stack([*(values[name] for name in QUANTITY_NAMES), wave_units * np.sinh(waves)])


def _kernel_factors(name: str, groups: Floats) -> Floats:
    """(N,) factor of the kernel of a part: the arm's length for what is 0 without arms, 1 for what has a unit."""
    return np.ones(len(groups)) if name in PARTS_WITH_UNITS else groups[:, _ARM]
