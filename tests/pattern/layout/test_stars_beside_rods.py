"""Stars and drawn rods in one design: laid out side by side, meshed, and refused where they would touch."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout

RIM = {"name": "rim", "circle_mm": {"radius": 40.0}, "thickness_mm": 0.6}
STARS = {"length_mm": 7.0, "thickness_mm": 0.4}


def design(**changes: Any) -> Design:
    return Design.from_dict({"stars": STARS, "rods": {"draw": [RIM]}, "border": {"rods": "rim"}} | changes)


def test_stars_stand_within_a_printed_rim() -> None:
    plan = layout(design())
    assert len(plan.centres) == 13 and len(plan.drawn_rods) == 1 and plan.rim == (len(plan.arm_star),)
    assert [rod.group for rod in plan.graph.rods[:3]] == [0, 0, 0] and plan.graph.rods[-1].name == "rim"
    assert set(plan.graph.paired.tolist()) == set(range(13)) and plan.graph.joints == ()
    assert len(symmetries(design(), plan)) == 6 and len(plan.sample_points) == 13
    assert sorted(symmetries(design(), plan)[1].star.tolist()) == list(range(13))


def test_the_stars_are_those_without_the_rods() -> None:
    line = {"name": "line", "line_mm": [(25, -10), (25, 10)]}
    border = {"rings": 1}
    both = layout(design(rods={"draw": [line]}, border=border))
    alone = layout(Design.from_dict({"stars": STARS, "border": border}))
    for key in ("centres", "arm_tip", "arm_thickness", "outline", "star_number", "sample_pairs"):
        np.testing.assert_array_equal(getattr(both, key), getattr(alone, key))


def test_the_mesh_follows_arms_and_rods() -> None:
    plan = layout(design())
    mesh = mesh_layout(plan, 3.0)
    np.testing.assert_allclose(mesh.points[mesh.star_vertices], plan.centres, atol=1e-9)
    assert mesh.kind == "delaunay" and len(mesh.rods) == len(plan.graph.rods)
    ends = [mesh.points[rod[-1]] for rod in mesh.rods[: len(plan.arm_tip)]]
    np.testing.assert_allclose(ends, plan.arm_tip, atol=1e-9)


def test_arms_that_touch_a_line_are_refused_with_both_places() -> None:
    crossing = {"name": "line", "line_mm": [(-30, -4), (30, -4)]}
    with pytest.raises(DesignError, match=r"star at \[.*\] crosses line at \[.*, -4.00\]: shorten") as told:
        layout(design(rods={"draw": [crossing]}, border={"rings": 1}))
    assert len(told.value.stars) == 1
    beside = {"name": "line", "line_mm": [(-30, -7.5), (30, -7.5)]}
    with pytest.raises(DesignError, match=r"is 0.50 mm from line"):
        layout(design(rods={"draw": [beside]}, border={"rings": 1}))


def test_stars_keep_clear_of_holes_and_of_their_rims() -> None:
    window = {"name": "window", "circle_mm": {"radius": 6.0}}
    border = {"rods": "rim", "holes": [{"rods": "window"}]}
    plan = layout(design(rods={"draw": [RIM, window]}, border=border))
    assert len(plan.centres) == 12 and len(plan.hole_rims[0]) == 1
    assert plan.graph.rods[plan.hole_rims[0][0]].name == "window"
