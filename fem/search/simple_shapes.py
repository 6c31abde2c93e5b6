"""Simple shapes of a sheet, from which Newton's method starts: flat, cap, arc, saddle, bent.

A cap is part of a sphere with `r = sin(k rho)/k` and height `(1 - cos(k rho))/k` at the distance rho from the centre.
All other shapes are parts of a torus: arcs of curvature k along u, bent with the curvature m along v.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import factorial

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.compiled import formula, loop
from asterism.fem.elements.argyris import Argyris

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

    An arc of curvature 0.1/mm on a square of 2 mm: its edges are `10 (1 - cos 0.1)` mm above the centre line.

    >>> from skfem import MeshTri
    >>> space = Argyris(MeshTri().scaled(2.0))
    >>> x = SimpleShape("arc", 0.1).positions(space, np.array([1.0, 1.0]), stretch=1.0)
    >>> round(float(x[space.vertex_dofs[:, 0], 2].max()), 4), round(float(10 * (1 - np.cos(0.1))), 4)
    (0.05, 0.05)
    """

    # `flat`; `cap`, a sphere on which radial lengths are kept; `arc`, a cylinder; `saddle` and `bent`, parts of a torus
    # with principal curvatures of opposite or equal signs, on which the lengths of meridians are kept.
    name: str
    curvature: float = 0.0  # per mm of the contracted sheet; positive lifts the edges towards +z
    angle: float = 0.0  # rad, direction of this curvature
    across: float = 0.0  # per mm, curvature in the perpendicular direction

    def positions(self, space: Argyris, centre: Floats, stretch: float) -> Floats:
        """(N, 3) mm, the shape of a sheet scaled by `stretch`, with the printed point `centre` (2,) at the origin."""
        return self.over(space, similar(centre, stretch))

    def over(self, space: Argyris, plane: Plane) -> Floats:
        """(N, 3) mm, the shape of a sheet that `plane` has deformed within its plane."""
        along = np.cos(self.angle), np.sin(self.angle)

        def jets(points: Floats) -> Floats:
            out = np.empty((len(points), 6, 3))
            _bend(plane(points), self.name == "cap", self.curvature, self.across, *along, SERIES, out)
            return out

        return space.interpolate(jets)


def similar(centre: Floats, stretch: float) -> Plane:
    """The printed plane, scaled by `stretch`, with `centre` (2,) mm at the origin."""
    slopes = np.zeros((6, 2))
    slopes[1:3] = stretch * np.eye(2)

    def plane(points: Floats) -> Floats:
        out = np.tile(slopes, (len(points), 1, 1))
        out[:, 0] = stretch * (points - centre)
        return out

    return plane


@loop
def _bend(inner, is_cap, k, m, cos, sin, series, out):  # type: ignore[no-untyped-def]
    """Write position and derivatives 1, 2, 11, 22, 12 of a bent plane to out (n, 6, 3), with the chain rule.

    `inner` (n, 6, 2) are points in the plane and their derivatives by printed coordinates. The direction of the
    curvature k has the components cos and sin.
    """
    turned, bent = np.empty((6, 2)), np.empty((6, 3))
    for p in range(inner.shape[0]):
        for row in range(6):
            x, y = inner[p, row]
            turned[row, 0], turned[row, 1] = cos * x + sin * y, cos * y - sin * x
        if is_cap:
            _cap(turned[0, 0], turned[0, 1], k, series, bent)
        else:
            _torus(turned[0, 0], turned[0, 1], k, m, bent)
        for c in range(3):
            out[p, 0, c] = bent[0, c]
            for row in range(1, 6):
                out[p, row, c] = turned[row, 0] * bent[1, c] + turned[row, 1] * bent[2, c]
            for row in range(3, 6):
                a, b = (row - 2, row - 2) if row < 5 else (1, 2)
                mixed = turned[a, 0] * turned[b, 1] + turned[a, 1] * turned[b, 0]
                out[p, row, c] += turned[a, 0] * turned[b, 0] * bent[3, c]
                out[p, row, c] += turned[a, 1] * turned[b, 1] * bent[4, c] + mixed * bent[5, c]
        for row in range(6):
            x, y = out[p, row, 0], out[p, row, 1]
            out[p, row, 0], out[p, row, 1] = cos * x - sin * y, sin * x + cos * y


@formula
def _torus(u, v, k, m, bent):  # type: ignore[no-untyped-def]
    """Write position and derivatives of a torus at the point (u, v) of the plane to bent (6, 3)."""
    cu, su, cv, sv = np.cos(k * u), np.sin(k * u), np.cos(m * v), np.sin(m * v)
    along, across, lift = su / k if k != 0.0 else u, sv / m if m != 0.0 else v, _rise(m, v)
    inward = 1.0 - k * lift  # meridians rotate about an axis at the height 1/k
    bent[0, 0], bent[0, 1], bent[0, 2] = inward * along, across, _rise(k, u) + lift * cu
    bent[1, 0], bent[1, 1], bent[1, 2] = inward * cu, 0.0, inward * su
    bent[2, 0], bent[2, 1], bent[2, 2] = -k * sv * along, cv, sv * cu
    bent[3, 0], bent[3, 1], bent[3, 2] = -k * inward * su, 0.0, k * inward * cu
    bent[4, 0], bent[4, 1], bent[4, 2] = -k * m * cv * along, -m * sv, m * cv * cu
    bent[5, 0], bent[5, 1], bent[5, 2] = -k * sv * cu, 0.0, -k * sv * su


@formula
def _cap(u, v, k, series, bent):  # type: ignore[no-untyped-def]
    """Write position and derivatives of a cap at the point (u, v) of the plane to bent (6, 3)."""
    square = u * u + v * v
    ray = slope = bend = 0.0
    for power in range(series.shape[0] - 1, -1, -1):
        ray = ray * k * k * square + series[power, 0]
        slope = slope * k * k * square + series[power, 1]
        bend = bend * k * k * square + series[power, 2]
    first, third = 2.0 * k * k * slope, 4.0 * k**4 * bend
    bent[0, 0], bent[0, 1], bent[0, 2] = ray * u, ray * v, _rise(k, np.sqrt(square))
    bent[1, 0], bent[1, 1], bent[1, 2] = ray + first * u * u, first * u * v, k * ray * u
    bent[2, 0], bent[2, 1], bent[2, 2] = first * u * v, ray + first * v * v, k * ray * v
    bent[3, 0], bent[3, 1] = (3.0 * first + third * u * u) * u, (first + third * u * u) * v
    bent[4, 0], bent[4, 1] = (first + third * v * v) * u, (3.0 * first + third * v * v) * v
    bent[5, 0], bent[5, 1] = (first + third * u * u) * v, (first + third * v * v) * u
    bent[3, 2], bent[4, 2], bent[5, 2] = k * (ray + first * u * u), k * (ray + first * v * v), k * first * u * v


@formula
def _rise(k, s):  # type: ignore[no-untyped-def]
    """`(1 - cos(k s))/k`, also for k = 0."""
    return 2.0 / k * np.sin(0.5 * k * s) ** 2 if k != 0.0 else 0.0
