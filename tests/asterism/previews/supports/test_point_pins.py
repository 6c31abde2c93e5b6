"""Around a held point the shell gives way as the exact model's fabric does."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.exact.simulation import exact_shape
from asterism.fem.shell.density import isotropic
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.session import Preview
from asterism.previews.supports.point_pins import amounts_of, softened
from asterism.shape.comparison import compare_shapes
from benchmarks.point_pins import TURNED_DEG, exact_stiffness, measured, shell_stiffness

ANGLES_DEG, LACK, GAIN = PREVIEW_MODEL.point_angles_deg, PREVIEW_MODEL.point_lack, PREVIEW_MODEL.point_gain


def pinned(edge_mm: float = 2.0, **pins: object) -> Design:
    """A rectangle of 15 stars."""
    data = {
        "stars": {"length_mm": 9.0, "thickness_mm": 0.4},
        "border": {"rectangle_mm": [80.0, 80.0]},
        "mesh": {"edge_mm": edge_mm},
        "pins": [{"where": "corners", "scale": 0.85} | pins] if "edges" not in pins else [pins],
    }
    return Design.from_dict(data)


@pytest.mark.parametrize("angle", [70.0, 120.0, 165.0])
def test_a_wedge_is_as_stiff_at_its_tip_as_the_exact_one(angle: float) -> None:
    exact_mm = 1.5
    exact = float(np.mean([exact_stiffness(angle, exact_mm, turned) for turned in TURNED_DEG]))
    plain, edge = shell_stiffness(angle, 26.0, 0.0)
    amount = amounts_of(np.array([edge]), np.array([angle]), exact_mm)[0]
    assert shell_stiffness(angle, 26.0, amount)[0] == pytest.approx(exact, rel=0.08)
    assert angle < 90.0 or plain > 1.15 * exact


def test_the_numbers_are_those_of_the_benchmark() -> None:
    at = ANGLES_DEG.index(120.0)
    found = measured(120.0)
    assert found["lack"] == pytest.approx(LACK[at], abs=0.01)
    assert found["gain"] == pytest.approx(GAIN[at], abs=0.01)


def test_a_finer_exact_mesh_gives_way_more() -> None:
    edges, angles = np.full(3, 20.0), np.array([90.0, 120.0, 200.0])
    fine, coarse, stiffer = (amounts_of(edges, angles, edge) for edge in (0.5, 1.0, 20.0))
    assert (fine > coarse).all() and (coarse > 0.0).all() and (stiffer < 0.0).all()
    assert (stiffer > -1.0).all()


def test_softer_sheets_stretch_more_easily_and_bend_as_before() -> None:
    whole = isotropic(np.full(4, 5.0), np.full(4, 2.0), np.full(4, 0.4), 0.05)
    part = np.array([1.0, 0.7, 0.2, 0.01])
    soft = softened(whole, part)
    assert soft[:, :3, :3] == pytest.approx(part[:, None, None] * whole[:, :3, :3])
    assert soft[:, 3:] == pytest.approx(whole[:, 3:])


@pytest.mark.slow
def test_heights_depend_on_the_exact_models_mesh_and_not_on_the_shells_triangles() -> None:
    heights = {
        (edge, count): float(np.ptp(Preview(pinned(edge), triangles=count).shape().positions[:, 2]))
        for edge in (1.2, 2.0)
        for count in (None, 150)
    }
    for edge in (1.2, 2.0):
        assert heights[edge, None] == pytest.approx(heights[edge, 150], rel=0.04)
    assert heights[1.2, None] > 1.05 * heights[2.0, None]


@pytest.mark.slow
def test_a_sheet_on_its_corners_is_near_the_exact_one() -> None:
    design = pinned()
    plan, exact, shown = layout(design), exact_shape(design), Preview(design).shape()
    comparison = compare_shapes(exact, shown, plan, symmetries(design, plan))
    one, other = comparison.mean_heights_mm
    assert other == pytest.approx(one, rel=0.12)
    assert comparison.rms_percent < 0.3


def test_an_edited_mesh_is_that_of_a_new_preview() -> None:
    preview = Preview(pinned())
    list(preview.edit(pinned(edge_mm=1.0)))
    new = Preview(pinned(edge_mm=1.0))
    assert preview.equilibrium.energy == pytest.approx(new.equilibrium.energy, rel=1e-6)
    assert preview.equilibrium.energy < 0.999 * Preview(pinned()).equilibrium.energy


def test_only_points_that_are_held_along_the_print_count() -> None:
    assert len(layout(pinned()).in_plane_pin_points) == 4
    assert len(layout(pinned(slide="z")).in_plane_pin_points) == 4
    assert len(layout(pinned(slide="plane")).in_plane_pin_points) == 0
    assert len(layout(pinned(edges=[0, 1], scale=0.85)).in_plane_pin_points) == 0


def test_a_sheet_without_them_has_the_fields_of_its_law() -> None:
    for name in ("dome", "tube"):
        assert Preview(gallery.load(name)).shell.density.term is None
    assert Preview(pinned()).shell.density.term is not None
