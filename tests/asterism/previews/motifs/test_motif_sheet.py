"""The sheet of a motif: fields of the law by place, bare fabric, weight."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.previews.motifs.motif_cover import bare_share, reach_mm
from asterism.previews.motifs.motif_sheet import fabric_sheet, motif_sheet_of
from asterism.previews.motifs.motif_values import MotifFieldValues
from pattern.design.materials import Fabric
from pattern.layout.print_layout import print_layout
from tests.asterism.previews.motifs.nets import GRADED, net, net_law


def test_the_fields_are_those_of_the_law_at_each_place() -> None:
    design = net(GRADED)
    plan, law = print_layout(design), net_law(design)
    sheet = motif_sheet_of(design, plan)
    fields = sheet.fields(MotifFieldValues.of(design, plan, law))
    x = sheet.table.points[..., 0].ravel()
    thickness = np.clip(0.45 + 0.0025 * x, 0.4, 0.5)
    at = law.evaluate(design, thickness, 1.2)
    assert np.asarray(fields.metric).reshape(-1, 3) == pytest.approx(at.metric)
    assert np.asarray(fields.curvature).reshape(-1, 3) == pytest.approx(at.curvature)
    assert np.asarray(fields.density.stiffness).reshape(-1, 6, 6) == pytest.approx(at.stiffness)  # type: ignore[union-attr]


def test_a_net_reaches_half_a_mesh_and_its_rim_belongs_to_it() -> None:
    design = net()
    assert reach_mm(design) == 5.0
    sheet = motif_sheet_of(design, print_layout(design))
    assert not sheet.bare.any()


def test_a_wide_rim_is_bare_fabric() -> None:
    design = net(border={"rectangle_mm": (60.0, 60.0), "tip_margin_mm": 9.0})
    plan = print_layout(design)
    tip = max(rod.points[:, 1].max() for rod in plan.graph.rods)
    at = np.array([[5.0, tip - 1.0], [5.0, tip + 5.0], [5.0, tip + 6.25], [5.0, tip + 8.0]])
    assert bare_share(plan, reach_mm(design), at) == pytest.approx([0.0, 0.0, 0.5, 1.0])
    sheet = motif_sheet_of(design, plan, triangles=400)
    fields = sheet.fields(MotifFieldValues.of(design, plan, net_law(design)))
    barest = np.unravel_index(sheet.bare.argmax(), sheet.bare.shape)
    stiffness, metric = fabric_sheet(design.fabric)
    assert sheet.bare[barest] == 1.0
    assert np.asarray(fields.metric)[barest] == pytest.approx(metric)
    assert np.asarray(fields.density.stiffness)[barest] == pytest.approx(stiffness)  # type: ignore[union-attr]


def test_bare_fabric_has_its_own_tension_on_the_print() -> None:
    """The tension of fabric that is held as printed is that of Green's strain on its rest metric."""
    fabric = Fabric(stretch=1.1)
    stiffness, metric = fabric_sheet(fabric)
    assert metric == pytest.approx([1.1**-2, 1.1**-2, 0.0])
    strain = 0.5 * (1.0 - metric[0])  # in printed coordinates
    of_rest = strain / metric[0]
    plane = fabric.modulus_mpa / (1.0 - fabric.poisson)
    energy = 0.5 * np.array([strain, strain]) @ stiffness[:2, :2] @ np.array([strain, strain])
    assert energy == pytest.approx(plane * of_rest**2 * fabric.thickness_mm / 1.1**2)


def test_the_sheet_weighs_what_is_printed() -> None:
    design = net(GRADED, gravity={"on": True}, fabric={"modulus_mpa": 0.7})
    plan = print_layout(design)
    sheet = motif_sheet_of(design, plan)
    loads = sheet.loads()
    volume = sum(
        np.diff(rod.arc_lengths) @ (0.25 * (rod.thickness[1:] + rod.thickness[:-1]) * (rod.width[1:] + rod.width[:-1]))
        for rod in plan.graph.rods
    )
    mass = design.fabric.printed_mass * 1600.0 + 1e-9 * design.plastic.density_kg_m3 * volume
    # the work of the weight in a shift of the whole sheet
    moved_by_one = np.zeros((1, 6, 3)) + np.eye(6)[0][None, :, None]
    shift = sheet.space.interpolate(lambda points: np.repeat(moved_by_one, len(points), axis=0))
    assert (shift * loads)[:, 2].sum() == pytest.approx(-mass * design.gravity.acceleration_m_s2, rel=1e-6)
