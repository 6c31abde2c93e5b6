"""Sheets with holes: fields, free rims and shapes; edges on a curve of targets, which both models meet."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.discrete.model.discrete_model import pin_constraints
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import inside, triangle_areas
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.fields.sheet_fields import free_normals, hole_sites, rim_curvature_share
from asterism.previews.fields.star_cells import StarCells
from asterism.previews.session import Preview
from asterism.previews.sheet import Sheet
from asterism.shape.comparison import compare_shapes
from tests.asterism.previews.laws import plain_law
from tests.asterism.verification.printed import shape

ROUND = {"circle_mm": {"centre": [0, 0], "radius": 8}}


def holed(holes: list[object], pins: list[object] | None = None) -> Design:
    border = {"rings": 2, "holes": holes}
    return Design.from_dict({"stars": {"length_mm": 7.0}, "border": border, "pins": pins or [], "mesh": {"edge_mm": 4}})


def test_the_grid_of_cells_leaves_the_hole_out() -> None:
    design = holed([{"polygon_mm": [[-9, -7], [8, -9], [9, 8], [0, 3], [-8, 9]]}])
    plan = layout(design)
    grid = StarCells(plan, design.lattice)
    places = grid.origin + grid.step * np.stack(np.meshgrid(*map(np.arange, grid.count.shape), indexing="ij"), axis=-1)
    on_sheet = plan.is_on_sheet(places.reshape(-1, 2)).reshape(grid.count.shape)
    assert on_sheet.sum() < inside(places.reshape(-1, 2), plan.outline).sum()
    np.testing.assert_array_equal(grid.count == 1.0, on_sheet)


def test_the_rim_of_a_hole_turns_to_its_middle_and_its_bare_sites_are_no_hole_of_the_pattern() -> None:
    plan = layout(holed([ROUND]))
    assert len(plan.centres) == 18 and len(hole_sites(plan)) == 0
    angle = np.radians([10.0, 100.0, 200.0])
    places = 8.5 * np.column_stack([np.cos(angle), np.sin(angle)])
    assert free_normals(plan, places) == pytest.approx(-places / 8.5, abs=0.1)
    held = layout(holed([ROUND], [{"holes": [0], "scale": 0.8}]))
    assert not free_normals(held, places).any()


def test_arms_towards_a_hole_end_at_its_rim() -> None:
    design = holed([ROUND])
    directions = design.lattice.arm_directions
    with_hole, whole = layout(design), layout(holed([]))
    # bare sites in both: the star in the middle is removed from the sheet without a hole
    data = holed([]).to_dict()
    data["stars"]["override"] = [{"star": 0, "remove": True}]
    bare = layout(Design.from_dict(data))
    assert len(bare.centres) == len(with_hole.centres) == len(whole.centres) - 1
    less = rim_curvature_share(bare, directions) - rim_curvature_share(with_hole, directions)
    assert less.min() == pytest.approx(0.0) and less.max() > 0.2


@pytest.mark.slow
def test_a_sheet_with_a_hole_is_certified_and_compared_with_its_images() -> None:
    design = holed([ROUND])
    plan = layout(design)
    sheet = Sheet.of(design, plan, plain_law())
    assert sheet.table.weights.sum() == pytest.approx(plan.area_mm2)
    preview = Preview(design, plain_law())
    shown, same = preview.shape(), symmetries(design, plan)
    assert preview.equilibrium.is_minimum
    with pytest.raises(ValueError, match="off the sheet"):
        shown.at(np.array([[0.0, 0.0]]))
    compared = compare_shapes(shown, shown, plan, same)
    assert len(same) > 1 and compared.rms_percent == pytest.approx(0.0, abs=1e-9)


def test_volumes_are_over_the_level_of_the_outline_and_not_of_the_hole() -> None:
    design = holed([ROUND])
    plan = layout(design)
    mesh = mesh_layout(plan, 4.0)
    flat = shape(design, lambda p: np.column_stack([p, np.zeros(len(p))]), 4.0)
    raised = shape(design, lambda p: np.column_stack([p, 5.0 - 0.1 * np.linalg.norm(p, axis=1)]), 4.0)
    compared = compare_shapes(raised, flat, plan, symmetries(design, plan)[:1])
    volumes, mean = compared.record.volumes_mm3, compared.reference_mean
    # a rigid motion of least squares, on a mesh that is not quite symmetric, tilts the flat sheet a little
    assert volumes is not None and volumes[1] == pytest.approx(0.0, abs=1e-4 * volumes[0])
    level = mean[mesh.border_vertices, 2].mean()
    over_level = mean[mesh.triangles, 2].mean(axis=1) - level
    assert volumes[0] == pytest.approx(over_level @ triangle_areas(mean[:, :2], mesh.triangles))
    assert mean[mesh.hole_vertices[0], 2].mean() > level + 1.0


TURN = 2.0 * np.pi * np.arange(30) / 30
RING = 40.0 * np.column_stack([np.cos(TURN), np.sin(TURN)])
WAVE = np.column_stack([0.8 * RING, 4.0 * np.cos(2.0 * TURN)])


def sheet(**pins: Any) -> Design:
    data = gallery.load("tube").to_dict() | {"border": {"polygon_mm": RING.tolist()}}
    return Design.from_dict(data | {"pins": [{"where": "border"} | pins]})


def affine() -> tuple[Design, Design]:
    places = np.column_stack([0.8 * RING, np.zeros(30)]) + np.array([1.0, 2.0, 3.0])
    return sheet(scale=0.8, offset_mm=[1.0, 2.0, 3.0]), sheet(target_mm=places.tolist())


def test_affine_targets_give_the_same_sheets() -> None:
    by_scale, by_targets = (Preview(design, plain_law()) for design in affine())
    inner = 0.7 * RING
    np.testing.assert_allclose(by_targets.at(inner).smooth, by_scale.at(inner).smooth, atol=1e-5)
    plans = [layout(design) for design in affine()]
    mesh = mesh_layout(plans[0], 4.0)
    one, other = (pin_constraints(plan, mesh) for plan in plans)
    np.testing.assert_array_equal(one.held, other.held)
    np.testing.assert_allclose(one.target, other.target, atol=1e-9)


def test_both_models_hold_the_border_on_the_curve() -> None:
    design = sheet(target_mm=WAVE.tolist())
    plan, preview = layout(design), Preview(design, plain_law())
    assert preview.equilibrium.is_minimum
    assert np.abs(preview.at(RING).smooth - WAVE).max() < 0.4
    mesh = mesh_layout(plan, 4.0)
    supports = pin_constraints(plan, mesh)
    held = supports.held.all(axis=1)
    angle = np.arctan2(mesh.points[held, 1], mesh.points[held, 0])
    np.testing.assert_allclose(supports.target[held, 2], 4.0 * np.cos(2.0 * angle), atol=0.03)
