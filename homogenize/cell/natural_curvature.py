"""The curvature that a cell takes on its own: the tube without a moment, on the branch that begins flat.

The path goes by small steps of curvature, each tube laid out and rolled again to be the start of the next one, so that
stars follow their branch instead of choosing the lowest energy. The way to the first direction's natural tube serves
the others as well where sheets do not curl tightly: they begin with that tube, turned. Tight tubes have more branches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from discrete.energies.elements import Array
from homogenize.cell.flat_cell import FlatCell
from homogenize.cell.rolling import Tube, UnrolledCell, roll_cell, unroll, unrolled_flat_cell, unrolled_in_direction
from homogenize.cell.unit_cell import UnitCell

# curvatures times the spacing of the stars
FIRST_CURL = 0.06  # the first one
MAX_CURL_STEP = 0.6  # longest step
MAX_SEARCHED_CURL = 1.5  # until here a moment towards more curvature is waited for, and directions are alike
MAX_CURL = 8.0  # a star wraps more than once; such sheets have no meaning, but their law stays continuous
MAX_CURVATURE_STEP_RATIO = 2.5  # of the curvature from one step to the next
ROUNDING_MOMENT_RATIO = (
    1e-3  # of the first tube's moment, below which that of the flat cell is rounding and higher order
)
MIN_NATURAL_CURL = (
    0.015  # natural curvatures that are not looked for: so far from its axis, a tube's moment is rounding
)
ROOT_TOLERANCE = 1e-5  # relative to the curvature, or to one over the spacing, where the natural one is found
MIN_SNAP_BUMP_RATIO = 0.029  # of the spacing, bumps that are not just flat
OVERSHOOT_FACTOR = 1.15  # steps past the place where the moment is expected to vanish, to have its sign on both sides
MAX_TRIAL_STEPS = 3  # such steps, from a tube of another direction
CurvatureMoment = tuple[float, float]  # curvature and moment


@dataclass(frozen=True)
class TubeBranch:
    """Tubes in one direction.

    Attributes
    ----------
    tubes : in the order of their curvature.
    natural : the one without a moment; None if it is hardly curved, `tubes` is then one that shows its stiffness.
    slight, stiffness : 1/mm and N mm, both of the print: the natural curvature and the stiffness that the parabola
        through the energies of the flat cell and of that tube has; used only without `natural`.
    """

    tubes: list[Tube]
    natural: Tube | None
    slight: float = 0.0
    stiffness: float = 0.0


def trace_tubes(cell: UnitCell, flat: FlatCell, angle: float, known: TubeBranch | None = None) -> TubeBranch:
    """Tubes from a small curvature to the natural one and a little beyond; `known`: those of another direction.

    Curvature grows, the plastic outside, until the moment changes sign; then a parabola through the nearest tubes, kept
    between the last two signs, finds its root. Below `MIN_NATURAL_CURL` the energy's parabola gives it. If the
    flat cell's moment, and those of tubes up to `MAX_SEARCHED_CURL`, hold against that, the other side is tried.

    Raises
    ------
    ArithmeticError
        A step did not converge, a star snapped to the other side on the way, or no root was found.
    """
    walk = _Walk(cell, flat, angle)
    first = walk.to(FIRST_CURL / cell.spacing)
    rest = 2.0 * (first.energy - flat.energy) / first.curvature - first.moment  # of the parabola through both
    stiffness = (first.moment - rest) / first.curvature
    if stiffness > 0.0 and abs(rest) < MIN_NATURAL_CURL / cell.spacing * stiffness:
        slight = 0.0 if abs(rest) < ROUNDING_MOMENT_RATIO * abs(first.moment) else -rest / stiffness
        return TubeBranch(walk.tubes, None, slight, stiffness)
    if known and known.natural and abs(known.natural.curvature) < MAX_SEARCHED_CURL / cell.spacing:
        try:
            return _Walk(cell, flat, angle, walk.tubes).from_another(known.natural, known.tubes)
        except ArithmeticError:
            pass  # then the long way
    if rest > 0.0 and first.moment > 0.0 and not walk.finds_negative(1.0):
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
    """Tubes found so far."""

    def __init__(self, cell: UnitCell, flat: FlatCell, angle: float, tubes: Sequence[Tube] = ()) -> None:
        self.cell, self.angle = cell, angle
        self.tubes = list(tubes)
        self._flat = flat

    def to(self, curvature: float) -> Tube:
        """The tube of this curvature, from the nearest one."""
        if not self.tubes:
            return self._roll(unrolled_flat_cell(self._flat, self.angle), self._flat.bump, curvature)
        nearest = min(self.tubes, key=lambda tube: abs(tube.curvature - curvature))
        return self._roll(unroll(self.cell, nearest), nearest.bump, curvature)

    def _roll(self, sheet: UnrolledCell, bump: Array, curvature: float) -> Tube:
        tube = roll_cell(self.cell, sheet, curvature, self.angle)
        side = np.sign(curvature)  # a star that leaves the wrong side finds its branch
        snap = MIN_SNAP_BUMP_RATIO * self.cell.spacing
        if ((side * bump > snap) & (side * tube.bump < -snap)).any():
            raise ArithmeticError(f"tube: a star snapped to the other side at curvature {curvature:.4g}/mm")
        self.tubes.append(tube)
        return tube

    def on(self, sign: float, most: float = np.inf) -> Tube:
        """One step to more curvature."""
        size = abs(self.tubes[-1].curvature)
        k = min(MAX_CURVATURE_STEP_RATIO * size, size + MAX_CURL_STEP / self.cell.spacing, most)
        if k > MAX_CURL / self.cell.spacing:
            raise ArithmeticError(f"tube: still curling at {sign * k:.3g}/mm, the tightest tried")
        return self.to(sign * k)

    def finds_negative(self, sign: float) -> bool:
        """Walk until the moment pulls to more curvature; False if it does not."""
        while abs(self.tubes[-1].curvature) < MAX_SEARCHED_CURL / self.cell.spacing:
            if self.on(sign).moment * sign < 0.0:
                return True
        return False

    def from_another(self, natural: Tube, known: list[Tube]) -> TubeBranch:
        """The root near the natural tube of another direction, which curls by nearly as much.

        Raises
        ------
        ArithmeticError
            The branch was left, or the moment's sign did not change nearby.
        """
        sign = float(np.sign(natural.curvature))
        sheet = unrolled_in_direction(self.cell, natural, self.angle)
        here = self._roll(sheet, natural.bump, natural.curvature)
        other = min(known, key=lambda tube: abs(tube.curvature - natural.curvature) or np.inf)
        slope = (other.moment - natural.moment) / (other.curvature - natural.curvature)
        for _ in range(MAX_TRIAL_STEPS):
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
    """Where the line through two points (curvature, moment) has no moment."""
    return b[0] - b[1] * (b[0] - a[0]) / (b[1] - a[1])


def _root(low: CurvatureMoment, high: CurvatureMoment, known: list[CurvatureMoment]) -> float:
    """Between two points of opposite signs: of the parabola k(M) through the three nearest to zero, or of the line."""
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
