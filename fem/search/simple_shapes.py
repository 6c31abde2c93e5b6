"""Simple shapes of a sheet, from which Newton's method starts: flat, cap, arc, saddle, bent.

A cap is part of a sphere with `r = sin(k rho)/k` and height `(1 - cos(k rho))/k` at the distance rho from the centre.
All other shapes are parts of a torus: arcs of curvature k along u, bent with the curvature m along v.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np

from equilibrium.arrays import Floats
from fem.elements.space import Space

# takes printed points (n, 2) to (n, 6, 2): points in the plane and derivatives 1, 2, 11, 22, 12
Plane = Callable[[Floats], Floats]

# sin(r)/r as a power series in r^2, and its first two derivatives by r^2: exact to rounding up to r = 3
_SINC = np.array([(-1.0) ** n / factorial(2 * n + 1) for n in range(16)])
SERIES = np.stack(
    [np.r_[np.polynomial.polynomial.polyder(_SINC, order), np.zeros(order)] for order in range(3)], axis=1
)


@dataclass(frozen=True)
class SimpleShape:
    """A simple shape.

    Attributes
    ----------
    name : `flat`; `cap`, a sphere on which radial lengths are kept; `arc`, a cylinder; `saddle` and `bent`, parts of a
        torus with principal curvatures of opposite or equal signs, on which the lengths of meridians are kept.
    curvature : per mm of the contracted sheet; positive lifts the edges towards +z.
    angle : rad, direction of this curvature.
    across : per mm, curvature in the perpendicular direction.

    Examples
    --------
    An arc of curvature 0.1/mm on a square of 2 mm: its edges are `10 (1 - cos 0.1)` mm above the centre line.

    >>> from skfem import MeshTri
    >>> from fem.elements.lifted import Lifted
    >>> space = Lifted(MeshTri().scaled(2.0), degree=2)
    >>> x = SimpleShape("arc", 0.1).positions(space, np.array([1.0, 1.0]), stretch=1.0)
    >>> round(float(np.ptp(x[:, 2])), 4), round(float(10 * (1 - np.cos(0.1))), 4)
    (0.05, 0.05)
    """

    name: str
    curvature: float = 0.0
    angle: float = 0.0
    across: float = 0.0

    def positions(self, space: Space, centre: Floats, stretch: float) -> Floats:
        """(N, 3) mm, the shape of a sheet scaled by `stretch`, with the printed point `centre` (2,) at the origin."""
        return self.over(space, similar(centre, stretch))

    def over(self, space: Space, plane: Plane) -> Floats:
        """(N, 3) mm, the shape of a sheet that `plane` has deformed within its plane."""
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
        """(n, 6, 3) position and derivatives at points (n, 2) of the plane."""
        k, m = self.curvature, self.across
        u, v = p.T
        cu, su, cv, sv = np.cos(k * u), np.sin(k * u), np.cos(m * v), np.sin(m * v)
        along, across, lift = su / k if k else u, sv / m if m else v, _rise(m, v)
        inward = 1.0 - k * lift  # meridians rotate about an axis at the height 1/k
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
        """(n, 6, 3) position and derivatives at points (n, 2) of the plane."""
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
    """The printed plane, scaled by `stretch`, with `centre` (2,) mm at the origin."""
    slopes = np.zeros((6, 2))
    slopes[1:3] = stretch * np.eye(2)

    def plane(points: Floats) -> Floats:
        out = np.tile(slopes, (len(points), 1, 1))
        out[:, 0] = stretch * (points - centre)
        return out

    return plane


def _chain(inner: Floats) -> Floats:
    """(n, 6, 6) chain rule: from derivatives by inner coordinates to those by printed coordinates.

    `inner` (n, 6, 2) are the inner coordinates and their derivatives 1, 2, 11, 22, 12.
    """
    out = np.zeros((len(inner), 6, 6))
    out[:, 0, 0] = 1.0
    out[:, 1:, 1:3] = inner[:, 1:]
    d1, d2 = inner[:, 1], inner[:, 2]
    for row, (a, b) in enumerate(((d1, d1), (d2, d2), (d1, d2)), start=3):
        out[:, row, 3:5] = a * b
        out[:, row, 5] = a[:, 0] * b[:, 1] + a[:, 1] * b[:, 0]
    return out


def _filled(rows: Sequence[Sequence[Floats | float]], count: int) -> Floats:
    """(n, 6, 3) array from rows of entries, each (n,) or a number."""
    out = np.empty((count, 6, 3))
    for row, entries in enumerate(rows):
        for column, entry in enumerate(entries):
            out[:, row, column] = entry
    return out


def _rise(k: float, s: Floats) -> Floats:
    """`(1 - cos(k s))/k`, also for k = 0."""
    return 2.0 / k * np.sin(0.5 * k * s) ** 2 if k else np.zeros_like(s)
