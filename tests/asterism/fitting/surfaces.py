"""Triangulated surfaces for tests, and some that are no disk."""

from __future__ import annotations

from functools import partial

import numpy as np
import trimesh

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.disk import height_mesh
from benchmarks.fit_targets import cap_mesh, rectangle_mesh

spherical_cap = partial(cap_mesh, rings=22)


def cylinder_part(radius: float, turn_rad: float, depth: float) -> tuple[Floats, Ints]:
    """A part of a cylinder about the y axis."""
    plane, triangles = rectangle_mesh(radius * turn_rad, depth, 33, 25)
    angle = plane[:, 0] / radius
    return np.column_stack([radius * np.sin(angle), plane[:, 1], radius * np.cos(angle)]), triangles


Mesh = tuple[Floats, Ints]


def sphere() -> Mesh:
    ball = trimesh.creation.icosphere(2, 50.0)
    return np.asarray(ball.vertices), np.asarray(ball.faces)


def plate_with_hole(count: int) -> Mesh:
    plane, triangles = rectangle_mesh(100.0, 60.0, 31, 19)
    middles = plane[triangles].mean(axis=1)
    keep = np.ones(len(triangles), dtype=bool)
    for number in range(count):
        keep &= np.linalg.norm(middles - [30.0 * (number - 0.5 * (count - 1)), 0.0], axis=1) > 9.0
    return np.column_stack([plane, np.zeros(len(plane))]), triangles[keep]


def moebius_strip(count: int = 60) -> Mesh:
    angle = np.arange(count) * 2.0 * np.pi / count
    rows = []
    for across in (-8.0, 8.0):
        radius = 40.0 + across * np.cos(0.5 * angle)
        rows.append(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), across * np.sin(0.5 * angle)]))
    # after one turn the two sides of the strip have changed places
    a, b = np.arange(count), np.arange(count) + count
    c, d = np.append(a[1:], count), np.append(b[1:], 0)
    return np.concatenate(rows), np.concatenate([np.column_stack([a, c, b]), np.column_stack([c, d, b])])


def open_torus() -> Mesh:
    ring = trimesh.creation.torus(40.0, 15.0, major_sections=24, minor_sections=16)
    return np.asarray(ring.vertices), np.asarray(ring.faces)[1:]


def fin() -> Mesh:
    vertices, triangles = rectangle_mesh(60.0, 60.0, 7, 7)
    flat = np.column_stack([vertices, np.zeros(len(vertices))])
    a, b = triangles[20][:2]
    return np.concatenate([flat, [[0.0, 0.0, 30.0]]]), np.concatenate([triangles, [[a, b, len(flat)]]])


def bow_tie() -> Mesh:
    corners = [[0.0, 0, 0], [-40, -30, 0], [-40, 30, 0], [40, -30, 0], [40, 30, 0]]
    return np.array(corners), np.array([[0, 2, 1], [0, 3, 4]])


def strip(places: Floats) -> Mesh:
    """A mesh of quadrilaterals cut in two, from places (m, n, 3)."""
    number = np.arange(places[..., 0].size).reshape(places.shape[:2])
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    return places.reshape(-1, 3), np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def crossing_sheet() -> Mesh:
    # a strip that runs in a loop and passes through itself
    turn = np.linspace(-1.9, 1.9, 61)
    line = np.column_stack([40.0 * np.sin(2.0 * turn), 40.0 * turn**2])
    return strip(np.array([[[x, y, z] for y in np.linspace(-20.0, 20.0, 9)] for x, z in line]))


def dome(width: float = 80.0, rise: float = 10.0, points: int = 41) -> Mesh:
    x = np.linspace(-0.5 * width, 0.5 * width, points)
    return height_mesh(rise * (1.0 - (2.0 * x[None] / width) ** 2) * (1.0 - (2.0 * x[:, None] / width) ** 2), x, x)
