"""Places beside a point of a smooth surface."""

from __future__ import annotations

import numpy as np

from asterism.previewing.smooth_surface import smooth_surface
from fem.argyris import Argyris
from tests.fem.hexagons import hexagon


def test_shifts_of_the_print_are_followed_to_second_order() -> None:
    """Exactly, on a surface that is quadratic in the print."""
    space = Argyris(hexagon(1))
    a, b, c = 4e-3, -2e-3, 3e-3

    def bowl(points: np.ndarray) -> np.ndarray:
        (x, y), out = points.T, np.zeros((len(points), 6, 3))
        out[:, 0] = np.column_stack([x, y, 0.5 * a * x**2 + 0.5 * b * y**2 + c * x * y])
        out[:, 1, 0] = out[:, 2, 1] = 1.0
        out[:, 1, 2], out[:, 2, 2] = a * x + c * y, b * y + c * x
        out[:, 3, 2], out[:, 4, 2], out[:, 5, 2] = a, b, c
        return out

    random = np.random.default_rng(2)
    points, shift = random.uniform(-40.0, 40.0, (2, 9, 2))
    surface = smooth_surface(space.locate(points), space.interpolate(bowl))
    np.testing.assert_allclose(surface.places + surface.moved(shift), bowl(points + shift)[:, 0], atol=1e-8)
