"""The plastic as watertight solids: arms that overlap are united, tapered arms are staircases of layers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import example, given, settings
from hypothesis import strategies as st

from asterism.pattern.design.design import Design
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.build import layout
from asterism.print.formats.meshes import write_stl
from asterism.print.solid import (
    GRID_MM,
    Solid,
    Terrace,
    border_terrace,
    nested_terraces,
    pieces,
    plastic_terraces,
    terraced_solid,
)
from tests.asterism.print.jobs import design, job

RULE = Rounding(first_layer_mm=0.2, layer_mm=0.1, line_mm=0.4)


BOXES = st.tuples(*[st.integers(-40, 40)] * 2, *[st.integers(1, 20)] * 2, st.integers(1, 5))


def volume(steps: Sequence[Terrace]) -> float:
    """Under nested terraces."""
    below = [0.0, *(step.height_mm for step in steps)]
    return sum(step.region.area * (step.height_mm - under) for step, under in zip(steps, below, strict=False))


def checked(solid: Solid) -> trimesh.Trimesh:
    """The same surface in another library, closed, turned outwards, without triangles of no area."""
    mesh = trimesh.Trimesh(solid.points, solid.triangles, process=False)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.volume > 0
    assert mesh.area_faces.min() > 0
    assert solid.volume_mm3 == pytest.approx(mesh.volume, rel=1e-9)
    return mesh


def test_a_star_is_three_strips_that_overlap_in_the_middle() -> None:
    length, width, height = 8.0, 1.2, 0.4
    one = job(
        design(stars={"length_mm": length, "thickness_mm": height, "width_mm": width}, border={"rings": 0}, pins=[])
    )
    # three rectangles, less the kites that each two of them have in common
    area = 3 * length * width - 3 * (width / 2) ** 2 / np.sqrt(3)
    mesh = checked(one.solids[0])
    # corners lie on a grid
    assert mesh.volume == pytest.approx(area * height, abs=GRID_MM / 2 * one.pattern[0].region.length * height)
    assert mesh.extents == pytest.approx([2 * (length * np.cos(np.pi / 6) + width / 4), 12.52, height], abs=0.002)
    assert mesh.bounds[0, 2] == 0.0


def test_arms_that_meet_become_one_piece() -> None:
    apart = checked(job(design(stars={"length_mm": 8.0}, pins=[])).solids[0])
    joined = checked(job(design(stars={"length_fraction": 1.0, "width_mm": 0.8}, pins=[])).solids[0])
    assert (apart.body_count, joined.body_count) == (19, 1)


def test_a_tapered_arm_is_a_staircase_of_whole_layers() -> None:
    thickness = {"profile": "radial", "from": 0.7, "to": 0.2, "over_mm": 8.0}
    stars = {"length_mm": 8.0, "thickness_mm": thickness, "vary_along_arms": True, "rounding": RULE.model_dump()}
    plan = layout(design(stars=stars, border={"rings": 0}, pins=[]))
    arms, _ = pieces(plan, RULE)
    steps = plastic_terraces(arms, [])
    assert [step.height_mm for step in steps] == pytest.approx([0.2, 0.3, 0.4, 0.5, 0.6, 0.7])
    down = [piece.points for piece in arms if np.allclose(piece.points[:, 0], 0.0)]
    # half a layer more than a step begins the next
    assert [-begin[1] for begin, _ in down] == pytest.approx([0.0, 0.8, 2.4, 4.0, 5.6, 7.2])
    assert down[-1][1] == pytest.approx([0.0, -8.0])
    mesh = checked(terraced_solid("stars", steps))
    assert mesh.volume == pytest.approx(sum(s.region.area * 0.1 for s in steps) + steps[0].region.area * 0.1, rel=1e-6)


def test_the_printed_border_stays_outside_the_sheet_and_clear_of_stars() -> None:
    plan = job(design(pins=[]))
    sheet = shapely.Polygon(plan.plan.outline)
    assert plan.border.region.intersection(sheet).area < 1e-3 * plan.border.region.area
    assert plan.border.region.distance(plan.pattern[0].region) >= plan.rounding.line_mm - 0.002
    assert plan.border.region.area == pytest.approx(sheet.length * plan.rounding.line_mm, rel=0.02)
    checked(plan.solids[1])
    assert plan.solids[1].box[1, 2] == plan.rounding.first_layer_mm


def test_the_border_gives_way_to_plastic_that_reaches_over_it() -> None:
    plan = layout(design(pins=[]))
    over = Terrace(0.2, shapely.Point(plan.outline[0]).buffer(2.0))
    line = border_terrace(plan, [over], RULE)
    assert line.region.distance(over.region) >= RULE.line_mm - 0.002


@pytest.mark.parametrize("rings", [1, 2])
def test_a_border_in_pieces_is_watertight(rings: int) -> None:
    stars = {"length_fraction": 1.0, "width_mm": 2.0}
    checked(job(Design.from_dict({"stars": stars, "border": {"rings": rings}})).solids[1])


def test_nothing_makes_no_solid() -> None:
    with pytest.raises(ValueError, match="has no area"):
        terraced_solid("stars", [Terrace(0.2, shapely.Polygon())])


@example([(0, 0, 1, 1, 1), (1, 1, 1, 1, 1)])
@example([(0, 0, 8, 1, 3), (0, 5, 1, 1, 2), (0, 5, 1, 9, 1), (0, -6, 7, 9, 1), (-8, -3, 15, 7, 4)])
@settings(max_examples=60)
@given(st.lists(BOXES, min_size=1, max_size=12))
def test_any_pile_of_boxes_is_watertight(boxes: list[tuple[int, int, int, int, int]]) -> None:
    """Faces, edges and corners that coincide are the rule here."""
    regions = [(0.1 * h, shapely.box(x / 2, y / 2, (x + a) / 2, (y + b) / 2)) for x, y, a, b, h in boxes]
    steps = nested_terraces(regions)
    solid = terraced_solid("boxes", steps)
    assert trimesh.Trimesh(solid.points, solid.triangles, process=False).is_watertight
    assert solid.volume_mm3 == pytest.approx(volume(steps), rel=1e-9)
    exact = sum(
        shapely.union_all([region for height, region in regions if height > 0.1 * level + 0.05]).area * 0.1
        for level in range(5)
    )
    # corners that touch are joined by squares of a few micrometres
    assert solid.volume_mm3 == pytest.approx(exact, abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "arms", "fraction", "orientation", "taper"),
    [
        ("triangular", 3, 1.0, 0.0, True),
        ("triangular", 6, 0.5, 0.0, True),
        ("square", 4, 0.5, 0.0, False),
        ("square", 4, 0.577, 30.77, True),
    ],
)
def test_stars_of_many_kinds_are_watertight_in_single_precision(
    kind: str, arms: int, fraction: float, orientation: float, taper: bool, tmp_path: Path
) -> None:
    """Arms that join, of many heights: the corners of all terraces are the same ones, and far enough apart for STL."""
    stars = {
        "length_fraction": fraction,
        "width_mm": 1.7 if orientation else 0.6,
        "vary_along_arms": taper,
        "thickness_mm": {"formula": "0.5 + 0.3*sin(x/9)*cos(y/7)"},
    }
    lattice = {"kind": kind, "arms": arms, "spacing_mm": 10.34, "orientation_deg": orientation}
    border = {"rectangle_mm": [90.0, 70.0]}
    one = job(design(fabric={}, lattice=lattice, stars=stars, border=border, pins=[]), turn_deg=17.3 if taper else 0.0)
    for solid, steps in zip(one.solids, (one.pattern, (one.border,)), strict=True):
        write_stl(tmp_path / "a.stl", solid.points, solid.triangles)
        assert trimesh.load_mesh(tmp_path / "a.stl").is_watertight
        assert solid.volume_mm3 == pytest.approx(volume(steps), rel=1e-7)
