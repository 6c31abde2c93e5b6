"""Sheets of a motif: fields of the law by place, bare fabric, weight, rims; their previews, kept for edits."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

from asterism.discrete.energies.membrane import Membrane
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import Fabric
from asterism.pattern.layout.build import layout
from asterism.previews import session as preview_session
from asterism.previews.motif_sheet import (
    MotifSheet,
    bare_fabric,
    fabric_bending,
    fabric_tension,
    reach_mm,
    rims_of,
    small_holes,
)
from asterism.previews.session import Preview, preview
from tests.asterism.previews.laws import plain_law
from tests.asterism.previews.motifs.nets import CROSS, GRADED, net, net_law


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


def test_a_net_that_is_cut_midway_between_its_rods_has_a_gaussian_modulus_and_no_bare_rim() -> None:
    """The modulus is `-N d^2/24`: the tension at the rims is that of rods half a mesh away."""
    design = net()
    sheet = MotifSheet.of(design, layout(design), net_law(design))
    assert reach_mm(design) == 5.0 and not sheet.bare.any()
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


PINS = [{"where": "corners"}]


def test_the_plastic_is_outside_and_the_shape_is_certified() -> None:
    design = net()
    shape = Preview(design, net_law(design), triangles=16).shape()
    assert shape.summary.is_minimum and not shape.summary["warnings"]
    assert shape.point_fields["mean_curvature_per_mm"].min() > 0.0
    assert shape.summary["stars"] == 0 and shape.summary["rods_total"] == len(shape.rods)
    assert shape.summary["contraction"] < 1.0


@pytest.mark.slow
def test_a_sheet_that_its_rims_collapse_is_refused_early_and_a_thicker_one_is_not() -> None:
    design = Design.from_dict(gallery.load("diamond-auxetic").to_dict() | {"mesh": {"edge_mm": 2.0}})
    session = Preview(design)
    assert [trial.name for trial in session.equilibrium.trials] == ["arc"]  # not in load steps, which take as long
    (first, *_) = session.shape().summary["warnings"]
    assert first.startswith("not an equilibrium: at wide rims the tension") and first.endswith("asterism simulate")
    thicker = design.to_dict()
    thicker["rods"]["thickness_mm"] = 0.4
    assert Preview(Design.from_dict(thicker)).shape().summary.is_minimum


@pytest.mark.slow
def test_rods_lie_along_the_triangles_with_their_sizes() -> None:
    design = net(GRADED)
    shape = Preview(design, net_law(design)).shape()
    edges = np.sort(shape.rod_edges, axis=1)
    sides = np.sort(shape.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert set(map(tuple, edges)) <= set(map(tuple, sides))
    middle = shape.printed[shape.rod_edges].mean(axis=1)[:, 0]
    assert shape.rod_fields["thickness_mm"] == pytest.approx(np.clip(0.45 + 0.0025 * middle, 0.4, 0.5), abs=1e-3)


@pytest.mark.slow
def test_sizes_are_edited_without_new_cells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ASTERISM_CELLS", str(tmp_path))
    said: list[str] = []
    design = net()
    law = net_law(design)
    wide = net_law(net(0.41), law, said.append)
    assert len(said) == len(wide.plan.tasks()) - 1
    session = Preview(design, wide, triangles=16)
    stages = [stage.name for stage in session.edit(net(0.44))]
    assert stages == ["linear", "equilibrium"]
    again = Preview(net(0.44), wide, triangles=16)
    assert session.equilibrium.energy == pytest.approx(again.equilibrium.energy, rel=1e-8)
    assert net_law(net(0.44), wide, said.append) is wide and len(said) == len(wide.plan.tasks()) - 1


@pytest.mark.slow
def test_one_session_takes_another_motif_and_stars_after_a_motif(monkeypatch: pytest.MonkeyPatch) -> None:
    def serving(design: Design, plan: object, known: Any, say: Any) -> Any:
        return plain_law() if design.rods is None else net_law(design, known, say)

    monkeypatch.setattr(preview_session, "serving_law", serving)
    session = Preview(net())
    law = session.law
    session.update(net(pins=PINS))
    assert session.law is law
    assert session.update(net(rods={"motif": [CROSS[0]], "thickness_mm": 0.4})).summary.is_minimum
    assert session.law is not law
    session.update(Design.from_dict({"border": {"rings": 1}, "stars": {"length_mm": 9.0, "thickness_mm": 0.3}}))
    assert len(session.sheet.values.sizes) == 7
    session.update(net())
    assert session.sheet.layout.drawn is not None


@pytest.mark.parametrize(
    ("sections", "named"),
    [
        ({"rods": {"draw": [{"line_mm": [(-15, 0), (15, 0)]}]}}, "do not repeat have no law; .*asterism simulate"),
        ({"rods": {"motif": CROSS, "draw": [{"line_mm": [(-15, 1), (15, 1)]}]}}, "rods.draw: must be left out"),
        ({"fabric": {"bending": "none"}}, "fabric.bending"),
    ],
)
def test_patterns_without_a_law_are_refused_in_one_line(sections: dict[str, Any], named: str) -> None:
    with pytest.raises(DesignError, match=named) as raised:
        preview(net(**sections))
    assert "\n" not in str(raised.value)


def test_a_law_of_stars_is_no_law_of_a_motif() -> None:
    with pytest.raises(TypeError, match="load_law reads the law of a motif"):
        Preview(net(), plain_law())
