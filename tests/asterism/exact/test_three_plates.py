"""Sheets with the bending stiffness of three plates have the shape of the hinges; those with one plate have not.

On equilateral triangles the hinges are a plate with three times the stiffness D of the fabric's thickness and modulus,
and Poisson's ratio -1/3. A measured stiffness of 3 D keeps the ratio of the fabric, so the two energies are equal for
cylinders only.
"""

from __future__ import annotations

from typing import Any

import pytest

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.shape.comparison import compare_shapes


def sheet(**fabric: Any) -> Design:
    """Seven free stars on an even mesh."""
    return Design.from_dict(
        {
            "stars": {"length_mm": 8.0, "thickness_mm": 0.35},
            "fabric": {"modulus_mpa": Fabric().modulus_mpa, **fabric},
            "border": {"rings": 1},
            "mesh": {"edge_mm": 2.0},
        }
    )


@pytest.mark.slow
def test_three_plates_are_the_papers_hinges() -> None:
    fabric, design = Fabric(), sheet()
    plate_n_mm = fabric.modulus_mpa * fabric.thickness_mm**3 / (12.0 * (1.0 - fabric.poisson**2))
    three = sheet(bending="consistent", bending_stiffness_n_mm=3.0 * plate_n_mm)
    hinges, *others = (exact_shape(each) for each in (design, three, sheet(bending="consistent")))
    assert all(shape.summary["is_minimum"] for shape in (hinges, *others))
    plan = layout(design)
    far = [compare_shapes(hinges, shape, plan, symmetries(design, plan)).rms_percent for shape in others]
    assert far[0] < 2.0 < far[1]
