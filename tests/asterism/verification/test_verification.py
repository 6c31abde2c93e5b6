"""Exact shapes of both starts: which counts, what is of its form, what is said of the other one and of a preview."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from asterism import Design, Shape, Verification, preview, simulate, verify
from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.newton.minimise import Iteration
from asterism.exact.simulation import exact_shape, off_branch
from asterism.pattern.geometry.planar import inside
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.reports.plots import profile_cut
from asterism.results.records.exact import ExactRecord
from asterism.shape.comparison import compare_shapes
from asterism.verification.simulate import lower_minimum
from asterism.verification.verify import (
    MAX_FORM_DISTANCE_PERCENT,
    MAX_LIKE_AXIS_DEG,
    MAX_LIKE_DISTANCE_PERCENT,
    MAX_LIKE_NORMALS_DEG,
    STAGES,
    WHOLE,
    ExactProgress,
    _same_stars_down,
    alike,
    right_shape,
    same_branch,
    verification_warnings,
)
from tests.asterism.previews.designs import edited
from tests.asterism.verification.printed import design, shape

OF = design()
PLAN = layout(OF)
EXACT = {
    "is_minimum": True, "self_intersections": 0, "stars_total": 7, "stars_down": [], "stars_off_branch": [],
    "mesh_error_percent": None, "mesh_change_percent": None, "energy_n_mm": 1.0,
}  # fmt: skip

OFF = "1 of 7 stars of the exact shape is not on the side that the design asks for: star 3"


def ended(energy: float, off: tuple[int, ...] = (), minimum: bool = True, **more: Any) -> Any:
    """An exact shape, of which only the summary counts."""
    summary = {"energy_n_mm": energy, "stars_off_branch": list(off), "is_minimum": minimum}
    return SimpleNamespace(summary=summary | more)


@pytest.mark.parametrize(
    ("release", "preview", "counts"),
    [
        (ended(10.0), ended(9.9), "preview"),
        (ended(10.0), ended(9.9, off=(3,)), "release"),
        (ended(10.0, minimum=False), ended(11.0, off=(3,)), "preview"),
        (ended(10.0), ended(10.0 - 1e-8), "release"),  # the same minimum but for rounding
        (ended(-10.0), ended(-10.1), "preview"),
    ],
)
def test_certified_ones_first_then_sides_then_energy(release: Any, preview: Any, counts: str) -> None:
    assert right_shape({"release": release, "preview": preview}) == counts


def test_starts_agree_only_on_images_of_each_other() -> None:
    """A star that is down in the middle is not one that is down at a corner; two corners are the same."""
    same, radius = symmetries(OF, PLAN), np.linalg.norm(PLAN.centres, axis=1)
    middle, corners = int(radius.argmin()), np.flatnonzero(radius > 1.0)

    def down(*stars: int) -> Any:
        return ended(1.0, stars_down=[int(star) for star in stars], stars_total=7)

    def agree(*pair: Any) -> bool:
        return _same_stars_down(*pair, PLAN, same)

    assert agree(down(), down()) and agree(down(corners[0]), down(corners[2]))
    assert not agree(down(middle), down(corners[0])) and not agree(down(), down(corners[0]))


def test_profiles_of_an_l_stay_on_the_sheet() -> None:
    """The middle of its stars is off the sheet."""
    legs = [[-60, -60], [60, -60], [60, -32], [-32, -32], [-32, 60], [-60, 60]]
    border = {"polygon_mm": legs, "star_margin_mm": 3}
    plan = layout(design(border=border))
    assert not inside(plan.centres.mean(axis=0)[None], plan.outline)[0]
    seen: list[np.ndarray] = []
    sheet = SimpleNamespace(at=seen.append)
    for direction in np.eye(2):
        profile_cut(SimpleNamespace(layout=plan, reference=sheet, other=sheet), direction)  # type: ignore[arg-type]
    assert len(seen) == 4 and all(inside(points, plan.outline).all() for points in seen)
    assert all(np.ptp(points, axis=0).max() > 25.0 for points in seen)


def compared(
    rms_percent: float = 1.0, axes: tuple[float | None, float | None] = (None, None), normals: float = 5.0
) -> Any:
    return SimpleNamespace(rms_percent=rms_percent, roll_axes_deg=axes, normals_rms_deg=normals)


@pytest.mark.parametrize(
    ("numbers", "same"),
    [
        ({}, True),
        ({"rms_percent": 1.1 * MAX_LIKE_DISTANCE_PERCENT}, False),
        ({"axes": (30.0, None)}, False),
        ({"axes": (175.0, 175.0 + 0.9 * MAX_LIKE_AXIS_DEG - 180.0)}, True),  # axes have no direction
        ({"axes": (30.0, 30.0 + 1.1 * MAX_LIKE_AXIS_DEG)}, False),
        ({"normals": 0.9 * MAX_LIKE_NORMALS_DEG}, True),
        ({"normals": 1.1 * MAX_LIKE_NORMALS_DEG}, False),
    ],
)
def test_shapes_are_alike_if_near_rolled_about_one_axis_and_facing_the_same_way(
    numbers: dict[str, Any], same: bool
) -> None:
    assert alike(compared(**numbers)) is same


def test_of_two_exact_forms_the_one_that_counts_must_be_nearer() -> None:
    near, far, apart = compared(), compared(4.0), 2.0 * MAX_FORM_DISTANCE_PERCENT
    assert same_branch(near, far, apart)
    assert not same_branch(far, near, apart)
    assert same_branch(far, near, 0.5 * MAX_FORM_DISTANCE_PERCENT)  # then both are one form
    assert not same_branch(compared(1.1 * MAX_LIKE_DISTANCE_PERCENT), far, 0.5 * MAX_FORM_DISTANCE_PERCENT)


def test_release_and_meshes_share_the_steps() -> None:
    told: list[int] = []
    progress = ExactProgress("exact", lambda stage, done, of: told.append(done))
    for text in (
        "300 vertices, 20 %",
        "300 vertices, 100 %",
        "300 vertices, equilibrium",
        "1000 vertices, equilibrium",
        "300 vertices, 40 %, to the side",
        "4000 vertices, equilibrium",
    ):
        progress.report(text, Iteration(0, 0.0, 0.0, 0.0, 0.0))
    progress.finish()
    assert told == sorted(told) and told[0] == 0 and told[-1] == WHOLE and max(told[:-1]) < WHOLE
    assert told[1] == 10 and told[2] == 50 and 50 < told[3] < told[4] < told[6]


@pytest.mark.slow
def test_a_ready_preview_is_not_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    dome = edited("dome", border={"rings": 1}, mesh={"edge_mm": 6.0})
    ready = preview(dome)
    monkeypatch.setattr("asterism.verification.verify.preview", lambda *_, **__: pytest.fail("made again"))
    told: list[tuple[str, int, int]] = []
    found = verify(dome, ready=ready, progress=lambda *step: told.append(step))
    assert found.preview is ready and found.summary["preview_s"] == ready.summary["wall_s"]
    assert list(dict.fromkeys(stage for stage, _, _ in told)) == list(STAGES)
    assert all(told[-1][1:] == (1, 1) for _ in STAGES)


def bowl(depth: float) -> Any:
    def place(points: Floats) -> Floats:
        return np.column_stack([points, depth * (points**2).sum(axis=1)])

    return place


@cache
def bowls(exact: float, preview: float) -> Verification:
    one, other = replace(shape(OF, bowl(exact)), summary=EXACT), shape(OF, bowl(preview))
    return Verification(
        OF, other, {"release": one}, {"release": compare_shapes(one, other, PLAN, symmetries(OF, PLAN))}
    )


def said(depths: tuple[float, float] = (0.01, 0.01), preview: dict[str, Any] | None = None, **exact: Any) -> list[str]:
    found = bowls(*depths)
    one = replace(found.exact["release"], summary=EXACT | exact)
    return verification_warnings(
        replace(found, preview=replace(found.preview, summary=preview or {}), exact={"release": one}), 0.0
    )


@pytest.mark.parametrize(("times", "surprising"), [(1.9, False), (2.1, True)])
def test_a_distance_far_above_the_expected_one_is_told_with_both_numbers(times: float, surprising: bool) -> None:
    distance = bowls(0.01, 0.0107).comparison.rms_percent
    lines = said((0.01, 0.0107), {"expected_rms_percent": distance / times})
    estimate = f"the estimated error of the preview ({distance / times:.1f} %)"
    line = f"the distance ({distance:.1f} %) is more than twice {estimate}"
    assert lines == ([line] if surprising else [])


@pytest.mark.parametrize(
    ("depths", "wrong"),
    [((0.01, 0.0107), False), ((0.01, 0.0093), False), ((0.01, 0.0115), True), ((0.01, 0.0085), True),
     ((1e-6, 3e-6), False)],
)  # fmt: skip
def test_heights_that_differ_are_told_unless_the_sheet_is_flat(depths: tuple[float, float], wrong: bool) -> None:
    exact, preview = bowls(*depths).comparison.record.heights_mm
    off = 100.0 * abs(preview / exact - 1.0)
    line = f"the preview is {preview:.1f} mm high, the exact shape {exact:.1f} mm: {off:.0f} % off"
    assert said(depths) == ([line] if wrong else [])


@pytest.mark.parametrize(("times", "surprising"), [(1.9, False), (2.1, True)])
@pytest.mark.parametrize("depths", [(0.01, 0.0105), (0.01, 0.008)])
def test_heights_that_were_expected_to_differ_are_no_surprise(
    depths: tuple[float, float], times: float, surprising: bool
) -> None:
    """However little or much they do."""
    exact, preview = bowls(*depths).comparison.record.heights_mm
    expected = 100.0 * abs(preview / exact - 1.0) / times
    lines = said(depths, {"expected_height_percent": expected})
    assert len(lines) == surprising
    assert all(line.endswith(f"% off, more than twice its estimated error ({expected:.1f} %)") for line in lines)


@pytest.mark.parametrize(
    ("down", "off", "line"),
    [
        ([2, 5], [2, 5], "2 of 7 stars of the exact shape bump down: stars 2, 5"),
        ([2, 5], [], "2 of 7 stars of the exact shape bump down: stars 2, 5"),
        ([], [3], f"the exact model: {OFF}"),
    ],
)
def test_stars_on_another_side_are_named_once(down: list[int], off: list[int], line: str) -> None:
    warnings = list(off_branch(ExactRecord.from_json({"stars_off_branch": off, "stars_total": 7})))
    assert said(stars_down=down, stars_off_branch=off, warnings=warnings) == [line]


def with_other(apart: float, one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """What is said of two exact shapes so far apart, with summaries of their own."""
    found = bowls(0.01, 0.01)
    shapes = {
        name: replace(found.exact["release"], summary=EXACT | own)
        for name, own in (("release", one), ("preview", other))
    }
    both = replace(found, exact=shapes, comparisons=dict.fromkeys(shapes, found.comparison))
    return verification_warnings(both, apart)


@pytest.mark.parametrize(
    ("energy", "apart", "told"), [(1.0001, 3.0, True), (0.9999, 3.0, True), (1.006, 3.0, False), (1.0001, 2.4, False)]
)
def test_two_minima_of_nearly_one_energy_are_told(energy: float, apart: float, told: bool) -> None:
    line = (
        "the exact model has two minima, 3.0 % of the diameter apart, whose energies differ by 0.01 %: "
        "a print may rest in either"
    )
    assert with_other(apart, {}, {"energy_n_mm": energy}) == ([line] if told else [])
    # a start that has come to no minimum is no second form; and how high a sheet hangs makes two no more alike
    assert with_other(apart, {}, {"energy_n_mm": energy, "is_minimum": False}) == []
    assert with_other(apart, *({"energy_n_mm": each, "gravity": 99.0} for each in (100.0, 100.1))) == []


def test_what_the_exact_model_said_is_passed_on_once() -> None:
    """But what the preview said of the same pins, and what is said here in other words."""
    roll, pins = "the radius of a free roll depends on the mesh", "the pins let the sheet swing"
    crossing = "the sheet passes through itself (4 crossings); --contact prevents this"
    lines = said(
        preview={"warnings": [pins]}, self_intersections=4, self_contact=None, stars_down=[3], stars_off_branch=[3],
        warnings=[crossing, roll, OFF, pins],
    )  # fmt: skip
    assert lines == [
        pins,
        "1 of 7 stars of the exact shape bumps down: star 3",
        f"the exact model: {crossing}",
        f"the exact model: {roll}",
    ]


def test_an_unknown_mesh_error_is_told_where_meshes_differ_by_more_than_the_distance() -> None:
    distance = bowls(0.01, 0.0107).comparison.rms_percent
    lines = said((0.01, 0.0107), mesh_change_percent=1.1 * distance)
    assert len(lines) == 1 and lines[0].endswith(f"more than the distance ({distance:.1f} %)")
    assert said((0.01, 0.0107), mesh_error_percent=1.1 * distance, mesh_change_percent=1.1 * distance) == []


SMALL = design(stars={"length_mm": 8.0, "thickness_mm": 0.4}, mesh={"edge_mm": 6.0})


@pytest.fixture(scope="module")
def released() -> Shape:
    return exact_shape(SMALL)


def other_form(shape: Shape, more: float, **summary: Any) -> Shape:
    """A shape of another form, rolled up about an axis, with a share of the energy more."""
    x, y = shape.printed.T
    rolled = np.column_stack([x, 12.0 * np.sin(y / 12.0), 12.0 * np.cos(y / 12.0)])
    energy = (1.0 + more) * shape.summary["energy_n_mm"]
    return replace(shape, positions=rolled, summary=shape.summary | {"energy_n_mm": energy} | summary)


@pytest.mark.slow
def test_both_starts_of_a_small_sheet_end_in_one_minimum(released: Shape) -> None:
    said: list[str] = []
    shape = simulate(SMALL, say=said.append)
    (minimum,) = shape.summary["minima"]
    assert shape.summary["is_minimum"] and not shape.others
    assert shape.summary["starts"] == 2 and shape.summary["starts_lost"] == 0 and shape.summary["minima_seen"] == 1
    assert minimum["start_names"] == ["release", "preview"] and minimum["default"]
    assert shape.summary.table()["minimum 1"].endswith("7 up; from release and preview")
    assert shape.summary["energy_n_mm"] == pytest.approx(released.summary["energy_n_mm"], rel=1e-8)
    assert "started from the preview" in said


@pytest.mark.parametrize(
    ("more", "result", "near"), [(0.02, "release", False), (0.001, "release", True), (-0.001, "preview", True)]
)
def test_the_lower_of_two_minima_counts_and_the_other_is_kept(
    released: Shape, more: float, result: str, near: bool
) -> None:
    second = other_form(released, more)
    shape = lower_minimum(SMALL, layout(SMALL), released, second)
    s = shape.summary
    assert [minimum["start_names"] for minimum in s["minima"]] == [
        [result],
        [{"release": "preview"}.get(result, "release")],
    ]
    assert s["minima_seen"] == s["starts"] == 2 and s["result_is"] == "lowest energy"
    assert len(shape.others) == 1 and s["energy_n_mm"] <= shape.others[0].summary["energy_n_mm"]
    assert s["next_minimum_percent"] == pytest.approx(100.0 * abs(more), rel=2e-3)
    assert s["minima"][1]["distance_percent"] == s["minima_distance_percent"][0][1] > 10.0
    assert any("a print may rest in either" in line for line in s["warnings"]) is near
    assert [minimum["file"] for minimum in s["minima"]] == ["shape", "minimum-2"]
    assert {"minimum 1", "minimum 2"} <= set(s.table())


def test_a_lower_minimum_with_stars_on_the_wrong_side_does_not_count(released: Shape) -> None:
    inverted = other_form(released, -0.01, stars_off_branch=[3], stars_down=[3])
    shape = lower_minimum(SMALL, layout(SMALL), released, inverted)
    assert shape.summary["minima"][0]["start_names"] == ["release"]
    assert shape.summary["next_minimum_percent"] == pytest.approx(-1.0, rel=1e-6)
    assert shape.summary["result_is"] == "lowest energy of those whose stars are all on their branch"


def test_a_start_without_a_minimum_is_lost(released: Shape) -> None:
    lost = other_form(released, -0.5, is_minimum=False)
    shape = lower_minimum(SMALL, layout(SMALL), released, lost)
    assert shape.summary["starts_lost"] == 1 and shape.summary["minima_seen"] == 1 and not shape.others
    assert shape.summary["minima"][0]["start_names"] == ["release"]
    uncertain = replace(released, summary=released.summary | {"is_minimum": False})
    shape = lower_minimum(SMALL, layout(SMALL), uncertain, other_form(released, 0.5))
    assert shape.summary["minima"][0]["start_names"] == ["preview"] and shape.summary["is_minimum"]


@pytest.mark.slow
def test_a_fabric_without_a_law_is_released_alone() -> None:
    said: list[str] = []
    free = Design.from_dict(SMALL.to_dict() | {"fabric": {"bending": "none"}, "border": {"rings": 0}})
    shape = simulate(free, say=said.append)
    assert shape.summary["starts"] == 1 and any("no start from the preview" in line for line in said)


@pytest.mark.slow
def test_one_start_is_the_release_and_a_given_shape_is_the_only_start(released: Shape) -> None:
    alone = simulate(SMALL, starts=1)
    assert alone.summary["starts"] == 1 and np.array_equal(alone.positions, released.positions)
    near = simulate(SMALL, near=released)
    assert near.summary["result_is"] == "from a shape that was given"
    with pytest.raises(ValueError, match="near goes with one start"):
        simulate(SMALL, starts=2, near=released)


@pytest.mark.slow
def test_starts_that_meet_on_a_coarse_mesh_share_the_finer_ones() -> None:
    found = verify(edited("dome", border={"rings": 2}, mesh={"edge_mm": 1.2}))
    release, near = found.summary["starts"]["release"], found.summary["starts"]["preview"]
    assert found.summary["starts_agree"] and found.summary["starts_distance_percent"] < 1e-6
    assert (
        near["joined_at_vertices"] in [level["vertices"] for level in found.summary["exact"]["levels"]]
        and near["is_minimum"]
    )
    assert near["energy_n_mm"] == release["energy_n_mm"] and near["iterations"] < release["iterations"] / 3
    assert "joined_at_vertices" not in release
