"""Needles, tubes and ribbons of a sheet, as the page draws them."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.studio.sheet_frames import FABRIC_MM, SheetMarks

STARS = {"length_mm": 8.0}


@pytest.mark.parametrize("border", [{"circle_mm": {"radius": 40.0}}, {"rectangle_mm": (90, 60)}])
def test_a_tube_holds_a_curve_and_needles_a_straight_edge(border: dict[str, object]) -> None:
    sheet = layout(Design.from_dict({"stars": STARS, "border": border, "pins": [{"where": "border"}]}))
    mesh = mesh_layout(sheet, 4.0)
    needles = SheetMarks(mesh.points, mesh.triangles).needles(sheet, np.pad(mesh.points, ((0, 0), (0, 1))))
    if "circle_mm" in border:
        assert len(needles) == len(sheet.outline) and np.allclose(needles[1:, 0], needles[:-1, 1])  # without gaps
        assert np.allclose(np.linalg.norm(needles[:, :, :2], axis=2), 40.0, atol=1e-3)
    else:
        assert len(needles) == 2 * (5 + 3) and np.array_equal(needles[:, 0, :2], needles[:, 1, :2])


def test_plastic_below_hangs_at_the_lower_face_of_the_fabric() -> None:
    stars = {**STARS, "override": [{"star": 0, "side": "below"}]}
    sheet = layout(Design.from_dict({"stars": stars, "border": {"rings": 2}}))
    mesh = mesh_layout(sheet, 4.0)
    flat, up = np.pad(mesh.points, ((0, 0), (0, 1))), np.tile([0.0, 0.0, 1.0], (len(mesh.points), 1))
    arms, normals = SheetMarks(mesh.points, mesh.triangles).ribbons(sheet, flat, up)
    below = sheet.arm_star == 0
    assert (normals[below, :, 2] == -1.0).all() and (normals[~below, :, 2] == 1.0).all()
    outer, inner = arms[:, :, 0, 2], arms[:, :, 2, 2]
    assert (outer[below] < inner[below]).all() and np.allclose(inner[below], -FABRIC_MM)
    assert (outer[~below] > inner[~below]).all() and np.allclose(inner[~below], 0.0)
