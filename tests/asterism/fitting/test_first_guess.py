"""Reach, placement and first guess."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.fitting.disk import TargetError
from asterism.fitting.first_guess import FirstGuess, flatten_target, guess_design
from asterism.fitting.flatten import TargetMap
from asterism.fitting.reach import ReachError, StarMenu
from asterism.fitting.target import TargetSurface
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import paper_law
from asterism.process.settings import FitSettings
from benchmarks.fit_targets import rectangle_mesh
from tests.asterism.fitting.surfaces import cylinder_part, spherical_cap


def cap(half_angle: float, size: float = 100.0) -> TargetSurface:
    return TargetSurface.of_triangles(*spherical_cap(half_angle, size), name="cap")


@pytest.fixture(scope="module")
def guess() -> FirstGuess:
    return guess_design(cap(35.0), paper_law())


def test_the_stretch_is_the_smallest_that_suffices(guess: FirstGuess) -> None:
    assert guess.menu.stretch == 1.35
    assert guess.reach.needed_ratio == pytest.approx(1.0994, abs=2e-3)
    assert guess.reach.available_ratio > 1.15
    assert guess_design(cap(50.0), paper_law()).menu.stretch == 1.75


def test_stars_contract_as_the_flattening_needs(guess: FirstGuess) -> None:
    plan = layout(guess.design)
    needed = np.exp(guess.target_map.interpolate(guess.target_map.log_contraction, plan.centres))
    sizes = {tuple(entry.site or ()): entry for entry in guess.design.stars.override}
    lengths = np.array([sizes[tuple(site)].length_mm for site in plan.sites.tolist()], dtype=float)
    thicknesses = np.array([sizes[tuple(site)].thickness_mm for site in plan.sites.tolist()], dtype=float)
    values = paper_law().evaluate(guess.design, lengths, thicknesses, guess.menu.kept["width_mm"]).value
    # between the natural tube and the flat sheet
    assert (needed > values["lam_n"] * 0.98).all() and (needed < values["lam"] * 1.02).all()
    radius = np.linalg.norm(plan.centres - plan.outline.mean(axis=0), axis=1)
    assert lengths[radius.argmin()] > lengths[radius.argmax()] + 1.0


def test_needles_hold_the_outline_at_its_places_on_the_target(guess: FirstGuess) -> None:
    (pins,) = guess.design.pins
    places, border = np.array(pins.target_mm), guess.target.disk.vertices[guess.target.disk.border]
    assert len(pins.corners or ()) == len(places) >= 8
    assert np.abs(guess.target.nearest(places).distance).max() < 1e-2
    rim = np.linalg.norm(border[:, :2], axis=1)
    assert np.linalg.norm(places[:, :2], axis=1) == pytest.approx(rim.mean(), rel=0.01)
    gaps = np.linalg.norm(places - np.roll(places, 1, axis=0), axis=1)
    assert gaps == pytest.approx(gaps.mean(), rel=0.05)


def test_the_needles_of_a_target_with_corners_stand_at_them() -> None:
    guess = guess_design(TargetSurface.of_formula("9*x*y/1600", 80.0), paper_law(), FitSettings(border=False))
    corners = [[x, y] for x in (-40.0, 40.0) for y in (-40.0, 40.0)]
    places = np.array(guess.design.pins[0].target_mm)[:, :2]
    for corner in corners:
        assert np.linalg.norm(places - corner, axis=1).min() < 1.0


def test_the_border_of_a_saddle_is_held_along_that_of_the_target() -> None:
    target = TargetSurface.of_formula("9*x*y/1600", 80.0)
    guess = guess_design(target, paper_law())
    (pins,) = guess.design.pins
    assert pins.where == "border"
    (held,) = layout(guess.design).pins
    outline = layout(guess.design).outline
    middles = held.places(0.5 * (outline + np.roll(outline, -1, axis=0)))
    assert np.abs(target.nearest(middles).distance).max() < 0.05
    # asked for, a dome is held in the same way; needles are as before
    assert guess_design(cap(30.0), paper_law(), FitSettings(border=True)).design.pins[0].where == "border"
    assert guess_design(target, paper_law(), FitSettings(needles=8)).design.pins[0].corners is not None


def test_numbers_of_needles_and_the_width_of_the_arms_can_be_given() -> None:
    target = cap(30.0)
    assert guess_design(target, paper_law(), FitSettings(width_mm=0.8)).menu.kept["width_mm"] == 0.8
    with pytest.raises(LawError, match=r"width_mm = 2: the law covers 0.8 to 1.6 mm"):
        guess_design(target, paper_law(), FitSettings(width_mm=2.0))
    assert len(guess_design(target, paper_law(), FitSettings(needles=7)).design.pins[0].corners or ()) == 7
    assert guess_design(target, paper_law(), FitSettings(needles=0)).design.pins == ()


@pytest.mark.slow
def test_what_is_out_of_reach_is_refused_with_numbers() -> None:
    with pytest.raises(ReachError, match=r"cap: contractions at \(.*\) mm .* ratio of 1\.84; available are 1\.\d\d at"):
        guess_design(cap(85.0), paper_law())
    with pytest.raises(ReachError, match=r"cap: has room for \d+ stars 17\.3 mm apart, at least 19 are needed: make"):
        guess_design(cap(30.0, 40.0), paper_law())
    plane, triangles = rectangle_mesh(90.0, 90.0, 41, 41)
    ridge = np.column_stack([plane, 30.0 * np.exp(-((plane[:, 0] / 8.0) ** 2))])
    with pytest.raises(
        ReachError, match=r"ridge: at \(.*\) mm the target curves by 1/\d+\.\d mm; stars .* reach 1/11\."
    ):
        guess_design(TargetSurface.of_triangles(ridge, triangles, "ridge"), paper_law())
    with pytest.raises(ForeignLaw, match=r"stretch = 1\.5"):
        guess_design(cap(30.0), paper_law(), FitSettings(stretch=1.5))
    (warning, *_) = guess_design(cap(85.0), paper_law(), FitSettings(nearest=True)).reach.warnings
    assert warning.startswith("contractions at")


def test_a_flat_target_that_overlaps_itself_is_refused() -> None:
    # a helicoid-like strip, developed, turns by more than a full turn
    turn, across = np.linspace(0.0, 9.0, 91), np.linspace(20.0, 50.0, 9)
    vertices = np.array([[r * np.cos(t), r * np.sin(t), 6.0 * t] for t in turn for r in across])
    number = np.arange(len(vertices)).reshape(91, 9)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    with pytest.raises(TargetError, match="overlaps itself when it is laid flat"):
        flatten_target(TargetSurface.of_triangles(vertices, triangles, "ramp"))


def test_curvatures_of_a_cylinder_and_a_sphere() -> None:
    for mesh, expected in (
        (cylinder_part(40.0, 1.5, 60.0), (1.0 / 40.0, 0.0)),
        (spherical_cap(40.0, 90.0), (1.0 / 70.0, 1.0 / 70.0)),
    ):
        target = TargetSurface.of_triangles(*mesh)
        flat = flatten_target(target)
        placed = TargetMap(flat, np.exp(0.25) * flat.points, 17.3)
        middle = placed.printed[flat.disk.border].mean(axis=0)
        curvatures = placed.principal_curvatures(middle[None])[0]
        assert curvatures == pytest.approx(expected, abs=1.5e-3)


def test_the_menu_agrees_with_the_law() -> None:
    menu = StarMenu.of(paper_law(), 1.35, {"width_mm": 1.2})
    assert 1.15 < menu.ratio < 1.25
    sizes = menu.sizes(np.array([0.80, 0.85]), np.array([0.02, 0.01]))
    table = paper_law().at(1.35)
    values = table(sizes[:, 0], sizes[:, 1], 1.2).value
    # the sheet bends as its stars do: it contracts as their natural tube
    assert values["lam_n"] == pytest.approx([0.80, 0.85], rel=0.01)
    assert (menu.least_thickness(sizes[:, 0]) <= sizes[:, 1] + 1e-9).all()
