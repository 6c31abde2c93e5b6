"""The natural curvature of a cell: the tube with zero moment, on the branch that begins flat.

The path takes small steps of curvature. Each tube is unrolled, and rolled again as the start of the next one, so that
the stars follow their branch and do not jump to the lowest energy. If the sheet is scale-separated, the natural tube of
the first direction, rotated, is the start for the other directions. Tubes of strongly curled sheets have more branches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.flat_cell import FlatCell
from asterism.homogenize.cell.rolling import (
    Tube,
    UnrolledCell,
    part_way,
    roll_cell,
    unroll,
    unrolled_flat_cell,
    unrolled_in_direction,
)
from asterism.homogenize.cell.unit_cell import UnitCell

# curvature of the first tube, times the spacing of the stars
FIRST_CURL = 0.06
# curvature times spacing up to which a moment towards more curvature is searched, and directions resemble each other
MAX_SEARCHED_CURL = 1.5
# curvature times spacing at which the search ends: such stars wrap more than once and have no physical meaning, but
# they keep the law continuous
MAX_CURL = 8.0
# natural curvature times spacing, below which no tube is searched: its axis is so far away that rounding rules its
# moment
MIN_NATURAL_CURL = 0.015
# error of the natural curvature, over the curvature or one over the spacing
ROOT_TOLERANCE = 1e-5
# steps go so far beyond the expected root that the moment changes its sign
OVERSHOOT_FACTOR = 1.15
# curvature 1/mm and moment N
CurvatureMoment = tuple[float, float]


@dataclass(frozen=True)
class TubeBranch:
    """Tubes in one direction."""

    tubes: list[Tube]  # by growing curvature
    # the tube with zero moment; None if its curvature is below `MIN_NATURAL_CURL`. Then `tubes` holds one tube, which
    # gives the stiffness.
    natural: Tube | None
    # slight, stiffness: 1/mm and N mm, both of the print: natural curvature and stiffness of the parabola through the
    # energies of the flat cell and of that tube. They are for branches without `natural`.
    slight: float = 0.0
    stiffness: float = 0.0


def trace_tubes(cell: UnitCell, flat: FlatCell, angle: float, known: TubeBranch | None = None) -> TubeBranch:
    """Tubes from a small curvature to the natural one and slightly beyond.

    The curvature grows, with the plastic outside, until the moment changes its sign. Then a parabola through the
    nearest tubes, kept between the last two signs, finds the root. A natural curvature below `MIN_NATURAL_CURL` is that
    of the energy's parabola. If the moments of the flat cell and of tubes up to `MAX_SEARCHED_CURL` oppose more
    curvature, the other side is tried. Raises `ArithmeticError` if a step did not converge, a star snapped to the other
    side, or no root was found.

    Parameters
    ----------
    angle : of the printed direction around the tube, from y.
    known : the branch of another direction, as a start.
    """
    walk = _Walk(cell, flat, angle)
    first = walk.to(FIRST_CURL / cell.spacing)
    rest = 2.0 * (first.energy - flat.energy) / first.curvature - first.moment  # of the parabola through both
    stiffness = (first.moment - rest) / first.curvature
    if stiffness > 0.0 and abs(rest) < MIN_NATURAL_CURL / cell.spacing * stiffness:
        # smaller moments of the flat cell are rounding and higher order
        slight = 0.0 if abs(rest) < 1e-3 * abs(first.moment) else -rest / stiffness
        return TubeBranch(walk.tubes, None, slight, stiffness)
    if known and known.natural and abs(known.natural.curvature) < MAX_SEARCHED_CURL / cell.spacing:
        try:
            return _Walk(cell, flat, angle, walk.tubes).from_another(known.natural, known.tubes)
        except ArithmeticError:
            pass  # then from the flat cell
    if rest > 0.0 and first.moment > 0.0 and not walk.finds_negative():
        walk = _Walk(cell, flat, angle)
        walk.to(-FIRST_CURL / cell.spacing)
    sign = float(np.sign(walk.tubes[-1].curvature))
    low: CurvatureMoment = (0.0, rest)
    for tube in walk.tubes[:-1]:
        low = (tube.curvature, tube.moment)
    while walk.tubes[-1].moment * sign < 0.0:
        last = (walk.tubes[-1].curvature, walk.tubes[-1].moment)
        beyond = OVERSHOOT_FACTOR * sign * _secant(low, last)  # the moment is nearly linear
        walk.on(sign, beyond if beyond > 1.1 * abs(last[0]) else np.inf)
        low = last
    return walk.between(low, (walk.tubes[-1].curvature, walk.tubes[-1].moment), sign)


class _Walk:
    """The tubes on the path."""

    def __init__(self, cell: UnitCell, flat: FlatCell, angle: float, tubes: Sequence[Tube] = ()) -> None:
        self.cell, self.angle = cell, angle
        self.tubes = list(tubes)
        self._flat = flat

    def to(self, curvature: float) -> Tube:
        """The tube of this curvature, from the nearest known one, or from the straight way through the two nearest."""
        if not self.tubes:
            return self._roll(unrolled_flat_cell(self._flat, self.angle), self._flat.bump, curvature, 0.0)
        nearest, *others = sorted(self.tubes, key=lambda tube: abs(tube.curvature - curvature))
        sheet, part = unroll(self.cell, nearest), 0.0
        if others:
            part = (curvature - nearest.curvature) / (others[0].curvature - nearest.curvature)
        # steps beyond two tubes, over their difference, up to which the straight way through both is a better start
        # than the nearest one
        if 0.0 < abs(part) < 0.5:
            return self._roll(part_way(sheet, unroll(self.cell, others[0]), part), nearest.bump, curvature, 0.0)
        return self._roll(sheet, nearest.bump, curvature)

    # the matrix of a sheet that is bent further is indefinite, and would be refused with a smaller blend
    def _roll(self, sheet: UnrolledCell, bump: Array, curvature: float, blend: float = 0.9) -> Tube:
        tube = roll_cell(self.cell, sheet, curvature, self.angle, blend)
        side = np.sign(curvature)  # a star that leaves the wrong side only finds its branch
        snap = 0.029 * self.cell.spacing  # a star with a lower bump counts as flat
        if ((side * bump > snap) & (side * tube.bump < -snap)).any():
            raise ArithmeticError(f"tube: a star snapped to the other side at curvature {curvature:.4g}/mm")
        self.tubes.append(tube)
        return tube

    def on(self, sign: float, limit: float = np.inf) -> Tube:
        """One step to a larger curvature."""
        size = abs(self.tubes[-1].curvature)
        k = min(2.5 * size, size + 0.6 / self.cell.spacing, limit)
        if k > MAX_CURL / self.cell.spacing:
            raise ArithmeticError(f"tube: no natural curvature up to {sign * k:.3g}/mm")
        return self.to(sign * k)

    def finds_negative(self) -> bool:
        """Step to larger curvatures until the moment drives them further; False if it never does."""
        while abs(self.tubes[-1].curvature) < MAX_SEARCHED_CURL / self.cell.spacing:
            if self.on(1.0).moment < 0.0:
                return True
        return False

    def from_another(self, natural: Tube, known: list[Tube]) -> TubeBranch:
        """The root near the natural tube of another direction, whose curvature is similar."""
        sign = float(np.sign(natural.curvature))
        sheet = unrolled_in_direction(self.cell, natural, self.angle)
        here = self._roll(sheet, natural.bump, natural.curvature)
        other = min(known, key=lambda tube: abs(tube.curvature - natural.curvature) or np.inf)
        slope = (other.moment - natural.moment) / (other.curvature - natural.curvature)
        for _ in range(3):
            if slope <= 0.0:
                break
            k = here.curvature - OVERSHOOT_FACTOR * here.moment / slope
            if not FIRST_CURL < sign * k * self.cell.spacing < MAX_CURL:
                break
            last, here = here, self.to(k)
            if here.moment * last.moment < 0.0:
                ends = sorted((last, here), key=lambda tube: tube.moment * sign)
                low, high = ((tube.curvature, tube.moment) for tube in ends)
                return self.between(low, high, sign)
            slope = (here.moment - last.moment) / (here.curvature - last.curvature)
        raise ArithmeticError("tube: no natural curvature near that of the other direction")

    def between(self, low: CurvatureMoment, high: CurvatureMoment, sign: float) -> TubeBranch:
        """The root between two signs of the moment."""
        for _ in range(12):
            k = _root(low, high, [(tube.curvature, tube.moment) for tube in self.tubes])
            nearest = min(self.tubes, key=lambda tube: abs(tube.curvature - k))
            if abs(nearest.curvature - k) < ROOT_TOLERANCE * max(abs(k), 1.0 / self.cell.spacing):
                return TubeBranch(sorted(self.tubes, key=lambda tube: tube.curvature), nearest)
            here = (k, self.to(k).moment)
            low, high = (here, high) if here[1] * sign < 0.0 else (low, here)
        raise ArithmeticError("tube: the natural curvature was not found")


def _secant(a: CurvatureMoment, b: CurvatureMoment) -> float:
    """Root of the line through two points (curvature, moment)."""
    return b[0] - b[1] * (b[0] - a[0]) / (b[1] - a[1])


def _root(low: CurvatureMoment, high: CurvatureMoment, known: list[CurvatureMoment]) -> float:
    """A root between two points of opposite signs.

    It is that of the parabola k(M) through the three points of smallest moment, or of the line if that lies outside.
    """
    if len(known) < 3:
        return _secant(low, high)
    (a, fa), (b, fb), (c, fc) = sorted(known, key=lambda point: abs(point[1]))[:3]
    if fb not in (fa, fc) and fa != fc:
        k = (
            a * fb * fc / ((fa - fb) * (fa - fc))
            + b * fa * fc / ((fb - fa) * (fb - fc))
            + c * fa * fb / ((fc - fa) * (fc - fb))
        )
        if min(low[0], high[0]) < k < max(low[0], high[0]):
            return k
    return _secant(low, high)
