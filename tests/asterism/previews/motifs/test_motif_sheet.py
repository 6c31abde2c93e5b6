"""The sheet of a motif: fields of the law by place, bare fabric, weight, and the rims of the sheet and of its holes."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from asterism.discrete.energies.membrane import Membrane
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.layout.build import layout
from asterism.previews.motif_sheet import (
    MotifSheet,
    bare_fabric,
    fabric_bending,
    fabric_tension,
    reach_mm,
    rims_of,
    small_holes,
)
from asterism.previews.session import Preview
from tests.asterism.previews.motifs.nets import GRADED, net, net_law


def test_the_fields_are_those_of_the_law_at_each_place() -> None:
    design = net(GRADED)
    plan, law = layout(design), net_law(design)
    sheet = MotifSheet.of(design, plan, law)
    fields = sheet.fields(sheet.values)
    x = sheet.table.points[..., 0].ravel()
    thickness = np.clip(0.45 + 0.0025 * x, 0.4, 0.5)
    at = law.evaluate(design, thickness, 1.2)
    assert np.asarray(fields.metric).reshape(-1, 3) == pytest.approx(at.metric)
    assert np.asarray(fields.curvature).reshape(-1, 3) == pytest.approx(at.curvature)
    assert np.asarray(fields.density.stiffness).reshape(-1, 6, 6) == pytest.approx(at.stiffness)  # type: ignore[union-attr]


def test_a_net_reaches_half_a_mesh_and_its_rim_belongs_to_it() -> None:
    design = net()
    assert reach_mm(design) == 5.0
    sheet = MotifSheet.of(design, layout(design), net_law(design))
    assert not sheet.bare.any()


def test_a_wide_rim_is_bare_fabric() -> None:
    design = net(border={"rectangle_mm": (60.0, 60.0), "tip_margin_mm": 9.0})
    plan = layout(design)
    sheet = MotifSheet.of(design, plan, net_law(design), triangles=400)
    drawn = shapely.MultiLineString([rod.points for rod in plan.graph.rods])
    points = shapely.points(np.random.default_rng(0).uniform(-30.0, 30.0, (20000, 2)))
    is_bare = shapely.distance(drawn, points) > reach_mm(design)
    weights = sheet.table.weights
    assert (sheet.bare * weights).sum() / weights.sum() == pytest.approx(is_bare.mean(), abs=0.01)
    assert sheet.bare.max() == pytest.approx(1.0, abs=1e-6) and sheet.bare.min() == 0.0


def test_fabric_as_printed_has_its_tension() -> None:
    """Of a neo-Hookean membrane with equal stretches: `t/s^2 (mu (s^2 - 1) + 2 lam ln s)` per printed length."""
    fabric = Fabric(stretch=1.35)
    mu = fabric.modulus_mpa / (2.0 * (1.0 + fabric.poisson))
    lam = fabric.modulus_mpa * fabric.poisson / (1.0 - fabric.poisson**2)
    tension = fabric.thickness_mm / 1.35**2 * (mu * (1.35**2 - 1.0) + 2.0 * lam * np.log(1.35))
    assert fabric_tension(fabric, np.array([[1.0, 1.0, 0.0]]))[0] == pytest.approx([tension, tension, 0.0])


def test_fabric_with_a_grain_has_the_energy_of_the_exact_model() -> None:
    fabric = Fabric(modulus_mpa=(11.36, 4.55), grain_deg=35.0, stretch=(1.3, 1.6))
    printed = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    exact = Membrane(np.array([[0, 1, 2]]), printed / fabric.stretch_xy, fabric)
    term = bare_fabric(fabric, np.array([[[0.5, 0.4, 0.05]]]), np.ones((1, 1)))
    for turn in np.random.default_rng(0).normal(0.8 * np.eye(2), 0.1, (5, 2, 2)):
        c = turn.T @ turn
        strain = np.array([[0.5 * (c[0, 0] - 0.5), 0.5 * (c[1, 1] - 0.4), c[0, 1] - 0.05, 0.0, 0.0, 0.0]])
        state = np.column_stack([printed @ turn.T, np.zeros(3)])
        assert 0.5 * term(strain)[0] == pytest.approx(exact.energies(state.ravel()))


def test_fabric_bends_by_its_grain() -> None:
    fabric = Fabric(modulus_mpa=(9.0, 3.0), bending_stiffness_n_mm=(0.9, 0.3), grain_deg=35.0, stretch=1.3)
    for direction, stiffness in zip(fabric.axes.T, (0.9, 0.3), strict=True):
        curvature = np.array([direction[0] ** 2, direction[1] ** 2, 2.0 * direction.prod()])
        assert curvature @ fabric_bending(fabric) @ curvature == pytest.approx(1.3**2 * stiffness)


def test_the_tension_at_the_rims_is_that_of_rods_midway() -> None:
    """A net that is cut midway between its rods has the Gaussian modulus `-N d^2/24`."""
    design = net()
    sheet = MotifSheet.of(design, layout(design), net_law(design))
    assert sheet.rims.moment_mm2 == pytest.approx(4 * [100.0 / 24.0])
    tension = np.array([[2.0, 2.0, 0.0]])
    assert sheet.rims.gaussian(tension, np.array([[3.0, -4.0]])) == pytest.approx([-2.0 * 100.0 / 24.0])


def test_the_sheet_weighs_what_is_printed() -> None:
    design = net(GRADED, gravity={"on": True}, fabric={"modulus_mpa": 0.7})
    plan = layout(design)
    sheet = MotifSheet.of(design, plan, net_law(design))
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


ROUND = {"circle_mm": {"centre": [0, 0], "radius": 9}}


def lines(width: float, **hole: object) -> Design:
    return Design.from_dict(
        {
            "rods": {"motif": [{"line_mm": [(0, 0), (5, 0)]}]},
            "lattice": {"kind": "square", "spacing_mm": 5.0},
            "border": {"rectangle_mm": (40, width), "holes": [hole] if hole else []},
        }
    )


def test_a_side_of_a_hole_pulls_as_a_side_of_the_outline_does() -> None:
    design = lines(38.0, polygon_mm=[[-8, -9], [8, -9], [8, 9], [-8, 9]])
    moment = rims_of(design, layout(design), 2.5).moment_mm2
    # rods are 4 mm from the outer sides and 1 mm from those of the hole; others end at the sides across
    assert moment[[0, 2]] == pytest.approx(4.79, abs=0.01) and not moment[[1, 3]].any()
    upper_and_lower = moment[4:][np.abs(moment[4:]) > 0.0]
    assert upper_and_lower == pytest.approx(0.5 * 1.0 - 25.0 / 12.0) and len(upper_and_lower) == 2


def test_fabric_around_a_hole_is_bare() -> None:
    border = {"rectangle_mm": (60.0, 60.0), "holes": [ROUND], "tip_margin_mm": 6.0}
    design = net(border=border)
    plan = layout(design)
    sheet = MotifSheet.of(design, plan, net_law(design))
    assert sheet.table.weights.sum() == pytest.approx(plan.area_mm2)
    away = np.linalg.norm(sheet.table.points, axis=-1)
    assert sheet.bare[away < 11.0].max() > 0.5 and sheet.bare[(away > 18.0) & (away < 22.0)].max() < 0.1


@pytest.mark.slow
def test_the_shape_is_certified_and_has_the_hole_where_its_pins_are() -> None:
    pins = [{"holes": [0], "scale": 0.85, "offset_mm": [0.0, 0.0, 4.0]}, {"where": "border", "scale": 0.85}]
    design = net(border={"rectangle_mm": (40.0, 40.0), "holes": [ROUND]}, pins=pins)
    preview = Preview(design, net_law(design))
    shape = preview.shape()
    rim = np.linalg.norm(shape.printed, axis=1) < 9.0 + 1e-6
    held = np.column_stack([0.85 * shape.printed[rim], np.full(rim.sum(), 4.0)])
    assert rim.sum() > 8 and shape.positions[rim] == pytest.approx(held, abs=0.05)
    assert preview.equilibrium.is_minimum and shape.summary["expected_rms_percent"] > 0.0
    with pytest.raises(ValueError, match="off the sheet"):
        shape.at(np.array([[0.0, 0.0]]))
    wider = net(border={"rectangle_mm": (40.0, 40.0), "holes": [{"circle_mm": {"centre": [0, 0], "radius": 8.5}}]})
    assert not preview.state.sheet.is_same_print(wider, layout(wider))
    assert len(preview.update(wider).printed) > 0


def test_a_hole_within_a_cell_has_no_rim_of_its_own_and_a_warning_if_it_cuts_rods() -> None:
    at_crossing, in_mesh = ({"circle_mm": {"centre": [x, x], "radius": 3}} for x in (5, 0))
    design = net(border={"rectangle_mm": (40.0, 40.0), "holes": [in_mesh, at_crossing]})
    plan = layout(design)
    (warning,) = MotifSheet.of(design, plan, net_law(design)).doubts()
    assert small_holes(plan) == [0, 1] and warning.startswith("hole 1 is smaller than a cell")
    whole = net()
    assert rims_of(design, plan, 5.0).moment_mm2 == pytest.approx(rims_of(whole, layout(whole), 5.0).moment_mm2)
    wide = layout(net(border={"rectangle_mm": (40.0, 40.0), "holes": [ROUND]}))
    assert not small_holes(wide) and len(rims_of(design, wide, 5.0).moment_mm2) == 4 + len(wide.holes[0])


def test_many_short_sides_have_the_moment_of_a_long_one_in_the_mean() -> None:
    x = np.linspace(-13.0, 13.0, 27)
    side = np.column_stack([x[:-1], np.full(26, -13.0)])
    turns = [np.array([[0, 1], [-1, 0]]) if k % 2 else np.eye(2) for k in range(4)]
    square = np.concatenate([(1 if k < 2 else -1) * side @ turn for k, turn in enumerate(turns)])
    moments = []
    for corners in (square[::26], square):
        design = net(border={"rectangle_mm": (60.0, 60.0), "holes": [{"polygon_mm": corners.tolist()}]})
        moments.append(rims_of(design, layout(design), 5.0).moment_mm2[4:])
    long, short = moments
    assert len(long) == 4 and len(short) == 104
    assert short.mean() == pytest.approx(long.mean(), rel=0.1)
    assert np.abs(short - np.roll(short, 26)).max() < 1e-6
