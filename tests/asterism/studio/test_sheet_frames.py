"""Needles, tubes and ribbons of a sheet, as the page draws them."""

from __future__ import annotations

from copy import copy

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.session import Preview
from asterism.previews.sheet import StarLens
from asterism.studio.engine_frames import SheetView
from asterism.studio.sheet_frames import FABRIC_MM, SheetMarks
from tests.asterism.previews.laws import plain_law

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


def test_a_view_that_follows_strokes_shows_what_a_new_one_shows() -> None:
    pins = [{"where": "corners", "scale": 0.85}]
    design = Design.from_dict({"stars": STARS, "border": {"rings": 2}, "pins": pins, "mesh": {"edge_mm": 4.0}})
    preview = Preview(design, plain_law())
    view = SheetView(preview, is_fine=False)
    view.frame(preview, 0, "equilibrium")
    lens = preview.lens(view.printed)
    for sizes in ([(0.0, 0.3, 1.0), (9.0, 0.5, 1.4)], [(5.0, 0.3, 1.0), (0.0, 0.3, 1.0)]):
        stage = next(preview.edit(with_painted_stars(design, np.array([[0, 0], [1, -1]]), sizes)))
        anew = StarLens(preview.state.sheet, view.printed)(stage.x)
        assert np.abs(lens(stage.x).bumpy - anew.bumpy).max() <= 1e-12
        fresh = copy(view)  # a new view may have another mesh
        fresh._follow(preview)
        one, other = (each.frame(preview, 1, "linear", stage.x).arrays for each in (view, fresh))
        for name in ("positions", "curvature", "strain", "arms", "arm_normals", "needles"):
            assert one[name] == pytest.approx(other[name], abs=2e-5), name  # numbers of 4 bytes
