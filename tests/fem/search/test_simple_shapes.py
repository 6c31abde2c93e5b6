"""Simple shapes: derivatives agree with positions, and arcs and caps lie on cylinder and sphere."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.simple_shapes import SimpleShape, similar

SHAPES = [
    SimpleShape("flat"),
    SimpleShape("cap", -0.9),
    SimpleShape("arc", 1.1, 0.4),
    SimpleShape("saddle", 0.8, -0.7, -0.5),
    SimpleShape("bent", -1.2, 2.0, -0.4),
]
POINTS = np.random.default_rng(0).uniform(-1.2, 1.2, (40, 2))
STEP = 1e-4


class Points:
    """Replaces a space, and returns the jets at its points."""

    def __init__(self, points: Floats) -> None:
        self._points = points

    def interpolate(self, jets) -> Floats:  # type: ignore[no-untyped-def]
        return np.asarray(jets(self._points))


def moved(points: Floats) -> Floats:
    """(n, 6, 2) a plane that is stretched, rotated, sheared and nonlinearly deformed within itself."""
    x, y = points.T
    zero, one = np.zeros_like(x), np.ones_like(x)
    return np.array(
        [
            [0.8 * x + 0.1 * y + 0.05 * x * y, 0.9 * y - 0.2 * x + 0.1 * x**2],
            [0.8 + 0.05 * y, -0.2 + 0.2 * x],
            [0.1 + 0.05 * x, 0.9 * one],
            [zero, 0.2 * one],
            [zero, zero],
            [0.05 * one, zero],
        ]
    ).transpose(2, 0, 1)


def places(shape: SimpleShape, points: Floats) -> Floats:
    """(n, 3) of points (n, 2)."""
    return shape.over(Points(points), moved)[:, 0]  # type: ignore[arg-type]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
def test_derivatives(shape: SimpleShape) -> None:
    jets = shape.over(Points(POINTS), moved)  # type: ignore[arg-type]
    one, two = STEP * np.eye(2)
    middle = places(shape, POINTS)
    first = [(places(shape, POINTS + d) - places(shape, POINTS - d)) / (2.0 * STEP) for d in (one, two)]
    second = [(places(shape, POINTS + d) + places(shape, POINTS - d) - 2.0 * middle) / STEP**2 for d in (one, two)]
    corners = [places(shape, POINTS + s * one + t * two) * s * t for s in (-1, 1) for t in (-1, 1)]
    second.append(np.sum(corners, axis=0) / (4.0 * STEP**2))
    assert np.abs(jets[:, 1:3] - np.stack(first, axis=1)).max() < 1e-7
    assert np.abs(jets[:, 3:] - np.stack(second, axis=1)).max() < 1e-6


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name)
def test_curvatures_in_the_middle(shape: SimpleShape) -> None:
    """At the centre the sheet keeps its lengths and has both curvatures; positive ones lift the edges."""
    at = shape.over(Points(np.zeros((1, 2))), similar(np.zeros(2), 1.0))[0]  # type: ignore[arg-type]
    cos, sin = np.cos(shape.angle), np.sin(shape.angle)
    across = shape.curvature if shape.name == "cap" else shape.across
    along, side = np.array([cos, sin]), np.array([-sin, cos])
    bend = shape.curvature * np.outer(along, along) + across * np.outer(side, side)
    assert np.allclose(at[0], 0.0)
    assert np.allclose(at[1:3], np.eye(3)[:2], atol=1e-12)
    assert np.allclose(at[3:, 2], [bend[0, 0], bend[1, 1], bend[0, 1]], atol=1e-12)


def test_an_arc_lies_on_its_cylinder_and_a_cap_on_its_sphere() -> None:
    flat = similar(np.zeros(2), 1.0)
    arc, cap = (SimpleShape(name, 0.7).over(Points(POINTS), flat)[:, 0] for name in ("arc", "cap"))  # type: ignore[arg-type]
    assert np.allclose(np.hypot(arc[:, 0], arc[:, 2] - 1 / 0.7), 1 / 0.7)
    assert np.allclose(np.linalg.norm(cap - [0.0, 0.0, 1 / 0.7], axis=1), 1 / 0.7)
