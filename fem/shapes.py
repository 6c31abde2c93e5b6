"""Simple shapes of a sheet: flat, cap, saddle, arc; guesses from which Newton's method starts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.space import Space
from fem.tabulation import Floats

STEP = 1e-3  # of the sheet's size, for derivatives by differences: a guess needs no better ones


@dataclass(frozen=True)
class Shape:
    """A guess.

    Attributes
    ----------
    name : `flat`, `cap`, `saddle` or `arc`.
    curvature : per mm of the contracted sheet; positive lifts the edges towards +z.
    angle : radians, the direction in which an arc curves, or a saddle upwards.
    """

    name: str
    curvature: float = 0.0
    angle: float = 0.0

    def positions(self, space: Space, centre: Floats, stretch: float) -> Floats:
        """(N, 3) on a sheet whose lengths are `stretch` times the printed ones, `centre` (2,) at the origin."""
        size = float(np.ptp(space.mesh.p, axis=1).max())

        def place(points: Floats) -> Floats:
            return self._place(stretch * (points - centre))

        return space.interpolate(place, *_derivatives(place, STEP * size))

    def _place(self, p: Floats) -> Floats:
        """(n, 3) of contracted points (n, 2)."""
        k = self.curvature
        u = p @ np.array([np.cos(self.angle), np.sin(self.angle)])
        v = p @ np.array([-np.sin(self.angle), np.cos(self.angle)])
        if self.name == "arc":  # sinc keeps these smooth for any curvature
            flat, height = np.sinc(k * u / np.pi) * u, 0.5 * k * u**2 * np.sinc(0.5 * k * u / np.pi) ** 2
            along = np.stack([np.cos(self.angle) * flat, np.sin(self.angle) * flat], axis=1)
            across = np.stack([-np.sin(self.angle) * v, np.cos(self.angle) * v], axis=1)
            return np.column_stack([along + across, height])
        if self.name == "cap":  # a sphere, its rays as long as they were
            r = np.hypot(u, v)
            return np.column_stack(
                [np.sinc(k * r / np.pi)[:, None] * p, 0.5 * k * r**2 * np.sinc(0.5 * k * r / np.pi) ** 2]
            )
        return np.column_stack([p, 0.5 * k * (u**2 - v**2)])


def _derivatives(
    place: Callable[[Floats], Floats], step: float
) -> tuple[Callable[[Floats], Floats], Callable[[Floats], Floats]]:
    """Gradient and Hessian by central differences."""
    one, two = step * np.eye(2)

    def gradient(p: Floats) -> Floats:
        return np.stack([place(p + d) - place(p - d) for d in (one, two)], axis=2) / (2.0 * step)

    def hessian(p: Floats) -> Floats:
        middle = 2.0 * place(p)
        straight = [place(p + d) + place(p - d) - middle for d in (one, two)]
        mixed = place(p + one + two) + place(p - one - two) - place(p + one - two) - place(p - one + two)
        return np.stack([*straight, 0.25 * mixed], axis=2) / step**2

    return gradient, hessian
