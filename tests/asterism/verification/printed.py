"""Sheets of a design, put into space by a formula."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from asterism import Design, Shape
from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout


def design(**sections: Any) -> Design:
    """Seven equal stars, or what else is asked for."""
    return Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}} | sections)


def shape(of: Design, place: Callable[[Floats], Floats], edge_mm: float = 2.0) -> Shape:
    """The mesh of a design with its printed points (n, 2) where `place` takes them, (n, 3)."""
    plan = layout(of)
    mesh = mesh_layout(plan, edge_mm)
    star = np.full(len(mesh.points), -1)
    star[mesh.star_vertices] = np.arange(len(plan.centres))
    return Shape(mesh.points, place(mesh.points), mesh.triangles, star, mesh.rods, mesh.star_vertices)


def rolled(radius: float, axis_deg: float = 0.0) -> Callable[[Floats], Floats]:
    """A tube about an axis in print, the plastic outside."""
    a = np.radians(axis_deg)
    turn = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])

    def place(points: Floats) -> Floats:
        along, across = turn @ points.T
        x, y = turn.T @ [along, radius * np.sin(across / radius)]
        return np.column_stack([x, y, radius * np.cos(across / radius)])

    return place


def lumpy(points: Floats) -> Floats:
    """Without any symmetry."""
    x, y = points.T / 20.0
    return np.column_stack([points + 0.3 * np.column_stack([y**2, x * y]), 4 * x**2 + 2 * x * y + y**3 + 3 * y])
