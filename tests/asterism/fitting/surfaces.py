"""Triangulated surfaces for tests."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from benchmarks.fit_targets import rectangle_mesh, round_mesh


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


def cylinder_part(radius: float, turn_rad: float, depth: float) -> tuple[Floats, Ints]:
    """A part of a cylinder about the y axis."""
    plane, triangles = rectangle_mesh(radius * turn_rad, depth, 33, 25)
    angle = plane[:, 0] / radius
    return np.column_stack([radius * np.sin(angle), plane[:, 1], radius * np.cos(angle)]), triangles
