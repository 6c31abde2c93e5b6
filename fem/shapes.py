"""Simple shapes of a sheet: flat, cap, arc, saddle, bent; guesses from which Newton's method starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.space import Space
from fem.tabulation import Floats

STEP = 1e-3  # of the sheet's size, for derivatives by differences: a guess needs no better ones

CROSS = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
SQUARE = np.array([*CROSS, [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0], [0.0, 0.0]])

# takes printed points (n, 2) to points in the plane (n, 2) with derivatives (n, 2, 2) and (n, 2, 3): 11, 22, 12
Plane = Callable[[Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True)
class Shape:
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
        step = STEP * float(np.ptp(space.mesh.p, axis=1).max())

        def position(points: Floats) -> Floats:
            return self._place(plane(points)[0])

        def gradient(points: Floats) -> Floats:
            p, first, _ = plane(points)
            return np.einsum("nca,nai->nci", self._gradient(p, step), first)

        def hessian(points: Floats) -> Floats:
            p, first, second = plane(points)
            bend = self._hessian(p, step)[..., [[0, 2], [2, 1]]]
            curved = np.einsum("ncab,nai,nbj->ncij", bend, first, first)
            return curved[..., [0, 1, 0], [0, 1, 1]] + np.einsum("nca,nak->nck", self._gradient(p, step), second)

        return space.interpolate(position, gradient, hessian)

    def _place(self, p: Floats) -> Floats:
        """(n, 3) of points of the plane (n, 2)."""
        k, m = self.curvature, self.across
        cos, sin = np.cos(self.angle), np.sin(self.angle)
        u, v = cos * p[:, 0] + sin * p[:, 1], cos * p[:, 1] - sin * p[:, 0]
        if self.name == "cap":
            r = np.hypot(u, v)
            return np.column_stack([_sine(k, r)[:, None] * p, _rise(k, r)])
        lift = _rise(m, v)  # of the meridian, which turns about an axis at the height 1/k
        along, across = (1.0 - k * lift) * _sine(k, u) * u, _sine(m, v) * v
        return np.column_stack(
            [cos * along - sin * across, sin * along + cos * across, _rise(k, u) + lift * np.cos(k * u)]
        )

    def _gradient(self, p: Floats, step: float) -> Floats:
        """(n, 3, 2) by central differences."""
        right, left, up, down = self._around(p, step * CROSS)
        return np.stack([right - left, up - down], axis=2) / (2.0 * step)

    def _hessian(self, p: Floats, step: float) -> Floats:
        """(n, 3, 3) by central differences."""
        right, left, up, down, *corners, middle = self._around(p, step * SQUARE)
        mixed = 0.25 * (corners[0] - corners[1] - corners[2] + corners[3])
        return np.stack([right + left - 2.0 * middle, up + down - 2.0 * middle, mixed], axis=2) / step**2

    def _around(self, p: Floats, moves: Floats) -> Floats:
        """(k, n, 3) of points moved by each of (k, 2): all at once, as a guess has few points."""
        return self._place((p + moves[:, None]).reshape(-1, 2)).reshape(len(moves), -1, 3)


def similar(centre: Floats, stretch: float) -> Plane:
    """The printed plane, scaled, `centre` at the origin."""

    def plane(points: Floats) -> tuple[Floats, Floats, Floats]:
        count = len(points)
        return (
            stretch * (points - centre),
            np.broadcast_to(stretch * np.eye(2), (count, 2, 2)),
            np.zeros((count, 2, 3)),
        )

    return plane


def _sine(k: float, s: Floats) -> Floats:
    """sin(k s)/(k s)."""
    return np.sinc(k * s / np.pi)


def _rise(k: float, s: Floats) -> Floats:
    """(1 - cos(k s))/k."""
    return 0.5 * k * s**2 * np.sinc(0.5 * k * s / np.pi) ** 2
