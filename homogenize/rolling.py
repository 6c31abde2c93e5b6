"""A cell rolled to a tube of imposed curvature, and the curvature that it takes on its own.

The tube's axis is x and the plastic is outside; the printed direction t, y turned by an angle, runs around it.
Curvature k is the angle per
length of the *print*, positive with the plastic outside. A tube of mean radius r has the hoop stretch `k r` and the
curvature `1/r = k/hoop` of the contracted sheet.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from discrete.elements import Array
from discrete.stars import bump_heights
from discrete.state import State
from equilibrium.newton import minimise
from homogenize.cell import Cell
from homogenize.relax import Flat, clean, tolerance

FIRST = 0.06  # first curvature imposed, times the spacing of the stars
GROWTH = 2.5  # of the curvature from one step to the next, until the moment changes sign
TIGHTEST = 2.2  # times the spacing: beyond it a star wraps a third of the tube
FLAT = 1e-3  # of the first tube's moment, below which that of the flat cell is rounding and higher order
CLOSE = 1e-5  # relative to the curvature, where the natural one is found

Point = tuple[float, float]  # curvature and moment


@dataclass(frozen=True)
class Tube:
    """A cell in equilibrium as a tube.

    Attributes
    ----------
    curvature : k, 1/mm of the print, along t, y turned by `angle`.
    state : of the cell with these images.
    energy : N mm per mm^2 of print; moment : its derivative by k, N.
    radius : mm, mean of the surface weighted by printed area; hoop, axial : stretches of that surface.
    bump : (S,) mm.
    """

    curvature: float
    angle: float
    state: State
    energy: float
    moment: float
    radius: float
    hoop: float
    axial: float
    bump: Array
    gradient_norm: float
    definite: bool
    iterations: int

    @property
    def contracted(self) -> float:
        """1/mm, curvature of the contracted sheet: one over the mean radius."""
        return 1.0 / self.radius


@dataclass(frozen=True)
class Unrolled:
    """A state as printed directions see it: along the axis, around it (as length on the mean surface) and outwards."""

    positions: Array
    directors: Array
    hoop: float


def unrolled_flat(flat: Flat, angle: float) -> Unrolled:
    """A flat cell seen along a tube's axis: lines of equal angle on the tube are lines of equal height y on it."""
    across = np.linalg.solve(flat.deformation.T, np.array([-np.sin(angle), np.cos(angle)]))
    hoop = 1.0 / float(np.linalg.norm(across))
    (x, y) = hoop * across
    turn = np.array([[y, -x, 0.0], [x, y, 0.0], [0.0, 0.0, 1.0]])
    return Unrolled(flat.state.positions @ turn.T, flat.state.directors @ turn.T, hoop)


def unrolled(cell: Cell, tube: Tube) -> Unrolled:
    """A tube, slit and laid flat: arc lengths at the mean radius, heights above it."""
    n, k = cell.torus.n_base, tube.curvature
    x = tube.state.positions
    angle = _angles(cell, x[:n], k)
    radial = np.sign(k) * np.hypot(x[:n, 1], x[:n, 2])
    flat = np.column_stack([x[:n, 0], tube.hoop / k * angle, radial - tube.radius])
    macro = x[n:].copy()
    macro[:, 1] = tube.hoop * _around(cell, cell.cell_vectors)
    middle = _middles(cell, cell.images.unfold(x), k)
    return Unrolled(np.vstack([flat, macro]), _turned(tube.state.directors, -middle), tube.hoop)


def rolled(cell: Cell, sheet: Unrolled, curvature: float, angle: float) -> State:
    """The laid-out cell rolled to a tube; the cell takes on the tube's images."""
    cell.tube(curvature, angle)
    n = cell.torus.n_base
    base, radius = sheet.positions[:n], sheet.hoop / curvature
    turn = base[:, 1] / radius
    out = radius + base[:, 2]
    positions = np.zeros_like(sheet.positions)
    positions[:n] = np.column_stack([base[:, 0], out * np.sin(turn), out * np.cos(turn)])
    positions[n:, 0] = sheet.positions[n:, 0]
    middle = _middles(cell, cell.images.unfold(positions), curvature)
    return clean(cell, State(positions, _turned(sheet.directors, middle)))


def roll(cell: Cell, sheet: Unrolled, curvature: float, angle: float) -> Tube:
    """Roll the laid-out cell and find its equilibrium."""
    start = rolled(cell, sheet, curvature, angle)
    found = minimise(cell, start, cell.factor(), tolerance(cell))
    if not found.converged:
        raise ArithmeticError(f"tube: no equilibrium at curvature {curvature:.4g}/mm")
    k = curvature
    n = cell.torus.n_base
    x = found.state.positions
    radius = float(np.sign(k) * cell.weights @ np.hypot(x[:n, 1], x[:n, 2]))
    axial = float(np.linalg.solve(cell.cell_vectors, x[n:, 0]) @ cell.turn[0])
    return Tube(
        curvature=k,
        angle=cell.angle,
        state=found.state,
        energy=found.energy / cell.area,
        moment=cell.moment(found.state),
        radius=radius,
        hoop=k * radius,
        axial=axial,
        bump=bump_heights(cell.model, cell.unfolded(found.state)),
        gradient_norm=found.gradient_norm,
        definite=found.definite,
        iterations=found.iterations,
    )


def centre_offset(cell: Cell, tube: Tube) -> float:
    """mm, of the first star's centre over the tube's mean surface, towards the plastic."""
    y, z = tube.state.positions[cell.torus.star_vertices[0], 1:]
    return float(np.sign(tube.curvature) * np.hypot(y, z) - tube.radius)


def natural(cell: Cell, flat: Flat, angle: float) -> list[Tube]:
    """Tubes of growing curvature, then ever nearer to the one without a moment, which comes last.

    Every tube starts from one before, laid out and rolled again. Curvature grows from a small one until the moment
    changes sign; then a secant, kept between the last two signs, finds its root. A sheet without any natural curvature
    gives the first tube only: `is_flat` says so.

    Raises
    ------
    ArithmeticError
        A step did not converge, a star snapped to the other side on the way, or no root was found.
    """
    first = FIRST / cell.spacing
    tubes = [roll(cell, unrolled_flat(flat, angle), first, angle)]
    if is_flat(flat, tubes[0]):
        return tubes
    if moment_at_rest(flat, tubes[0]) > 0.0:
        tubes = [roll(cell, unrolled_flat(flat, angle), -first, angle)]
    side, sign = np.sign(flat.bump), np.sign(tubes[0].curvature)
    low = (0.0, moment_at_rest(flat, tubes[0]))
    while tubes[-1].moment * sign < 0.0:
        last = (tubes[-1].curvature, tubes[-1].moment)
        beyond = 1.15 * _secant(low, last)  # the moment is nearly linear
        k = sign * min(GROWTH * abs(last[0]), beyond * sign if beyond * sign > 1.1 * abs(last[0]) else np.inf)
        if abs(k) > TIGHTEST / cell.spacing:
            raise ArithmeticError(f"tube: still curling at {k:.3g}/mm, the tightest tried")
        tubes.append(_next(cell, tubes[-1], k, side))
        low = last
    high = (tubes[-1].curvature, tubes[-1].moment)
    for _ in range(12):
        k = _root(low, high, [(t.curvature, t.moment) for t in tubes])
        nearest = min(tubes, key=lambda tube: abs(tube.curvature - k))
        if abs(nearest.curvature - k) < CLOSE * abs(k):
            return [tube for tube in tubes if tube is not nearest] + [nearest]
        tubes.append(_next(cell, nearest, k, side))
        here = (k, tubes[-1].moment)
        low, high = (here, high) if here[1] * sign < 0.0 else (low, here)
    raise ArithmeticError("tube: the natural curvature was not found")


def moment_at_rest(flat: Flat, first: Tube) -> float:
    """N, dE/dk of the flat cell, by the parabola through its energy and a tube's energy and moment."""
    return 2.0 * (first.energy - flat.energy) / first.curvature - first.moment


def is_flat(flat: Flat, first: Tube) -> bool:
    """The flat cell has no moment: its energy grows as the square of the curvature."""
    return abs(moment_at_rest(flat, first)) < FLAT * abs(first.moment)


def _next(cell: Cell, tube: Tube, curvature: float, side: Array) -> Tube:
    found = roll(cell, unrolled(cell, tube), curvature, tube.angle)
    if (np.sign(found.bump) != side).any():
        raise ArithmeticError(f"a star snapped to the other side at curvature {curvature:.4g}/mm")
    return found


def _secant(a: Point, b: Point) -> float:
    """Where the line through two points (curvature, moment) has no moment."""
    return b[0] - b[1] * (b[0] - a[0]) / (b[1] - a[1])


def _root(low: Point, high: Point, known: list[Point]) -> float:
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


def _angles(cell: Cell, points: Array, curvature: float) -> Array:
    """(V,) rad about the axis, on the turn that the printed place says."""
    sign = np.sign(curvature)
    star = int(cell.torus.star_vertices[0])
    printed = curvature * _around(cell, cell.printed[: len(points)] - cell.printed[star])
    off = np.arctan2(sign * points[:, 1], sign * points[:, 2]) - printed
    return printed + off - 2.0 * np.pi * np.round(off / (2.0 * np.pi))


def _around(cell: Cell, printed: Array) -> Array:
    """(n,) mm, component of printed vectors (n, 2) around the tube."""
    return np.asarray(printed @ cell.turn[1])


def _middles(cell: Cell, points: Array, curvature: float) -> Array:
    """(R,) rad, angle of every rod edge's middle."""
    middle = points[cell.edges].mean(axis=1)
    sign = np.sign(curvature)
    return np.arctan2(sign * middle[:, 1], sign * middle[:, 2])


def _turned(vectors: Array, angle: Array) -> Array:
    """Vectors (R, 3) turned outwards by angles (R,) about the axis."""
    cos, sin = np.cos(angle), np.sin(angle)
    y, z = vectors[:, 1], vectors[:, 2]
    return np.column_stack([vectors[:, 0], y * cos + z * sin, z * cos - y * sin])
