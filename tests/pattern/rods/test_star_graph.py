"""The graph of stars: one rod an arm, and joints only where arms of different stars meet."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout


def test_stars_apart_have_no_joint() -> None:
    sheet = layout(Design.from_dict({"stars": {"length_mm": 10.0}, "border": {"rings": 1}}))
    assert sheet.graph.joints == () and sheet.graph.links == ()
    assert sheet.graph.paired.tolist() == list(range(7))
    assert [rod.group for rod in sheet.graph.rods] == sheet.arm_star.tolist()
    np.testing.assert_array_equal([rod.points[1] for rod in sheet.graph.rods], sheet.arm_tip)


def test_three_tips_meet_in_one_joint() -> None:
    """Turned by 30 degrees, with arms of d/sqrt(3), the stars are a honeycomb."""
    stars, lattice = {"length_mm": 10.0}, {"orientation_deg": 30}
    graph = layout(Design.from_dict({"stars": stars, "lattice": lattice, "border": {"rings": 1}})).graph
    assert sorted(len(graph.ends_at[node]) for node in graph.joints) == [2] * 3 + [3] * 3
    assert len(graph.paired) == 7


def test_tips_on_the_centre_of_a_neighbour_are_bonded_to_its_arms() -> None:
    graph = layout(Design.from_dict({"stars": {"length_fraction": 1.0}, "border": {"rings": 1}})).graph
    # three arms of its own and three that reach the central star
    assert len(graph.ends_at[0]) == 6 and 0 in graph.joints and 0 not in graph.paired


@pytest.mark.parametrize("far", [0.01, 0.1])
def test_sections_are_linear_along_an_arm(far: float) -> None:
    stars = {"length_mm": 8.0, "thickness_mm": {"profile": "radial", "from": 0.3, "to": 0.3 + far, "over_mm": 20.0}}
    graph = layout(Design.from_dict({"stars": stars | {"vary_along_arms": True}, "border": {"rings": 1}})).graph
    arm = graph.rods[0]
    assert arm.at(arm.thickness, np.array([0.0, 0.25, 1.0])) == pytest.approx(
        [arm.thickness[0], 0.75 * arm.thickness[0] + 0.25 * arm.thickness[1], arm.thickness[1]]
    )
