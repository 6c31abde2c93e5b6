"""Simple shapes of a sheet: flat, cap, arc, saddle, bent; guesses from which Newton's method starts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np

from fem.elements.space import Space
from fem.elements.tabulation import Floats

# takes printed points (n, 2) to (n, 6, 2): points in the plane and derivatives 1, 2, 11, 22, 12
Plane = Callable[[Floats], Floats]

# sin(r)/r as a power series in r^2, and its first two derivatives by r^2: exact to rounding up to r = 3
_SINC = np.array([(-1.0) ** n / factorial(2 * n + 1) for n in range(16)])
SERIES = np.stack(
    [np.r_[np.polynomial.polynomial.polyder(_SINC, order), np.zeros(order)] for order in range(3)], axis=1
)


@dataclass(frozen=True)
class SimpleShape:
    """A guess.

    Attributes
    ----------
    name : `flat`; `cap` (a sphere whose rays keep their lengths); `arc`, curved one way; `saddle` and `bent`, curved
        the other way as well, to the opposite and to the same side: parts of a torus, whose meridians keep theirs.
    curvature : per mm of the contracted sheet; positive lifts the edges towards +z.
    angle : radians, the direction in which it curves.
    across : per mm, the curvature in the direction across.
    """

    name: str
    curvature: float = 0.0
    angle: float = 0.0
    across: float = 0.0

    def positions(self, space: Space, centre: Floats, stretch: float) -> Floats:
        """(N, 3) on a sheet whose lengths are `stretch` times the printed ones, `centre` (2,) at the origin."""
        return self.over(space, similar(centre, stretch))

    def over(self, space: Space, plane: Plane) -> Floats:
        """(N, 3) on a sheet that was first moved within its plane."""
        cos, sin = np.cos(self.angle), np.sin(self.angle)
        turn = np.array([[cos, sin], [-sin, cos]])
        bend = self._cap if self.name == "cap" else self._torus

        def jets(points: Floats) -> Floats:
            inner = plane(points) @ turn.T
            out = _chain(inner) @ bend(inner[:, 0])
            out[..., :2] = out[..., :2] @ turn
            return out

        return space.interpolate(jets)

    def _torus(self, p: Floats) -> Floats:
        """(n, 6, 3) of points (n, 2): place and derivatives."""
        k, m = self.curvature, self.across
        u, v = p.T
        cu, su, cv, sv = np.cos(k * u), np.sin(k * u), np.cos(m * v), np.sin(m * v)
        along, across, lift = su / k if k else u, sv / m if m else v, _rise(m, v)
        inward = 1.0 - k * lift  # the meridian turns about an axis at the height 1/k
        rows = [
            (inward * along, across, _rise(k, u) + lift * cu),
            (inward * cu, 0.0, inward * su),
            (-k * sv * along, cv, sv * cu),
            (-k * inward * su, 0.0, k * inward * cu),
            (-k * m * cv * along, -m * sv, m * cv * cu),
            (-k * sv * cu, 0.0, -k * sv * su),
        ]
        return _filled(rows, len(p))

    def _cap(self, p: Floats) -> Floats:
        """(n, 6, 3) of points (n, 2): place and derivatives."""
        k, (u, v) = self.curvature, p.T
        square = u * u + v * v
        ray, slope, bend = np.polynomial.polynomial.polyval(k * k * square, SERIES) * (k * k) ** np.arange(3)[:, None]
        first, third = 2.0 * slope, 4.0 * bend
        rows = [
            (ray * u, ray * v, _rise(k, np.sqrt(square))),
            (ray + first * u * u, first * u * v, k * ray * u),
            (first * u * v, ray + first * v * v, k * ray * v),
            ((3.0 * first + third * u * u) * u, (first + third * u * u) * v, k * (ray + first * u * u)),
            ((first + third * v * v) * u, (3.0 * first + third * v * v) * v, k * (ray + first * v * v)),
            ((first + third * u * u) * v, (first + third * v * v) * u, k * first * u * v),
        ]
        return _filled(rows, len(p))


def similar(centre: Floats, stretch: float) -> Plane:
    """The printed plane, scaled, `centre` at the origin."""
    slopes = np.zeros((6, 2))
    slopes[1:3] = stretch * np.eye(2)

    def plane(points: Floats) -> Floats:
        out = np.tile(slopes, (len(points), 1, 1))
        out[:, 0] = stretch * (points - centre)
        return out

    return plane


def _chain(inner: Floats) -> Floats:
    """(n, 6, 6) from derivatives by inner coordinates to those by the coordinates that these (n, 6, 2) depend on."""
    out = np.zeros((len(inner), 6, 6))
    out[:, 0, 0] = 1.0
    out[:, 1:, 1:3] = inner[:, 1:]
    one, two = inner[:, 1], inner[:, 2]
    for row, (a, b) in enumerate(((one, one), (two, two), (one, two)), start=3):
        out[:, row, 3:5] = a * b
        out[:, row, 5] = a[:, 0] * b[:, 1] + a[:, 1] * b[:, 0]
    return out


def _filled(rows: Sequence[Sequence[Floats | float]], count: int) -> Floats:
    """(n, 6, 3) from its entries, (n,) or the same for all."""
    out = np.empty((count, 6, 3))
    for row, entries in enumerate(rows):
        for column, entry in enumerate(entries):
            out[:, row, column] = entry
    return out


def _rise(k: float, s: Floats) -> Floats:
    """(1 - cos(k s))/k."""
    return 2.0 / k * np.sin(0.5 * k * s) ** 2 if k else np.zeros_like(s)
