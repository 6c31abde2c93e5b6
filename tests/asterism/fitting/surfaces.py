"""Triangulated surfaces for tests."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay

from equilibrium.arrays import Floats, Ints


def round_mesh(rings: int) -> tuple[Floats, Ints]:
    """(V, 2) points of the unit disk in rings, and triangles."""
    points = [np.zeros((1, 2))]
    for ring in range(1, rings + 1):
        angle = np.arange(6 * ring) * (2.0 * np.pi / (6 * ring))
        points.append(ring / rings * np.column_stack([np.cos(angle), np.sin(angle)]))
    plane = np.concatenate(points)
    return plane, Delaunay(plane).simplices.astype(np.int64)


def spherical_cap(half_angle_deg: float, size_mm: float = 100.0, rings: int = 22) -> tuple[Floats, Ints]:
    """A cap of a sphere that is `size_mm` wide."""
    plane, triangles = round_mesh(rings)
    half = np.deg2rad(half_angle_deg)
    radius = 0.5 * size_mm / np.sin(min(half, 0.5 * np.pi))
    angle, around = half * np.linalg.norm(plane, axis=1), np.arctan2(plane[:, 1], plane[:, 0])
    heights = radius * np.cos(angle)
    return radius * np.column_stack(
        [np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), heights / radius]
    ), triangles


def rectangle_mesh(width: float, depth: float, columns: int, rows: int) -> tuple[Floats, Ints]:
    """(V, 2) points of a rectangle around the origin, and triangles."""
    x, y = np.linspace(-0.5, 0.5, columns) * width, np.linspace(-0.5, 0.5, rows) * depth
    plane = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return plane, Delaunay(plane).simplices.astype(np.int64)


def cylinder_part(radius: float, turn_rad: float, depth: float) -> tuple[Floats, Ints]:
    """A part of a cylinder about the y axis."""
    plane, triangles = rectangle_mesh(radius * turn_rad, depth, 33, 25)
    angle = plane[:, 0] / radius
    return np.column_stack([radius * np.sin(angle), plane[:, 1], radius * np.cos(angle)]), triangles
