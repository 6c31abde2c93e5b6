"""The engine's forms: searched for, cancelled, flipped, listed, kept while the sheet changes, and gone back to."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import asterism
from asterism.studio.messages import Cancel, Edit, Flip, Frame, ShapeSummary, ShowForm, StudioProblem
from tests.asterism.studio.engine_pipe import EnginePipe, table


def narrow(**sections: Any) -> dict[str, Any]:
    """A dome whose border is so narrow that it stays on either side."""
    return table(pins=[{"where": "border", "scale": 0.7}], **sections)


def test_a_search_can_be_cancelled_and_the_shape_stays(engine: EnginePipe) -> None:
    engine.send(Edit(1, table()))
    before = engine.frame(1)
    engine.send(Cancel(2), Edit(2, table(border={"rings": 4})))
    assert engine.problem(2).kind == "cancelled"
    engine.send(Edit(3, table()))
    assert engine.frame(3).arrays["positions"] == pytest.approx(before.arrays["positions"], abs=1e-4)


@pytest.mark.slow
def test_a_cancelled_flip_leaves_the_form_and_its_summary_follows(engine: EnginePipe) -> None:
    engine.send(Edit(1, narrow()))
    before = engine.frame(1)
    engine.send(Cancel(2), Flip(2))
    assert engine.problem(2).kind == "search ended"
    assert engine.summary(2).numbers["height_mm"] == pytest.approx(before.height_mm, rel=0.02)
    engine.send(Flip(3))
    assert engine.frame(3).height_mm < before.height_mm


@pytest.mark.slow
def test_a_snapshot_brings_its_form_back_also_in_a_new_engine(engine: EnginePipe) -> None:
    engine.send(Edit(1, narrow()))
    first = engine.frame(1)
    engine.send(Flip(2))
    flipped = engine.frame(2)
    assert np.abs(flipped.arrays["positions"] - first.arrays["positions"]).max() > 1.0
    engine.send(Edit(3, narrow(), is_opened=True, snapshot=first.snapshot))
    assert engine.frame(3).arrays["positions"] == pytest.approx(first.arrays["positions"], abs=1e-4)
    # of another mesh: the shape is found anew
    engine.send(Edit(4, narrow(border={"rings": 2}), is_opened=True, snapshot=first.snapshot))
    assert engine.frame(4).is_minimum
    other = EnginePipe()
    other.send(Edit(3, narrow(), snapshot=flipped.snapshot))
    assert other.frame(3).arrays["positions"] == pytest.approx(flipped.arrays["positions"], abs=1e-4)
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
    engine.send(Edit(1, table(), is_opened=True))
    height = engine.summary(1).numbers["height_mm"]
    engine.send(Edit(2, table(border={"rings": 2})))
    engine.frame(2)
    engine.send(Edit(3, table(), is_opened=True))
    ended = engine.until(lambda answer: isinstance(answer, ShapeSummary | StudioProblem) and answer.seq == 3)
    assert isinstance(ended, ShapeSummary), ended  # its points are outside of the smaller sheet
    assert ended.numbers["height_mm"] == pytest.approx(height, rel=1e-9)


def test_an_edit_goes_on_from_an_opened_design_and_never_from_the_one_before(engine: EnginePipe) -> None:
    engine.send(Edit(1, table("cone"), is_opened=True))
    engine.frame(1)
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
    engine.send(Edit(4, narrow()))
    assert engine.frame(4).arrays["positions"] == pytest.approx(flipped.arrays["positions"], abs=1e-4)


@pytest.mark.slow
def test_other_forms_are_listed_and_shown(engine: EnginePipe) -> None:
    data = asterism.new("fig8-l-increasing").to_dict()
    engine.send(Edit(1, data))
    summary = engine.summary(1)
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
    engine.send(Edit(1, table("tube")))
    first = engine.frame(1)
    assert first.arrays["positions"][:, 2].min() == pytest.approx(0.0, abs=1e-5) and len(first.arrays["needles"]) == 0
    engine.send(Edit(2, table("tube"), sites=np.array([[0, 0]]), sizes_mm=np.array([[np.nan, 0.41, np.nan]])))
    linear, final = engine.frame(2, "linear"), engine.frame(2)
    assert np.abs(linear.arrays["positions"] - final.arrays["positions"]).max() < 3.0
    assert engine.summary(2).numbers["height_mm"] > 0.0


@pytest.mark.slow
def test_another_outline_goes_on_from_the_old_shape_and_is_searched_at_rest(engine: EnginePipe) -> None:
    engine.send(Edit(1, narrow()))
    engine.summary(1)
    smaller = narrow(border={"rings": 2})
    engine.send(Edit(2, smaller))
    quick = engine.frame(2)
    summary = engine.summary(2)
    expected = asterism.preview(asterism.Design.from_dict(smaller)).summary
    assert quick.is_minimum and summary.numbers["height_mm"] == pytest.approx(expected["height_mm"], rel=1e-9)
    assert [notice.text for notice in summary.warnings] == expected["warnings"]
    # a form that was chosen stays at rest
    engine.send(Flip(3))
    flipped = engine.frame(3)
    assert engine.summary(3).numbers["height_mm"] == pytest.approx(flipped.height_mm, rel=0.05)  # on other meshes
