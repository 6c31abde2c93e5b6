"""What frames of the engine hold besides the shape: the sheet without bumps, and the distance to a target."""

from __future__ import annotations

import numpy as np
import pytest

import asterism
from asterism.studio.messages import Edit, FitTarget, Frame, Parts, Surface, TargetPose
from tests.asterism.studio.engine_pipe import EnginePipe, table


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
    engine.send(Edit(2, table(), np.array([[0, 0]]), np.array([[6.0, np.nan, np.nan]]), is_dragging=True))
    assert "smooth" in engine.frame(2, "linear").arrays


def test_a_free_sheet_without_bumps_stands_where_the_sheet_with_bumps_does(engine: EnginePipe) -> None:
    engine.send(Edit(1, table("star")), Parts(1, smooth=True))
    engine.summary(1)
    frame = [answer for answer in engine.answers if isinstance(answer, Frame)][-1]
    assert np.abs(frame.arrays["smooth"] - frame.arrays["positions"]).max() < 3.0


@pytest.mark.slow
def test_a_target_is_laid_on_the_shape_and_measured_at_rest(engine: EnginePipe) -> None:
    for seq in (1, 2):
        engine.send(Edit(seq, table()))
        engine.summary(seq)
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
    engine.send(Edit(4, table(), np.array([[0, 0]]), np.array([[6.0, np.nan, np.nan]]), is_dragging=True))
    assert engine.frame(4).target is None


def test_a_target_is_not_laid_on_a_sheet_that_does_not_exist(engine: EnginePipe) -> None:
    engine.send(FitTarget(1))
    assert engine.problem(1).kind == "no target"
