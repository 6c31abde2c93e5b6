"""Sheets of a motif with holes: their rims are rims like the outer one."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.motif_sheet import MotifSheet, rims_of, small_holes
from asterism.previews.session import Preview
from tests.asterism.previews.motifs.nets import net, net_law

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
