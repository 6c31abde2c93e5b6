"""Sheets of known geometry for the tests of shapes, exports and pictures."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import Delaunay

from asterism.equilibrium.arrays import Floats, Ints
from asterism.shape.shape import Shape
from asterism.shape.surface import cell_fields, point_fields


def grid(width: float, depth: float, edge: float) -> tuple[Floats, Ints]:
    """A rectangle about the origin, of equilateral triangles as far as its border allows."""
    rows = max(2, round(depth / (edge * np.sqrt(3) / 2)))
    columns = max(2, round(width / edge))
    points = []
    for j in range(rows + 1):
        x = np.linspace(-width / 2, width / 2, columns + 1)
        if j % 2:
            x = np.concatenate([x[:1], (x[1:] + x[:-1]) / 2, x[-1:]])
        points.append(np.column_stack([x, np.full(len(x), -depth / 2 + j * depth / rows)]))
    flat = np.concatenate(points)
    triangles = Delaunay(flat).simplices
    a, b, c = flat[triangles].transpose(1, 0, 2)
    area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    triangles = np.where((area < 0)[:, None], triangles[:, ::-1], triangles)[np.abs(area) > 1e-9]
    return flat, triangles.astype(np.int64)


def sheet(place: Callable[[Floats], Floats], width: float = 100.0, depth: float = 80.0, edge: float = 2.0) -> Shape:
    """A rectangle with a few stars, put into space by `place`: (n, 2) -> (n, 3)."""
    flat, triangles = grid(width, depth, edge)
    centres, rods, arm_star = [], [], []
    spacing = 17.3205
    for x in np.arange(-width / 2 + spacing / 2, width / 2, spacing):
        for y in np.arange(-depth / 2 + spacing / 2, depth / 2, spacing):
            for angle in np.deg2rad([-90, 30, 150]):
                along = np.linspace(0, 0.55 * spacing, 6)[:, None] * [np.cos(angle), np.sin(angle)]
                # the grid does not follow the arms: its nearest vertices do well enough here
                path = [int(((flat - [x, y] - p) ** 2).sum(axis=1).argmin()) for p in along]
                rods.append(np.array([v for i, v in enumerate(path) if i == 0 or v != path[i - 1]]))
                arm_star.append(len(centres))
            centres.append(rods[-1][0])
    star = np.full(len(flat), -1)
    star[centres] = np.arange(len(centres))
    arm = np.repeat(np.arange(len(rods)), [len(path) - 1 for path in rods])
    positions = place(flat)
    return Shape(
        printed=flat,
        positions=positions,
        triangles=triangles,
        star=star,
        rods=tuple(rods),
        star_vertices=np.array(centres),
        point_fields=point_fields(positions, triangles),
        cell_fields=cell_fields(flat, positions, triangles, 1.35),
        rod_fields={
            "arm": arm,
            "star": np.array(arm_star)[arm],
            "thickness_mm": np.full(len(arm), 0.4),
            "width_mm": np.full(len(arm), 1.2),
        },
        summary={"stars_up": len(centres), "stars_total": len(centres)},
    )


def flat(points: Floats) -> Floats:
    """The sheet as it was printed."""
    return np.column_stack([points, np.zeros(len(points))])


def dome(points: Floats, radius: float = 90.0) -> Floats:
    """Part of a sphere, by the azimuthal equidistant map."""
    r = np.linalg.norm(points, axis=1)
    outward = points / np.where(r > 0, r, 1.0)[:, None]
    return np.column_stack([outward * (radius * np.sin(r / radius))[:, None], radius * np.cos(r / radius)])


def tube(points: Floats, radius: float = 10.0) -> Floats:
    """A spiral about the x axis, the plastic outside, further than once around: its layers overlap."""
    angle = points[:, 1] / radius
    r = radius + 0.25 * angle
    return np.column_stack([points[:, 0], r * np.sin(angle), r * np.cos(angle)])


def saddle(points: Floats) -> Floats:
    """A hyperbolic paraboloid."""
    return np.column_stack([points, (points[:, 0] ** 2 - points[:, 1] ** 2) / 120])
