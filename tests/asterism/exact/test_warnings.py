"""Warnings that go with an exact shape."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.exact.warnings import exact_warnings
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.results.records.exact import ExactRecord

SUMMARY = {
    "converged": True, "is_minimum": True, "smallest_eigenvalue": 1e-3, "gradient_norm": 1e-9,
    "gradient_tolerance": 1e-8, "self_intersections": 0, "self_contact": None, "stars_total": 19,
    "stars_off_branch": [], "mesh_error_percent": None, "mesh_tolerance_percent": None, "vertices": 900,
}  # fmt: skip


def said(scale: float = 1.0, **changes: Any) -> list[str]:
    pins = [{"where": "border", "scale": scale}]
    design = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 2}, "pins": pins})
    return exact_warnings(ExactRecord.from_json(SUMMARY | changes), design, layout(design))


def test_nothing_is_said_of_a_good_shape() -> None:
    assert said() == []


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        ({"scale": 2.0}, "the pins hold the sheet 2 times as wide"),
        ({"stars_off_branch": [3]}, "1 of 19 stars of the exact shape are not on the side that the design asks for"),
        ({"self_intersections": 4}, "passes through itself (4 pairs of triangles); --contact prevents this"),
        ({"self_intersections": 4, "self_contact": {"pairs": 0}}, "(4 pairs of triangles)"),
        ({"is_minimum": False, "smallest_eigenvalue": -1e-5}, "smallest eigenvalue -1.0e-05 N/mm is not positive"),
        (
            {"converged": False, "is_minimum": False, "gradient_norm": 1e-3},
            "not an equilibrium: gradient 1.0e-03 N is above 1.0e-08 N",
        ),
    ],
)
def test_what_is_wrong_is_said_once(changes: dict[str, Any], line: str) -> None:
    (only,) = said(**changes)
    assert line in only
    if changes.get("self_contact"):
        assert "--contact" not in only


@pytest.mark.parametrize(("axis", "edge", "told"), [(30.0, 2.0, True), (30.0, 0.5, False), (None, 2.0, False)])
def test_a_free_roll_on_a_coarse_mesh_has_no_certain_radius(axis: float | None, edge: float, told: bool) -> None:
    hinges = {"fabric": {"bending": "paper"}}
    free = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 2}} | hinges)
    summary = ExactRecord.from_json(SUMMARY | {"roll_axis_deg": axis, "edge_mm": edge})
    assert ["depends on the mesh" in line for line in exact_warnings(summary, free, layout(free))] == [True] * told
