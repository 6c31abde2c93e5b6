"""The preview of a design: signs, pins, edits, bumps, other forms, parts of the model, and what its summary says."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import asterism
from asterism.equilibrium.errors import Error
from asterism.exact.simulation import exact_shape
from asterism.homogenize.errors import LawError, UnreadableLaw
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.homogenize.law.star_law import QUANTITY_NAMES
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import layout
from asterism.previews.fields.sheet_fields import PARTS, without
from asterism.previews.fields.star_values import MAX_SIXFOLD_SHARE, star_values
from asterism.previews.law_choice import law_of
from asterism.previews.session import Preview
from asterism.previews.sheet import BUMP_TURN_RAD, Arms
from asterism.results.words import PlacedWarning
from tests.asterism.previews.designs import edited
from tests.asterism.previews.laws import SPACING, plain_law, with_values

design = partial(edited, "tube")

TUBE = gallery.load("tube")
FALLS = {"fabric": {"modulus_mpa": 7.0}, "gravity": {"on": True}, "pins": []}
CURLY = design(stars={"thickness_mm": 0.25}, mesh={"edge_mm": 4.0})


@pytest.fixture(scope="module")
def curly() -> Preview:
    return Preview(CURLY, plain_law())


def test_a_free_sheet_rolls_with_the_plastic_outside(curly: Preview) -> None:
    assert curly.equilibrium.is_minimum
    centre = curly.at(np.zeros((1, 2)))
    kappa = curly.sheet.values.value["kappa"][0]
    # positive mean curvature is convex on the plastic side; of a tube it is half of the curvature around it, and the
    # bare rim holds a small sheet open by a part of that
    assert 0.7 < centre.mean_curvature[0] / (kappa / 2) < 1.0
    assert abs(centre.gaussian_curvature[0]) < 0.02 * kappa**2
    shape = curly.shape()
    assert shape.at(layout(CURLY).outline).shape == (6, 3)
    assert shape.rod_fields["thickness_mm"] == pytest.approx(np.full(len(shape.rod_edges), 0.25))
    assert shape.summary["law_in_range"] and not shape.summary["stars_tight"]
    assert shape.summary["roll_axis_deg"] == pytest.approx(
        min(shape.summary["equivalent_axes_deg"], key=lambda a: abs(a - shape.summary["roll_axis_deg"]))
    )
    # tubes of three-armed stars roll about axes at right angles to an arm, and by symmetry about three of them
    axes = np.array(shape.summary["equivalent_axes_deg"])
    assert np.abs((axes - 30.0 + 30.0) % 60.0 - 30.0).max() < 2.0
    assert {*np.rint((axes - 30.0) / 60.0)} == {0.0, 1.0, 2.0}


def test_bumps_are_as_high_as_the_law_says(curly: Preview, monkeypatch: pytest.MonkeyPatch) -> None:
    tips = len(curly.sheet.layout.arm_tip)
    monkeypatch.setattr(Arms, "moves", lambda *_: np.zeros((tips, 2)))
    shape = curly.shape()
    bump = shape.point_fields["bump_mm"]
    heights = np.einsum("vi,vi->v", bump, shape.point_fields["normal"])
    wave = curly.law.waves(np.zeros((1, 2)))[0, 0]
    flat, more = curly.sheet.values.corrugation[0, :, 0]
    inner = shape.star_vertices[:7]
    curvature = 2.0 * shape.point_fields["mean_curvature_per_mm"][inner]
    kappa, turn = curly.sheet.values.value["kappa"][0], SPACING / BUMP_TURN_RAD
    way = kappa * np.tanh(curvature * turn) / np.tanh(kappa * turn)
    assert heights[inner] == pytest.approx((flat + more * way) * wave, rel=0.02)
    # off the bumps the surface is the shell's
    smooth = curly.at(shape.printed).smooth
    turned = shape.positions - bump
    assert np.linalg.norm(turned[0] - turned[100]) == pytest.approx(np.linalg.norm(smooth[0] - smooth[100]))


@pytest.mark.slow
def test_later_pins_take_hold_and_softness_is_known_after_edits_too() -> None:
    pins = [{"edges": [0]}, {"points_mm": [[0.0, -40.0]], "target_mm": [[0.0, -30.0, 5.0]], "step": 1}]
    one, other = (
        design(stars={"thickness_mm": t}, pins=pins, mesh={"edge_mm": 4.0}, border={"rings": 2}) for t in (0.3, 0.303)
    )
    preview, fresh = Preview(one, plain_law()), Preview(other, plain_law())
    assert preview.equilibrium.guess == "pins take hold" and preview.equilibrium.is_minimum
    assert preview.at([0.0, -40.0]).smooth[0] == pytest.approx([0.0, -30.0, 5.0], abs=1e-9)
    before = preview.shape().summary
    list(preview.edit(other))
    after, new = preview.shape().summary, fresh.shape().summary
    assert after["energy_n_mm"] == pytest.approx(new["energy_n_mm"], rel=1e-6)  # one form
    assert after["soft_modes_n_mm3"] == pytest.approx(new["soft_modes_n_mm3"], rel=1e-4)
    assert after["soft_modes_n_mm3"] != pytest.approx(before["soft_modes_n_mm3"], rel=1e-4)
    assert after["warnings"] == new["warnings"]


def test_an_edit_of_the_outline_starts_anew_and_a_refused_one_changes_nothing() -> None:
    preview = Preview(CURLY, plain_law())
    before = preview.equilibrium.x.copy()
    with pytest.raises(TypeError, match="a Design is needed"):
        preview.edit("tube.toml")  # type: ignore[arg-type]
    refused = (
        ({"fabric": {"thickness_mm": 0.5}}, r"fabric\.thickness_mm"),
        ({"pins": [{"edges": [0]}, {"edges": [1], "scale": 0.5}]}, "pins"),  # found only when the new sheet is held
        (FALLS, r"gravity\.on"),
    )
    for sections, words in refused:
        with pytest.raises(Error, match=words):
            list(preview.edit(design(**sections)))
        assert preview.design is CURLY and (preview.equilibrium.x == before).all()
    assert preview.shape().summary["design"] == CURLY.to_dict()
    smaller = design(border={"rings": 2})
    assert [stage.name for stage in preview.edit(smaller)] == ["equilibrium"]
    assert len(preview.sheet.layout.centres) == 19


@pytest.mark.slow
def test_a_dome_can_be_flipped_and_a_snapshot_restores_its_form() -> None:
    preview = Preview(gallery.load("dome"), plain_law())
    up, snapshot = preview.at([0.0, 0.0]).smooth[0, 2], preview.snapshot()
    for back in (preview.flip, lambda: preview.restore(snapshot)):
        preview.flip()
        assert preview.equilibrium.is_minimum and preview.at([0.0, 0.0]).smooth[0, 2] < -1.0 < 1.0 < up
        back()
        assert preview.at([0.0, 0.0]).smooth[0, 2] == pytest.approx(up, rel=1e-6)


@pytest.mark.slow
def test_a_sheet_without_another_side_stays_and_says_so() -> None:
    """The stars of a held bell keep it up."""
    bell = gallery.load("bell")
    preview = Preview(bell)
    before = preview.equilibrium
    assert preview.flip() == "down" and preview.equilibrium is before and preview.state.side == "auto"
    assert not any("edges" in line for line in preview.shape().summary["warnings"])
    *_, last = preview.edit(bell)  # its factorisation goes with it
    assert last.name == "equilibrium" and preview.equilibrium.iterations <= 1
    asked = Preview(bell, side="up").shape().summary
    assert asked["is_minimum"] and asked["energy_n_mm"] == pytest.approx(before.energy, rel=1e-6)
    (line,) = [line for line in asked["warnings"] if "edges" in line]
    assert "go down" in line and "edges up" in line


@pytest.mark.slow
def test_where_pins_leave_the_height_open_the_lowest_stands_at_zero() -> None:
    """Of new previews, edits and the exact model alike; their shapes can be laid on each other as they are."""
    sections = {"pins": [{"where": "corners", "scale": 0.74, "slide": "z"}], "border": {"rings": 2}}
    one, other = (design(stars={"length_mm": size}, mesh={"edge_mm": 4.0}, **sections) for size in (8.0, 8.4))
    preview = Preview(one)
    for stage in preview.edit(other):
        held = preview.at(preview.sheet.layout.outline, stage.x).smooth[:, 2]
        assert held.min() == pytest.approx(0.0, abs=1e-9) and np.ptp(held) < 20.0
    fresh, exact = Preview(other).shape(), exact_shape(other)
    assert preview.shape().positions == pytest.approx(fresh.positions, abs=1e-3 * np.ptp(fresh.positions))
    assert exact.at(preview.sheet.layout.outline)[:, 2].min() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("pin", [{"edges": [0, 1, 2, 3, 4, 5]}, {"points_mm": [[20.0, 0.0], [-10.0, 17.0]]}])
def test_bumps_leave_what_is_held_in_its_place(pin: dict[str, Any]) -> None:
    stars = {"length_mm": 8.0, "thickness_mm": 0.3}
    preview = Preview(design(stars=stars, border={"rings": 1}, pins=[pin | {"scale": 0.78}]))
    border = preview.sheet.layout.outline
    held = np.array(pin.get("points_mm") or np.concatenate([border, 0.5 * (border + np.roll(border, 1, axis=0))]))
    found = preview.at(held)
    assert found.bumpy == pytest.approx(np.column_stack([0.78 * held, np.zeros(len(held))]), abs=1e-9)
    assert np.abs(preview.at(0.7 * border).bumps[:, 2]).max() > 0.1
    assert preview.shape().held


@pytest.mark.slow
@pytest.mark.parametrize(("slide", "held"), [("z", [0, 1]), ("plane", [2])])
def test_pins_hold_what_they_say(slide: str, held: list[int]) -> None:
    points = [[-50.0, 0.0], [50.0, 0.0], [0.0, 60.0]]
    preview = Preview(design(pins=[{"points_mm": points, "scale": 0.8, "slide": slide}]), plain_law())
    assert preview.equilibrium.is_minimum
    target = np.column_stack([0.8 * np.array(points), np.zeros(3)])
    assert preview.at(np.array(points)).smooth[:, held] == pytest.approx(target[:, held], abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("turn", [("x", 90.0), ("y", 150.0)])
def test_pins_that_are_turned_in_space_turn_the_shape(turn: tuple[str, float]) -> None:
    """Stood upright or laid on its back: without weight the energy is the same."""
    corners = layout(design()).outline[::2]
    places = np.column_stack([0.8 * corners, np.zeros(3)])
    turned = places @ Rotation.from_euler(*turn, degrees=True).as_matrix().T
    one, other = (
        Preview(design(pins=[{"corners": [0, 2, 4], "target_mm": at.tolist()}]), plain_law()).equilibrium
        for at in (places, turned)
    )
    assert one.is_minimum and other.is_minimum and other.energy == pytest.approx(one.energy, rel=1e-6)


@pytest.mark.slow
def test_what_nothing_holds_yet_does_not_fall() -> None:
    """Corners that slide on the ground from the beginning, and after the release."""
    energies = []
    for step in (0, 1):
        pins = [{"where": "corners", "slide": "plane", "step": step}]
        heavy = design(fabric={"modulus_mpa": 1.0}, gravity={"on": True}, pins=pins, stars={"length_mm": 8.0})
        found = Preview(heavy, plain_law()).equilibrium
        assert found.is_minimum
        energies.append(found.energy)
    assert energies[1] == pytest.approx(energies[0], rel=1e-6)


@pytest.mark.slow
def test_a_sheet_that_swings_keeps_its_form() -> None:
    """Hung from a needle in its middle."""
    hung = partial(design, border={"rings": 2}, pins=[{"points_mm": [[0.0, 0.0]]}], stars={"length_mm": 8.0})
    sheets = (hung(fabric={"modulus_mpa": 7.0}, gravity={"on": on}) for on in (False, True))
    light, heavy = (asterism.preview(each, plain_law()).summary for each in sheets)
    assert light["is_minimum"] and heavy["is_minimum"]
    assert not any("form" in line for line in heavy["warnings"])


@pytest.mark.parametrize("border", [{"rings": 0}, {"rectangle_mm": [90.0, 60.0], "rings": None}])
def test_a_sheet_weighs_what_is_printed(border: dict[str, Any]) -> None:
    """Where cells reach over the outline too."""
    gravity = {"on": True, "direction": [0.0, 0.0, -1.0]}
    pins = [{"where": "corners"}]
    heavy = design(gravity=gravity, fabric={"modulus_mpa": 1.0}, stars={"length_mm": 8.0}, border=border, pins=pins)
    preview = Preview(heavy, plain_law())
    sheet, plan = preview.sheet, preview.sheet.layout
    # lifting all by a millimetre takes the whole weight
    lifted = np.zeros((6, 3))
    lifted[0, 2] = 1.0
    pulled = sheet.space.interpolate(lambda points: np.repeat(lifted[None], len(points), axis=0))[:, 2]
    pulled = pulled @ sheet.loads()[:, 2]
    volume = (plan.arm_length * plan.arm_thickness.mean(axis=1) * plan.arm_width.mean(axis=1)).sum()
    plastic = 1e-9 * heavy.plastic.density_kg_m3 * volume
    fabric = heavy.fabric.printed_mass * polygon_area(plan.outline)
    assert pulled == pytest.approx(-9.81 * (plastic + fabric), rel=2e-3)


def test_warnings_name_stars_by_the_numbers_of_the_design() -> None:
    """And many stars are one warning."""
    odd = [{"star": 0, "remove": True}, *({"star": star, "thickness_mm": 0.9} for star in range(5, 9))]
    shape = Preview(design(stars={"override": odd}), plain_law()).shape()
    outside = shape.summary["stars_outside_law"]
    assert len(outside) == 4 and not shape.summary["law_in_range"] and "thickness_mm = 0.9 is outside" in outside[0]
    (line,) = [line for line in shape.summary["warnings"] if "outside the law" in line]
    assert line.startswith("4 of ") and "such as star 5 at [" in line
    assert isinstance(line, PlacedWarning) and line.stars == (5, 6, 7, 8) and json.loads(json.dumps(line)) == line
    assert shape.star.max() == len(shape.star_vertices) and 0 not in shape.star[shape.star_vertices]


def test_neighbours_that_no_sheet_can_join_are_refused_with_star_and_value() -> None:
    """Fabric that is stretched threefold, and stars that let it contract by that or not at all."""
    law = plain_law(3.0)
    table = law.tables[0]
    nodes = table.node_values.copy()
    nodes[7:, ..., QUANTITY_NAMES.index("lam_n")] = 0.99
    law = replace(law, tables=(with_values(table, nodes),))
    short = [{"star": star, "length_mm": 1.0} for star in range(1, 37)]
    same = design(fabric={"stretch": 3.0}, stars={"length_mm": 1.0})
    torn = design(fabric={"stretch": 3.0}, stars={"length_mm": 10.0, "override": short})
    refused = r"star \d+ at \[.*\]: lam_n = [\d.]+ is too far from its neighbours': rest metric at .* positive definite"
    with pytest.raises(LawError, match=refused):
        Preview(torn, law)
    preview = Preview(same, law)
    before = preview.equilibrium.x.copy()
    with pytest.raises(LawError, match=refused):
        list(preview.edit(torn))
    assert preview.design is same and (preview.equilibrium.x == before).all()
    assert [stage.name for stage in preview.edit(same)] == ["linear", "equilibrium"]


def test_weight_that_nothing_carries_is_refused() -> None:
    with pytest.raises(DesignError, match=r"gravity.on = True: needs \[\[pins\]\]"):
        Preview(design(**FALLS), plain_law())


def test_bumps_flatten_where_the_sheet_is_held_apart():
    def bump(scale: float) -> float:
        held = design(border={"rings": 1}, pins=[{"where": "border", "scale": scale}])
        return float(np.abs(Preview(held).shape().point_fields["bump_mm"][:, 2]).max())

    # the stars' flat cells are 0.84 of the print
    assert bump(1.0) < 0.25 * bump(0.84)
    assert 0.3 < bump(0.87) / bump(0.84) < 1.0


def test_who_stops_after_the_linear_response_has_no_equilibrium() -> None:
    preview = Preview(CURLY, plain_law())
    thicker = design(stars={"thickness_mm": 0.27}, mesh={"edge_mm": 4.0})
    linear = next(preview.edit(thicker))
    summary = preview.shape().summary
    assert not summary["is_minimum"] and not summary["converged"]
    assert summary["starts"] == summary["other_forms"] == []  # those of the design before say nothing of this one
    assert summary["energy_n_mm"] == pytest.approx(preview.shell.energy(linear.x), rel=1e-9)
    # the next edit goes on from there, and one that changes nothing leaves an equilibrium
    list(preview.edit(CURLY))
    assert preview.equilibrium.is_minimum
    assert next(preview.edit(CURLY)).name == "linear" and preview.equilibrium.is_minimum
    assert preview.shape().height_mm == pytest.approx(Preview(CURLY, plain_law()).shape().height_mm, rel=1e-3)


HINGED = [
    [70.17, 19.81], [66.19, 19.78], [62.44, 34.1], [62.63, 39.91], [55.83, 43.1], [45.14, 52.76], [32.78, 39.69],
    [-0.45, 47.27], [-13.79, 63.1], [-30.51, 19.68], [-43.22, 21.68], [-51.24, 14.77], [-34.68, 4.71], [-41.08, 3.03],
    [-57.4, -9.15], [-41.96, -10.79], [-31.6, -45.17], [-28.06, -43.96], [-15.65, -42.71], [-6.57, -37.37],
    [-1.86, -31.22], [2.57, -29.85], [28.27, -46.63], [28.57, -46.37], [39.16, -35.39], [48.6, -42.06], [43.86, -27.15],
    [58.42, -37.97], [51.46, -29.42], [62.69, -13.29],
]  # fmt: skip


@pytest.mark.slow
def test_flat_triangles_do_not_hide_what_holds_the_sheet() -> None:
    """One straight edge is held, on a mesh with needles: the sheet turns about it, and its soft modes do not know."""
    stars, pins = {"length_mm": 6.6, "thickness_mm": 0.5}, [{"edges": [0], "scale": 0.82}]
    preview = Preview(Design.from_dict({"stars": stars, "border": {"polygon_mm": HINGED}, "pins": pins}))
    x = preview.equilibrium.x
    assert preview.equilibrium.is_minimum and len(preview.shell.fixed_points) == 2
    assert preview.shell.rigid_modes(x).shape[1] == 1
    preview.shape()
    assert preview.equilibrium.soft_modes[0] > 1e-3 * preview.equilibrium.soft_modes[2]


@pytest.mark.slow
def test_only_ratios_of_stiffness_count() -> None:
    """Without weight the unit of force is free, at the bare rim too."""
    heights, energies = [], []
    for modulus in (1e-3, 1e4):
        preview = Preview(design(fabric={"modulus_mpa": modulus}, mesh={"edge_mm": 4.0}))
        heights.append(preview.shape().height_mm)
        energies.append(preview.equilibrium.energy / modulus)
    assert heights[1] == pytest.approx(heights[0], rel=1e-6) and energies[1] == pytest.approx(energies[0], rel=1e-9)


@pytest.mark.slow
def test_where_pins_stand_does_not_matter_to_a_heavy_sheet() -> None:
    """The work of weight is counted from the pins: what is compared, and the error to be expected, are the same."""
    found = []
    for level in (0.0, -2000.0):
        pins = [{"corners": [0, 2, 4], "scale": 0.7, "offset_mm": [0.0, 0.0, level]}]
        heavy = design(gravity={"on": True}, fabric={"modulus_mpa": 1.0}, pins=pins, mesh={"edge_mm": 4.0})
        found.append(Preview(heavy).shape().summary)
    for key in ("energy_n_mm", "height_mm", "expected_rms_percent", "expected_height_percent"):
        np.testing.assert_allclose([s[key] for s in found], found[0][key], rtol=1e-5)
    assert len({tuple(start["name"] for start in s["starts"]) for s in found}) == 1


@pytest.mark.parametrize("points", [[], 3.0, [[0.0, 0.0, 0.0]], [[np.nan, 0.0]], [[900.0, 0.0]]])
def test_places_that_are_none_are_refused(points: Any, curly: Preview) -> None:
    with pytest.raises(ValueError, match=r"points must be finite pairs of mm|outside the sheet"):
        curly.at(points)
    with pytest.raises(ValueError, match="x must be a stage's, shape"):
        curly.at([0.0, 0.0], np.zeros((3, 3)))


@pytest.mark.slow
def test_a_roll_that_passes_through_itself_says_so() -> None:
    """`fig8-l-increasing` rolls up further than round; `tube` does not."""
    through, open_ = (Preview(gallery.load(name)).shape().summary for name in ("fig8-l-increasing", "tube"))
    assert open_["self_intersections"] == 0 and not any("passes through" in line for line in open_["warnings"])
    (line,) = [line for line in through["warnings"] if "passes through itself" in line]
    assert f"({through['self_intersections']} crossings)" in line and "--contact" in line


@pytest.mark.slow
@pytest.mark.parametrize("pins", [{"corners": [0]}, {"corners": [0, 2, 4], "slide": "plane"}])
def test_pins_that_a_free_sheet_meets_anyway_cost_nothing(pins: dict[str, object]) -> None:
    """One held point, or three that slide in their plane: there is always a rigid motion to them."""
    data = {"stars": {"length_mm": 4.0, "thickness_mm": 0.6}, "border": {"rings": 3}}
    free, held = (Preview(Design.from_dict(data | more)).equilibrium for more in ({}, {"pins": [pins]}))
    assert held.is_minimum and held.energy == pytest.approx(free.energy, rel=1e-6)


def test_a_sixfold_term_that_outweighs_the_bending_is_bounded_and_told() -> None:
    law = plain_law()
    nodes = law.tables[0].node_values.copy()
    nodes[..., QUANTITY_NAMES.index("c3")] *= 1e4
    wild = replace(law, tables=(with_values(law.tables[0], nodes),))
    plan = layout(TUBE)
    values = star_values(TUBE, plan, wild)
    assert values.strongly_anisotropic == tuple(plan.star_number.tolist())
    assert not star_values(TUBE, plan, law).strongly_anisotropic
    taken = np.abs(values.value["c3"] * values.value["kappa"])
    assert taken[:-1] == pytest.approx(MAX_SIXFOLD_SHARE * values.value["bending"][:-1])
    summary = asterism.preview(TUBE, law=wild).summary
    assert summary["expected_rms_percent"] is None and summary["expected_height_percent"] is None
    assert "37 of 37 stars curl far more in some directions" in " ".join(summary["warnings"])
    assert summary["energy_n_mm"] > 0.0


@pytest.mark.slow
def test_pins_that_leave_no_length_for_a_rise_are_told() -> None:
    """Who forgets the scale gets a flat sheet, and a scale with which it rises."""

    def held(scale: float) -> tuple[float, list[str]]:
        found = Preview(design(stars={"length_mm": 9.0}, pins=[{"where": "border", "scale": scale}])).shape()
        return found.height_mm, [line for line in found.summary["warnings"] if "nearly flat" in line]

    height, told = held(1.0)
    (scale,) = re.findall(r"a scale of about (\S+) ", *told)
    higher, silent = held(0.98 * float(scale))
    assert not silent and higher > 4.0 * height


@pytest.mark.slow
def test_a_tube_hangs_by_its_corner() -> None:
    """From flat and level to upright is far: it is swung there as it is bent."""
    hung = design(stars={"thickness_mm": 0.45}, pins=[{"corners": [0]}], gravity={"on": True})
    found = Preview(hung).equilibrium
    assert found.is_minimum and found.iterations < 60


@pytest.mark.slow
def test_nothing_is_expected_of_stars_that_are_sent_down() -> None:
    """The law's are all up. A single one of many is warned of only."""
    pins = [{"where": "border", "scale": 0.9}]
    few, many = (
        design(pins=pins, mesh={"edge_mm": 5.0}, stars={"override": [{"star": k, "branch": "down"} for k in range(n)]})
        for n in (1, 5)
    )
    one, five = (Preview(each, plain_law()).shape().summary for each in (few, many))
    assert one["stars"] == 37 and one["expected_rms_percent"] is not None
    assert five["expected_rms_percent"] is None and five["expected_height_percent"] is None
    assert any(line.startswith("5 stars") and "inverted" in line for line in five["warnings"])


def forms(thickness: object) -> Design:
    stars = {"length_mm": 9.0, "thickness_mm": thickness, "width_mm": 1.2}
    return Design.from_dict({"name": "forms", "stars": stars, "border": {"rings": 3}})


@pytest.mark.slow
def test_a_sheet_that_changes_along_a_line_has_several_forms() -> None:
    skew = {"profile": "linear", "from": 0.35, "to": 0.2, "start_mm": [-34.0, -10.0], "end_mm": [34.0, 10.0]}
    preview = Preview(forms(skew), plain_law())
    summary = preview.shape().summary
    others = summary["other_forms"]
    assert others
    for other in others:
        assert other["distance_percent"] > 2.0
        more = other["gap"] * preview.equilibrium.absolute_energy
        assert other["energy_n_mm"] == pytest.approx(summary["energy_n_mm"] + more)
        assert any(trial["energy"] == other["energy_n_mm"] for trial in summary["starts"])
    shown = [text for label, text in summary.table().items() if label.startswith("other form")]
    assert len(shown) == len(others) and all(text.endswith("more energy") for text in shown)


def test_forms_that_symmetry_makes_equal_are_one() -> None:
    preview = Preview(forms(0.3), plain_law())
    assert len(preview.sheet.symmetries) == 6
    assert preview.shape().summary["other_forms"] == []


# parts that act on a free sheet; others need supports, holes or stars of other kinds
ALWAYS = ["rosette metric", "Gaussian curvature", "roll axis", "arms into free rims", "bumps"]
ALWAYS += ["arms that keep their length"]
FREE = {
    "stars": {"length_mm": {"profile": "radial", "from": 6.0, "to": 12.0, "over_mm": 40.0}, "thickness_mm": 0.35},
    "border": {"rings": 2},
    "mesh": {"edge_mm": 4.0},
}


@cache
def whole() -> Preview:
    return Preview(Design.from_dict(FREE), plain_law())


@pytest.mark.parametrize("part", ALWAYS)
def test_a_part_that_is_turned_off_changes_a_free_sheet(part: str) -> None:
    on, off = whole(), Preview(Design.from_dict(FREE), plain_law(), model=without(part))
    points = np.vstack([on.sheet.layout.arm_tip, 0.99 * on.sheet.layout.outline])
    assert np.abs(on.at(points).bumpy - off.at(points).bumpy).max() > 1e-6


def test_parts_are_turned_off_by_their_names() -> None:
    assert [without(part).off for part in PARTS] == [(part,) for part in PARTS]
    with pytest.raises(KeyError):
        without("roll axes")


def test_an_edit_keeps_the_model() -> None:
    model = without("arms into free rims")
    preview = Preview(Design.from_dict(FREE), plain_law(), model=model)
    preview.update(Design.from_dict(FREE | {"border": {"rings": 1}}))
    assert preview.sheet.model is model


def test_a_file_is_read_again_only_after_a_change(tmp_path: Path) -> None:
    file = tmp_path / "own.npz"
    design = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "material": {"law": str(file)}})
    with pytest.raises(UnreadableLaw, match=r"own\.npz: cannot be read: No such file"):
        law_of(design)
    file.write_bytes(PAPER_LAW.read_bytes())
    law = law_of(design)
    assert law_of(design) is law
    file.write_bytes(b"damaged")
    with pytest.raises(LawError, match=r"own\.npz: is not a law, or damaged"):
        law_of(design)
    file.write_bytes(PAPER_LAW.read_bytes())
    assert law_of(design) is not law
