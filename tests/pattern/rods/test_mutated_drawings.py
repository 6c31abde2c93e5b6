"""Mutated designs with drawn rods, holes and stars: each is laid out and meshed, or refused in one line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from benchmarks.fuzz.mutations import mutated_table

RIM = {"name": "rim", "circle_mm": {"radius": 30.0}}
EYE = {"name": "eye", "spline_mm": [[-6, 0], [0, 6], [6, 0], [0, -6]], "closed": True}
DESIGNS: list[dict[str, Any]] = [
    {
        "rods": {"draw": [RIM, EYE, {"name": "rib", "line_mm": [[-35, 1], [35, 1]]}], "thickness_mm": 0.4},
        "border": {"rods": "rim", "holes": [{"rods": "eye"}, {"circle_mm": {"centre": [0, -15], "radius": 4.0}}]},
        "pins": [{"points_mm": [[20, -5], [-20, -5]]}],
        "mesh": {"edge_mm": 5.0},
    },
    {
        "lattice": {"kind": "square", "spacing_mm": 10.0},
        "rods": {"motif": [{"line_mm": [[0, 0], [10, 0]]}, {"line_mm": [[0, 0], [0, 10]]}]},
        "border": {"rectangle_mm": [42.0, 42.0], "holes": [{"polygon_mm": [[2, 2], [8, 2], [8, 8], [2, 8]]}]},
        "mesh": {"edge_mm": 5.0},
    },
    {
        "stars": {"length_mm": 7.0, "thickness_mm": 0.4},
        "rods": {"draw": [RIM | {"circle_mm": {"radius": 40.0}}]},
        "border": {"rods": "rim", "star_margin_mm": 9.0},
        "mesh": {"edge_mm": 5.0},
    },
]
KEYS = ("radius", "closed", "line_mm", "join_mm", "curve_mm", "holes", "rods", "layer", "file")
# larger sheets and finer meshes take long, and show nothing else
MAX_VERTICES = 20_000


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 60, 20))
def test_a_mutated_design_is_meshed_or_refused_in_one_line(first: int) -> None:
    for number in range(first, first + 20):
        table, rng = DESIGNS[number % len(DESIGNS)], np.random.default_rng([7, number])
        for _ in range(1 + number % 2):
            table = mutated_table(table, rng, KEYS)
        try:
            design = Design.from_dict(table)
            plan = layout(design)
            if np.prod(np.ptp(plan.outline, axis=0)) / design.mesh.edge_mm**2 > MAX_VERTICES:
                continue
            mesh = mesh_layout(plan, design.mesh.edge_mm, design.mesh.kind)
            assert triangle_areas(mesh.points, mesh.triangles).min() > 0.0
        except Error as error:
            assert str(error) and "\n" not in str(error)
