"""What the page draws of a sheet: patterns of drawn rods, needles, tubes and ribbons of arms."""

from __future__ import annotations

from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews import session as preview_session
from asterism.previews.session import Preview
from asterism.studio.document import Document
from asterism.studio.engine_frames import SheetView
from asterism.studio.messages import Edit, Limits, Rested
from asterism.studio.page_data import document_data
from asterism.studio.sheet_frames import FABRIC_MM, NO_SITE, SheetMarks, ribbon_stations
from tests.asterism.previews.laws import plain_law
from tests.asterism.previews.motifs.nets import net, net_law
from tests.asterism.studio.engine_pipe import EnginePipe

CROSS = """# two lines
[rods]
thickness_mm = 0.4  # of both
[[rods.draw]]
line_mm = [[-14.0, 0.0], [14.0, 0.0]]
[[rods.draw]]
line_mm = [[0.0, -9.0], [0.0, 9.0]]
width_mm = 2.0

[border]
rectangle_mm = [30.0, 20.0]
holes = [{ circle_mm = { centre = [7.0, 5.0], radius = 2.0 } }]

[mesh]
edge_mm = 4.0
"""


@pytest.fixture
def cross(tmp_path: Path) -> Document:
    (tmp_path / "cross.toml").write_text(CROSS, encoding="utf-8")
    return Document.open(tmp_path / "cross.toml")


def test_the_plan_has_rods_and_holes_and_no_stars(cross: Document) -> None:
    plan = document_data(cross, "ultimaker2", None)["plan"]
    assert plan["sites"] == [] and len(plan["holes_mm"]) == 1
    widths = sorted(rod["width_mm"][0] for rod in plan["rods"])
    assert widths == [1.2, 1.2, 2.0, 2.0]  # the lines are cut at their crossing
    assert {rod["thickness_mm"][0] for rod in plan["rods"]} == {0.4}


def test_ribbons_follow_curves_and_taper(tmp_path: Path) -> None:
    table = {
        "rods": {"draw": [{"circle_mm": {"radius": 10.0}}], "width_mm": {"formula": "1.5 + 0.02*x"}},
        "border": {"rectangle_mm": (24, 24)},
    }
    sheet = layout(Design.from_dict(table))
    stations = ribbon_stations(sheet)
    assert (stations.site == NO_SITE).all() and len(stations.site) == 13  # of 5 mm at most
    assert np.linalg.norm(stations.points, axis=-1) == pytest.approx(np.full(stations.width.shape, 10.0), abs=0.01)
    assert stations.width == pytest.approx(1.5 + 0.02 * stations.points[..., 0], abs=2e-3)


def test_a_pattern_without_a_preview_is_left_to_the_exact_model(engine: EnginePipe, cross: Document) -> None:
    engine.send(Edit(1, cross.table))
    frame = engine.frame(1, "printed")
    places, arms, mesh = frame.arrays["positions"], frame.arrays["arms"], frame.mesh_arrays
    assert places[:, :2] == pytest.approx(mesh["printed"]) and not places[:, 2].any()
    assert arms[:, :, :2, 2].min() == pytest.approx(0.4) and len(arms) == len(mesh["arm_site"])
    rested = engine.until(lambda answer: isinstance(answer, Rested))
    assert rested.shape is None and 0.5 < rested.seconds < 20.0
    engine.send(Edit(2, {**cross.table, "border": {"rectangle_mm": [32.0, 20.0]}}))
    assert np.ptp(engine.frame(2, "printed").arrays["positions"][:, 0]) == pytest.approx(32.0)


@pytest.mark.slow
def test_a_motif_rises_around_a_held_hole_while_its_sizes_are_edited(
    engine: EnginePipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(preview_session, "serving_law", lambda design, plan, known, say: net_law(design, known, say))

    def holed(radius: float, *thickness: float) -> dict[str, Any]:
        border = {"rectangle_mm": (40.0, 40.0), "holes": [{"circle_mm": {"centre": (0.0, 0.0), "radius": radius}}]}
        return net(*thickness, border=border, pins=[{"holes": [0], "scale": 0.9}]).to_dict()

    frame = engine.show(1, holed(9.0))
    (limits,) = [answer for answer in engine.answers if isinstance(answer, Limits)]
    assert not limits.law and not limits.stretches  # a motif has cells where its sizes are
    assert frame.is_minimum and frame.height_mm > 1.0 and len(frame.arrays["needles"]) >= 1
    assert len(frame.arrays["arms"]) == len(frame.mesh_arrays["arm_site"]) > 20
    assert engine.summary(1).numbers["expected_rms_percent"] > 0.0
    engine.send(Edit(2, holed(9.0, 0.5)))
    linear, final = engine.frame(2, "linear"), engine.frame(2)
    assert linear.mesh == final.mesh and final.height_mm != pytest.approx(frame.height_mm, rel=1e-3)
    engine.show(3, holed(8.0))
    (first, *_, last) = engine.meshes().values()
    away = [float(np.linalg.norm(mesh["printed"], axis=1).min()) for mesh in (first, last)]
    assert away == pytest.approx([9.0, 8.0], abs=0.1)


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
    for sizes in ([(0.0, 0.3, 1.0), (9.0, 0.5, 1.4)], [(5.0, 0.3, 1.0), (0.0, 0.3, 1.0)]):
        stage = next(preview.edit(with_painted_stars(design, np.array([[0, 0], [1, -1]]), sizes)))
        fresh = copy(view)  # a new view may have another mesh
        fresh._follow(preview)
        one, other = (each.frame(preview, 1, "linear", stage.x).arrays for each in (view, fresh))
        for name in ("positions", "curvature", "strain", "arms", "arm_normals", "needles"):
            assert one[name] == pytest.approx(other[name], abs=2e-5), name  # numbers of 4 bytes
