"""The body of a fit's process: progress in numbers, the design and the pose, or one line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.studio.engine_orders import Surface
from asterism.studio.fitter import run_fit
from asterism.studio.job_messages import Fitted, JobProgress
from asterism.studio.messages import StudioProblem
from tests.asterism.fitting.surfaces import spherical_cap


class Sent:
    """The end of a pipe, which keeps what is sent."""

    def __init__(self) -> None:
        self.messages: list[Any] = []

    def send(self, message: Any) -> None:
        self.messages.append(message)


@pytest.mark.slow
def test_a_fit_sends_progress_and_a_design() -> None:
    vertices, triangles = spherical_cap(30.0, 84.0)
    sent = Sent()
    run_fit(sent, 7, Surface(vertices + 300.0, triangles), "cap", "auto", "ultimaker2")  # type: ignore[arg-type]
    *progress, last = sent.messages
    assert all(isinstance(message, JobProgress) and message.job == 7 for message in progress)
    assert any("% of the diameter" in message.stage for message in progress)
    assert isinstance(last, Fitted) and last.job == 7
    design = Design.from_dict(last.table)
    assert design.stars.rounding is not None and len(design.pins) == 1
    # the needles stand on the target in its pose
    placed = (vertices + 300.0) @ last.rotation.T + last.shift
    for place in np.asarray(last.table["pins"][0]["target_mm"]):
        assert np.linalg.norm(placed - place, axis=1).min() < 3.0
    assert "design" not in last.summary and last.summary["preview"]["mean_percent"] < 1.0


def test_a_target_without_a_design_is_one_line() -> None:
    vertices, triangles = spherical_cap(30.0, 40.0)
    sent = Sent()
    run_fit(sent, 2, Surface(vertices, triangles), "cap.stl", "auto", "ultimaker2")  # type: ignore[arg-type]
    problem = sent.messages[-1]
    assert isinstance(problem, StudioProblem) and problem.seq == 2
    assert problem.text.startswith("cap.stl: has room for")
