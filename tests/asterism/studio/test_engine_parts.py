"""What frames of the engine hold besides the shape: the sheet without bumps, and the distance to a target."""

from __future__ import annotations

import numpy as np
import pytest

import asterism
from asterism.studio.messages import Edit, FitTarget, Frame, Parts, ShownMesh, Surface, TargetPose
from tests.asterism.studio.engine_pipe import EnginePipe, table


@pytest.mark.slow
def test_frames_hold_the_sheet_without_bumps_when_they_are_asked_to(engine: EnginePipe) -> None:
    engine.send(Edit(1, table()))
    assert engine.frame(1).smooth is None
    engine.summary(1)
    engine.send(Parts(1, smooth=True))
    frame = engine.frame(1)
    mesh = next(answer for answer in engine.answers if isinstance(answer, ShownMesh) and answer.mesh == frame.mesh)
    preview = asterism.Preview(asterism.Design.from_dict(table()))
    inside = np.abs(mesh.printed).max(axis=1) < 40.0
    places = preview.at(mesh.printed[inside].astype(float)).smooth
    assert frame.is_again and frame.smooth.positions[inside] == pytest.approx(places, abs=1e-3)
    assert np.abs(frame.smooth.positions - frame.positions).max() > 0.5
    assert frame.smooth.arms.shape == frame.arms.shape and frame.smooth.needles.shape == frame.needles.shape
    engine.send(Edit(2, sites=np.array([[0, 0]]), sizes_mm=np.array([[6.0, np.nan, np.nan]]), is_dragging=True))
    assert engine.frame(2, "linear").smooth is not None


def test_a_free_sheet_without_bumps_stands_where_the_sheet_with_bumps_does(engine: EnginePipe) -> None:
    engine.send(Edit(1, table("star")), Parts(1, smooth=True))
    engine.summary(1)
    frame = [answer for answer in engine.answers if isinstance(answer, Frame)][-1]
    assert np.abs(frame.smooth.positions - frame.positions).max() < 3.0


@pytest.mark.slow
def test_a_target_is_laid_on_the_shape_and_measured_at_rest(engine: EnginePipe) -> None:
    for seq in (1, 2):
        engine.send(Edit(seq, table()))
        engine.summary(seq)
    frame = [answer for answer in engine.answers if isinstance(answer, Frame)][-1]
    mesh = next(answer for answer in engine.answers if isinstance(answer, ShownMesh) and answer.mesh == frame.mesh)
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    away = frame.positions.astype(float) @ turn.T + [200.0, 0.0, 50.0]
    engine.send(Parts(2, target=Surface(away, mesh.triangles), version=1), FitTarget(3))
    assert engine.frame(2).target.rms_mm > 100.0
    pose = engine.until(lambda answer: isinstance(answer, TargetPose) and answer.seq == 3)
    laid = away @ pose.rotation.T + pose.shift
    engine.send(Parts(3, target=Surface(laid, mesh.triangles), version=2))
    target = engine.frame(2).target  # the shape is that of the last edit
    assert target.version == 2 and target.max_mm < 0.1 and target.distance.shape == (len(laid),)
    engine.send(Edit(4, sites=np.array([[0, 0]]), sizes_mm=np.array([[6.0, np.nan, np.nan]]), is_dragging=True))
    assert engine.frame(4).target is None


def test_a_target_is_not_laid_on_a_sheet_that_does_not_exist(engine: EnginePipe) -> None:
    engine.send(FitTarget(1))
    assert engine.problem(1).kind == "no target"
