"""The engine: newest edits first, errors leave the old shape, rest brings the summary; forms are kept and left."""

from __future__ import annotations

import pickle
import threading
import time
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.pattern.layout.build import layout
from asterism.previews.session import Preview, SearchLimitError
from asterism.studio.engine_frames import EngineFrames
from asterism.studio.inbox import Inbox, SearchBounds
from asterism.studio.messages import (
    Busy,
    Cancel,
    Edit,
    FitTarget,
    Flip,
    Frame,
    Limits,
    Parts,
    Rested,
    ShapeSummary,
    ShowForm,
    StudioProblem,
    Surface,
    TargetPose,
)
from tests.asterism.studio.engine_pipe import EnginePipe, is_same_shape, table

# a stroke: the star in the middle gets arms of 6 mm
SHORTER = np.array([[0, 0]]), np.array([[6.0, np.nan, np.nan]])


def test_the_first_edit_gives_signs_of_life_a_mesh_the_preview_and_the_limits(
    engine: EnginePipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("asterism.studio.inbox.SIGN_EVERY_S", 0.0)
    frame = engine.show(1, table())
    mesh = frame.mesh_arrays
    (limits,) = [answer for answer in engine.answers if isinstance(answer, Limits)]
    assert any(isinstance(answer, Busy) and answer.seq == 1 for answer in engine.answers)
    assert frame.is_minimum and frame.snapshot is not None
    count, arms = len(mesh["printed"]), len(mesh["arm_site"])
    assert frame.arrays["positions"].shape == (count, 3)
    assert frame.arrays["curvature"].shape == frame.arrays["strain"].shape == (count,)
    assert frame.arrays["arms"].shape == (arms, 5, 3, 3) and frame.arrays["arm_normals"].shape == (arms, 5, 3)
    assert all(np.isfinite(part).all() for part in frame.arrays.values())
    assert mesh["triangles"].max() < count and mesh["outline"].shape == (len(set(mesh["outline"].ravel().tolist())), 2)
    assert set(limits.stretches) == {1.35, 1.75} and limits.law["width_mm"] == (0.8, 1.6)

    printed = mesh["printed"]
    design = asterism.Design.from_dict(table())
    preview = asterism.Preview(design)
    inside = np.abs(printed).max(axis=1) < 40.0
    places = preview.at(printed[inside].astype(float)).bumpy
    # points of 4 bytes change their nearest star
    assert frame.arrays["positions"][inside] == pytest.approx(places, abs=0.02)
    plan = layout(design)
    width = np.linalg.norm(frame.arrays["arms"][:, :, 0] - frame.arrays["arms"][:, :, 1], axis=-1)
    assert width == pytest.approx(np.broadcast_to(plan.arm_width[:, :1], width.shape), abs=1e-3)
    # the left edge is on the left of an arm that leads away from its star
    along = frame.arrays["arms"][:, -1, :2].mean(axis=1) - frame.arrays["arms"][:, 0, :2].mean(axis=1)
    left = frame.arrays["arms"][:, 2, 0] - frame.arrays["arms"][:, 2, 1]
    assert (np.einsum("ac,ac->a", np.cross(along, left), frame.arrays["arm_normals"][:, 2]) > 0.0).all()


def test_painted_stars_give_a_linear_response_and_then_the_equilibrium(engine: EnginePipe) -> None:
    engine.show(1, table())
    engine.send(Edit(2, table(), np.array([[0, 0], [1, 0]]), np.array([[6.0, np.nan, np.nan]] * 2)))
    linear, final = engine.frame(2, "linear"), engine.frame(2)
    assert linear.snapshot is None and linear.mesh == final.mesh
    override = [{"site": [0, 0], "length_mm": 6.0}, {"site": [1, 0], "length_mm": 6.0}]
    assert is_same_shape(engine.show(3, table(stars={"override": override})), final)


def test_rest_brings_a_fine_mesh_and_the_summary(engine: EnginePipe) -> None:
    outside = {"override": [{"site": [0, 0], "thickness_mm": 1.6}]}
    marked = {**table(stars=outside), "material": {"law": str(PAPER_LAW)}}
    summary = engine.rest(1, marked)
    expected = asterism.preview(asterism.Design.from_dict(marked)).summary
    assert summary.numbers["height_mm"] == pytest.approx(expected["height_mm"], rel=1e-9)
    assert [notice.text for notice in summary.warnings] == expected["warnings"]
    assert summary.warnings[0].stars == ((0, 0),)
    coarse, fine = engine.meshes().values()
    assert len(fine["triangles"]) > 3 * len(coarse["triangles"]) and engine.answers[-2].mesh_arrays is fine
    (rested,) = [answer for answer in engine.answers if isinstance(answer, Rested)]
    assert pickle.loads(rested.shape).height_mm == pytest.approx(expected["height_mm"], rel=1e-9)


@pytest.mark.slow
def test_the_summary_says_how_far_a_sheet_hangs_below_its_needles(engine: EnginePipe) -> None:
    middle = {"points_mm": [[-8.0, 0.0], [8.0, 0.0], [0.0, 12.0]], "scale": 0.76}
    data = {"stars": {"length_mm": 8.0}, "border": {"rings": 2}, "pins": [middle]}
    engine.send(Edit(1, data))
    low = asterism.preview(asterism.Design.from_dict(data)).positions[:, 2].min()
    assert engine.summary(1).numbers["below_needles_mm"] == pytest.approx(-low, rel=1e-6) and low < -0.5
    assert engine.rest(2, data | {"pins": []}).numbers["below_needles_mm"] is None
    assert engine.answers[-1].numbers["above_needles_mm"] is None


def test_a_drag_ends_with_the_shape_of_its_last_edit(engine: EnginePipe) -> None:
    engine.show(1, table())
    lengths = np.linspace(9.0, 6.0, 40)
    for seq, length in enumerate(lengths, 2):
        engine.send(Edit(seq, table(), np.array([[0, 0]]), np.array([[length, np.nan, np.nan]]), is_dragging=True))
    engine.rest(50, table(), *SHORTER)
    shown = [answer.seq for answer in engine.answers if isinstance(answer, Frame)]
    assert shown == sorted(shown) and len(set(shown)) < 40
    height = engine.answers[-1].numbers["height_mm"]
    last = table(stars={"override": [{"site": [0, 0], "length_mm": 6.0}]})
    assert height == pytest.approx(asterism.preview(asterism.Design.from_dict(last)).height_mm, rel=1e-6)


@pytest.mark.slow
def test_another_stretch_is_learned(engine: EnginePipe) -> None:
    even = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}, "pins": [{"where": "border", "scale": 0.8}]}
    engine.show(1, even)
    even = even | {"fabric": {"stretch": 1.5}}
    frame = engine.show(2, even)
    limits = [answer for answer in engine.answers if isinstance(answer, Limits)][-1]
    assert limits.seq == 2 and limits.stretches == (1.35, 1.75) and limits.law == {}
    own = asterism.preview(asterism.Design.from_dict(even))
    rise = np.ptp(frame.arrays["positions"][:, 2])
    assert frame.is_minimum and rise == pytest.approx(own.height_mm, rel=0.1)


@pytest.mark.slow
def test_an_error_leaves_the_old_shape_and_is_no_end(engine: EnginePipe) -> None:
    engine.send(Edit(0, table(stars={"length_mm": 40.0})))
    assert engine.problem(0).kind == "design"
    before = engine.show(1, table())
    mistakes: list[tuple[dict[str, Any], str]] = [
        ({"stars": {"length_mm": 40.0}}, "stars.length_mm"),
        ({"border": {"rings": -1}}, "border.rings"),
        ({"pins": [{"points_mm": [[900.0, 0.0]]}]}, "pins[0].points_mm[0]"),
        ({"stars": {"override": [{"site": [1, 0], "width_mm": 40.0}]}}, "stars.override[0].width_mm"),
    ]
    for seq, (changes, field) in enumerate(mistakes, 2):
        engine.send(Edit(seq, table(**changes)))
        problem = engine.problem(seq)
        assert (problem.kind, problem.field) == ("design", field) and "\n" not in problem.text
    assert problem.stars == ((1, 0),) and problem.at_mm is not None
    assert is_same_shape(engine.show(9, table()), before)


def test_stars_without_a_law_are_left_to_the_exact_model(engine: EnginePipe) -> None:
    engine.send(Edit(1, table(fabric={"bending": "none"})))
    frame = engine.frame(1, "printed")
    assert len(frame.arrays["arms"]) and not frame.arrays["positions"][:, 2].any()
    assert engine.show(2, table()).is_minimum


def test_a_step_without_end_is_one_that_takes_too_much_processor_time() -> None:
    bounds = SearchBounds(Inbox(threading.Event().wait), lambda message: None, time.perf_counter)
    assert not bounds.is_stuck
    bounds.go_on(0.0)
    time.sleep(0.01)  # takes processor time too, but less than the next step may
    assert bounds.is_stuck
    bounds.check()
    assert not bounds.is_stuck


def test_time_in_which_cells_are_learned_is_no_search() -> None:
    bounds = SearchBounds(Inbox(threading.Event().wait), lambda message: None, time.perf_counter)
    bounds.longest_s = 0.2
    bounds.wait()
    ends = time.thread_time() + 0.3  # cells are solved in this thread
    while time.thread_time() < ends:
        pass
    time.sleep(0.7)
    bounds.check()
    time.sleep(0.7)
    with pytest.raises(SearchLimitError, match="no equilibrium within"):
        bounds.check()


def test_a_search_that_is_cancelled_or_takes_too_long_leaves_the_shape(
    engine: EnginePipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = engine.show(1, table())
    engine.send(Cancel(2), Edit(2, table(border={"rings": 4})))
    assert engine.problem(2).kind == "cancelled"
    monkeypatch.setattr("asterism.studio.inbox.MAX_SEARCH_S", 0.02)
    engine.send(Edit(3, table(border={"rings": 4})))
    assert engine.problem(3).kind == "too long"
    monkeypatch.undo()
    assert is_same_shape(engine.show(4, table()), before)


def test_removed_stars_have_no_arms_and_a_sheet_without_stars_is_flat_and_released(engine: EnginePipe) -> None:
    engine.send(Edit(1, table(stars={"length_mm": 0.0})))
    blank = engine.frame(1, "exact")
    outline = layout(asterism.Design.from_dict(table())).outline
    assert np.ptp(blank.arrays["positions"], axis=0) == pytest.approx([*np.ptp(outline, axis=0) / 1.35, 0.0], rel=1e-5)
    assert blank.is_minimum and len(blank.arrays["arms"]) == 0 and "no stars" in engine.summary(1).warnings[0].text
    frame = engine.show(2, table(), removed=np.array([[0, 0]]))
    arm_site = engine.meshes()[frame.mesh]["arm_site"]
    assert 0 not in arm_site and len(frame.arrays["arms"]) == len(arm_site) == 36 * 3
    engine.send(Edit(3, table(), removed=layout(asterism.Design.from_dict(table())).sheet_sites))
    assert len(engine.frame(3, "exact").arrays["arms"]) == 0
    engine.send(Edit(4, table()))
    assert len(engine.frame(4).arrays["arms"]) == 37 * 3


@pytest.mark.slow
def test_frames_hold_the_sheet_without_bumps_when_they_are_asked_to(engine: EnginePipe) -> None:
    engine.send(Edit(1, table()))
    assert "smooth" not in engine.frame(1).arrays
    engine.summary(1)
    engine.send(Parts(1, smooth=True))
    frame = engine.frame(1)
    printed = engine.meshes()[frame.mesh]["printed"]
    preview = asterism.Preview(asterism.Design.from_dict(table()))
    inside = np.abs(printed).max(axis=1) < 40.0
    places = preview.at(printed[inside].astype(float)).smooth
    assert frame.is_again and frame.arrays["smooth"][inside] == pytest.approx(places, abs=1e-3)
    assert np.abs(frame.arrays["smooth"] - frame.arrays["positions"]).max() > 0.5
    assert frame.arrays["smooth_arms"].shape == frame.arrays["arms"].shape
    assert frame.arrays["smooth_needles"].shape == frame.arrays["needles"].shape
    engine.send(Edit(2, table(), *SHORTER, is_dragging=True))
    assert "smooth" in engine.frame(2, "linear").arrays


def test_a_free_sheet_without_bumps_stands_where_the_sheet_with_bumps_does(engine: EnginePipe) -> None:
    engine.send(Edit(1, table("star")), Parts(1, smooth=True))
    engine.summary(1)
    frame = [answer for answer in engine.answers if isinstance(answer, Frame)][-1]
    assert np.abs(frame.arrays["smooth"] - frame.arrays["positions"]).max() < 3.0


@pytest.mark.slow
def test_a_target_is_laid_on_the_shape_and_measured_at_rest(engine: EnginePipe) -> None:
    for seq in (1, 2):
        engine.rest(seq, table())
    frame = [answer for answer in engine.answers if isinstance(answer, Frame)][-1]
    triangles = engine.meshes()[frame.mesh]["triangles"]
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    away = frame.arrays["positions"].astype(float) @ turn.T + [200.0, 0.0, 50.0]
    engine.send(Parts(2, target=Surface(away, triangles), version=1), FitTarget(3))
    assert engine.frame(2).target["rms_mm"] > 100.0
    pose = engine.until(lambda answer: isinstance(answer, TargetPose) and answer.seq == 3)
    laid = away @ pose.rotation.T + pose.shift
    engine.send(Parts(3, target=Surface(laid, triangles), version=2))
    again = engine.frame(2)  # the shape is that of the last edit
    assert again.target["version"] == 2 and again.target["max_mm"] < 0.1
    assert again.arrays["target"].shape == (len(laid),)
    assert engine.show(4, table(), *SHORTER, is_dragging=True).target is None


def test_what_is_known_at_rest_follows_a_target_that_comes_meanwhile(
    engine: EnginePipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its question ends the work at rest, and shows nothing by itself."""
    prepare = EngineFrames.prepare_fine

    def interrupted(frames: EngineFrames, preview: Preview) -> None:
        prepare(frames, preview)
        monkeypatch.undo()
        engine.send(FitTarget(2))
        time.sleep(0.2)

    monkeypatch.setattr(EngineFrames, "prepare_fine", interrupted)
    engine.send(Edit(1, table()))
    assert engine.problem(2).kind == "no target"
    engine.summary(2)


def test_what_is_asked_of_no_sheet_or_of_an_older_one_does_not_take_the_place_of_an_edit(engine: EnginePipe) -> None:
    engine.send(FitTarget(1))
    assert engine.problem(1).kind == "no target"
    engine.show(3, table())
    engine.send(Parts(2, smooth=True))
    engine.summary(3)


def narrow(**sections: Any) -> dict[str, Any]:
    """A dome whose border is so narrow that it stays on either side."""
    return table(pins=[{"where": "border", "scale": 0.7}], **sections)


@pytest.mark.slow
def test_a_cancelled_flip_leaves_the_form_and_its_summary_follows(engine: EnginePipe) -> None:
    before = engine.show(1, narrow())
    engine.send(Cancel(2), Flip(2))
    assert engine.problem(2).kind == "search ended"
    assert engine.summary(2).numbers["height_mm"] == pytest.approx(before.height_mm, rel=0.02)
    engine.send(Flip(3))
    assert engine.frame(3).height_mm < before.height_mm


@pytest.mark.slow
def test_a_snapshot_brings_its_form_back_also_in_a_new_engine(engine: EnginePipe) -> None:
    first = engine.show(1, narrow())
    engine.send(Flip(2))
    flipped = engine.frame(2)
    assert np.abs(flipped.arrays["positions"] - first.arrays["positions"]).max() > 1.0
    assert is_same_shape(engine.show(3, narrow(), is_opened=True, snapshot=first.snapshot), first)
    # of another mesh: the shape is found anew
    assert engine.show(4, narrow(border={"rings": 2}), is_opened=True, snapshot=first.snapshot).is_minimum
    other = EnginePipe()
    other.send(Edit(3, narrow(), snapshot=flipped.snapshot))
    assert is_same_shape(other.frame(3), flipped)
    other.close()


@pytest.mark.slow
def test_an_opened_design_does_not_depend_on_those_opened_before_though_they_share_a_print(engine: EnginePipe) -> None:
    dome, uniform, decreasing = (table(name) for name in ("dome", "fig8-l-uniform", "fig8-l-decreasing"))
    edited = decreasing | {"stars": decreasing["stars"] | {"thickness_mm": 0.5}}  # in another program
    for seq, design in enumerate((dome, uniform, decreasing, edited, dome), 1):
        engine.send(Edit(seq, design, is_opened=True))
        expected = asterism.preview(asterism.Design.from_dict(design)).summary
        summary, height = engine.summary(seq), expected["height_mm"]
        assert summary.numbers["height_mm"] == pytest.approx(height, rel=1e-9)
        assert [notice.text for notice in summary.warnings] == expected["warnings"]
        coarse, fine = [answer for answer in engine.answers if isinstance(answer, Frame)][-2:]
        assert coarse.height_mm == pytest.approx(height, rel=0.02)
        assert fine.height_mm == pytest.approx(height, rel=0.005)


def test_a_sheet_comes_to_rest_after_a_smaller_one_that_did_not(engine: EnginePipe) -> None:
    height = engine.rest(1, table(), is_opened=True).numbers["height_mm"]
    engine.show(2, table(border={"rings": 2}))
    engine.send(Edit(3, table(), is_opened=True))
    ended = engine.until(lambda answer: isinstance(answer, ShapeSummary | StudioProblem) and answer.seq == 3)
    assert isinstance(ended, ShapeSummary), ended  # its points are outside of the smaller sheet
    assert ended.numbers["height_mm"] == pytest.approx(height, rel=1e-9)


def test_an_edit_goes_on_from_an_opened_design_and_never_from_the_one_before(engine: EnginePipe) -> None:
    engine.show(1, table("cone"), is_opened=True)
    engine.send(Cancel(2), Edit(2, table(), is_opened=True))
    assert engine.problem(2).kind == "cancelled"
    engine.send(Flip(3))
    assert engine.problem(3).kind == "no other side"
    engine.send(Edit(4, table(), sites=np.array([[0, 0]]), sizes_mm=np.array([[8.0, np.nan, np.nan]])))
    edited = asterism.Design.from_dict(table(stars={"override": [{"site": [0, 0], "length_mm": 8.0}]}))
    height = engine.summary(4).numbers["height_mm"]
    assert height == pytest.approx(asterism.preview(edited).height_mm, rel=1e-9)


@pytest.mark.slow
def test_a_flip_waits_for_the_shape_of_the_edit_before(engine: EnginePipe, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asterism.studio.inbox.STALE_S", 0.0)
    engine.send(Edit(1, narrow(), is_opened=True), Flip(2))
    first = engine.frame(1)
    assert engine.frame(2).height_mm < first.height_mm


@pytest.mark.slow
def test_an_edit_goes_to_the_form_of_an_opening_that_was_cancelled(engine: EnginePipe) -> None:
    engine.send(Edit(1, narrow()), Flip(2))
    flipped = engine.frame(2)
    engine.send(Cancel(3), Edit(3, narrow(), is_opened=True, snapshot=flipped.snapshot))
    assert engine.problem(3).kind == "cancelled"
    assert is_same_shape(engine.show(4, narrow()), flipped)


@pytest.mark.slow
def test_other_forms_are_listed_and_shown(engine: EnginePipe) -> None:
    data = asterism.new("fig8-l-increasing").to_dict()
    summary = engine.rest(1, data)
    assert [form.is_shown for form in summary.forms] == [True, False]
    shown, other = summary.forms
    assert shown.energy_percent == 0.0 < other.energy_percent
    (known,) = asterism.preview(asterism.Design.from_dict(data)).summary["other_forms"]
    assert other.energy_percent == pytest.approx(100.0 * known["gap"], rel=1e-6)
    engine.send(ShowForm(2, 0))
    assert engine.frame(2).is_minimum
    engine.send(ShowForm(3, 7))
    assert engine.problem(3).kind == "no such form"


def test_free_sheets_keep_their_pose_while_they_change(engine: EnginePipe) -> None:
    first = engine.show(1, table("tube"))
    assert first.arrays["positions"][:, 2].min() == pytest.approx(0.0, abs=1e-5) and len(first.arrays["needles"]) == 0
    engine.send(Edit(2, table("tube"), sites=np.array([[0, 0]]), sizes_mm=np.array([[np.nan, 0.41, np.nan]])))
    linear, final = engine.frame(2, "linear"), engine.frame(2)
    assert np.abs(linear.arrays["positions"] - final.arrays["positions"]).max() < 3.0
    assert engine.summary(2).numbers["height_mm"] > 0.0


@pytest.mark.slow
def test_another_outline_goes_on_from_the_old_shape_and_is_searched_at_rest(engine: EnginePipe) -> None:
    engine.rest(1, narrow())
    smaller = narrow(border={"rings": 2})
    quick = engine.show(2, smaller)
    summary = engine.summary(2)
    expected = asterism.preview(asterism.Design.from_dict(smaller)).summary
    assert quick.is_minimum and summary.numbers["height_mm"] == pytest.approx(expected["height_mm"], rel=1e-9)
    assert [notice.text for notice in summary.warnings] == expected["warnings"]
    # a form that was chosen stays at rest
    engine.send(Flip(3))
    flipped = engine.frame(3)
    assert engine.summary(3).numbers["height_mm"] == pytest.approx(flipped.height_mm, rel=0.05)  # on other meshes
