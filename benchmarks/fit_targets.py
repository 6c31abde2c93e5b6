"""Target surfaces of 100 to 150 mm for `python -m benchmarks.fit`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import Delaunay

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.target import TargetSurface

RINGS = 24  # of triangles, of a round target


def round_mesh(rings: int = RINGS) -> tuple[Floats, Ints]:
    """(V, 2) points of the unit disk in rings, and triangles."""
    points = [np.zeros((1, 2))]
    for ring in range(1, rings + 1):
        angle = np.arange(6 * ring) * (2.0 * np.pi / (6 * ring))
        points.append(ring / rings * np.column_stack([np.cos(angle), np.sin(angle)]))
    plane = np.concatenate(points)
    return plane, Delaunay(plane).simplices.astype(np.int64)


def rectangle_mesh(width: float, depth: float, columns: int = 50, rows: int = 40) -> tuple[Floats, Ints]:
    """(V, 2) points of a rectangle around the origin, and triangles."""
    x, y = np.linspace(-0.5, 0.5, columns) * width, np.linspace(-0.5, 0.5, rows) * depth
    plane = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return plane, Delaunay(plane).simplices.astype(np.int64)


def cap(half_angle_deg: float, name: str) -> TargetSurface:
    """A cap of a sphere, 100 mm wide."""
    plane, triangles = round_mesh()
    half = np.deg2rad(half_angle_deg)
    radius = 50.0 / np.sin(half)
    angle, around = half * np.linalg.norm(plane, axis=1), np.arctan2(plane[:, 1], plane[:, 0])
    places = [np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)]
    return TargetSurface.of_triangles(radius * np.column_stack(places), triangles, name)


def graph(height: Callable[[Floats, Floats], Floats], width: float, depth: float, name: str) -> TargetSurface:
    """Heights over an ellipse with these diameters."""
    plane, triangles = round_mesh()
    x, y = 0.5 * width * plane[:, 0], 0.5 * depth * plane[:, 1]
    return TargetSurface.of_triangles(np.column_stack([x, y, height(x, y)]), triangles, name)


def ellipsoid(scale: float, name: str) -> TargetSurface:
    """A shallow dome over an ellipse, 124 by 84 mm at a scale of 1."""

    def height(x: Floats, y: Floats) -> Floats:
        return scale * 26.0 * np.sqrt(1.0 - (x / (76.0 * scale)) ** 2 - (y / (52.0 * scale)) ** 2)

    return graph(height, 124.0 * scale, 84.0 * scale, name)


def barrel() -> TargetSurface:
    """A part of a cylinder of radius 55 mm, 110 degrees around."""
    plane, triangles = rectangle_mesh(np.deg2rad(110.0), 76.0)
    angle = plane[:, 0]
    places = np.column_stack([55.0 * np.sin(angle), plane[:, 1], 55.0 * np.cos(angle)])
    return TargetSurface.of_triangles(places, triangles, "barrel")


def torus_part() -> TargetSurface:
    """The upper part of a torus: Gauss curvature of both signs."""
    plane, triangles = rectangle_mesh(1.05, 1.7)
    around, across = plane.T
    radius = 100.0 + 35.0 * np.sin(across)
    places = np.column_stack([radius * np.sin(around), radius * np.cos(around), 35.0 * np.cos(across)])
    return TargetSurface.of_triangles(places, triangles, "torus part")


def three_legged_shell() -> TargetSurface:
    """A vault on three legs: the border rises between them."""
    plane, triangles = round_mesh()
    radius, around = np.linalg.norm(plane, axis=1), np.arctan2(plane[:, 1], plane[:, 0])
    reach = 52.0 * (1.0 + 0.12 * np.cos(3.0 * around)) * radius
    x, y = reach * np.cos(around), reach * np.sin(around)
    heights = 20.0 - 0.0075 * reach**2 - 3.0 * radius**3 * np.cos(3.0 * around)
    return TargetSurface.of_triangles(np.column_stack([x, y, heights]), triangles, "three-legged shell")


def _bump(x: Floats, y: Floats, at: tuple[float, float], width: float) -> Floats:
    return np.asarray(np.exp(-((x - at[0]) ** 2 + (y - at[1]) ** 2) / width**2))


def face_mask() -> TargetSurface:
    """An oval mask, 112 by 150 mm, with nose, brows, cheeks and chin; its rim bends back."""
    plane, triangles = round_mesh(36)
    x, y = 56.0 * plane[:, 0], 75.0 * plane[:, 1]
    inside = 1.0 - 0.92 * (plane**2).sum(axis=1)
    heights = 44.0 * np.sqrt(inside) + 11.0 * _bump(x, y / 2.2, (0.0, 1.0), 11.0)
    heights += 4.0 * _bump(x, y, (0.0, -46.0), 16.0) + 3.0 * _bump(x, y, (-27.0, -8.0), 16.0)
    heights += 3.0 * _bump(x, y, (27.0, -8.0), 16.0) - 4.0 * _bump(x, y, (-20.0, 20.0), 12.0)
    heights -= 4.0 * _bump(x, y, (20.0, 20.0), 12.0)
    return TargetSurface.of_triangles(np.column_stack([x, y, heights]), triangles, "face mask")


# name: target, and number of needles (None: chosen by the fit)
TARGETS: dict[str, tuple[Callable[[], TargetSurface], int | None]] = {
    "cap 35 deg": (lambda: cap(35.0, "cap 35 deg"), None),
    "cap 45 deg": (lambda: cap(45.0, "cap 45 deg"), None),
    "cap 50 deg": (lambda: cap(50.0, "cap 50 deg"), None),
    "cap 60 deg": (lambda: cap(60.0, "cap 60 deg"), None),
    "cap 35 deg, free": (lambda: cap(35.0, "cap 35 deg, free"), 0),
    "ellipsoid dome": (lambda: ellipsoid(1.0, "ellipsoid dome"), None),
    "hypar": (lambda: TargetSurface.of_formula("11*x*y/41.7**2", 83.4, name="hypar"), None),
    "saddle": (lambda: graph(lambda x, y: 10.0 * (x**2 - y**2) / 50.0**2, 100, 100, "saddle"), None),
    "monkey saddle": (
        lambda: graph(lambda x, y: 9.0 * (x**3 - 3.0 * x * y**2) / 50.0**3, 100, 100, "monkey saddle"),
        None,
    ),
    "barrel": (barrel, None),
    "two bumps": (
        lambda: graph(
            lambda x, y: 11.0 * _bump(x, y, (-18.0, 0.0), 22.0) + 7.0 * _bump(x, y, (22.0, 6.0), 20.0),
            104,
            104,
            "two bumps",
        ),
        None,
    ),
    "three-legged shell": (three_legged_shell, None),
    "torus part": (torus_part, None),
    "hemisphere": (lambda: cap(85.0, "hemisphere"), None),
    "face mask": (face_mask, None),
}
