"""The bodies of the processes of jobs: progress in numbers, then the result with its files, or one line."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.studio.job_processes import run_fit, run_verify
from asterism.studio.messages import JobProgress, Settled, StudioProblem, Surface
from asterism.verification.verify import STAGES
from tests.asterism.fitting.surfaces import spherical_cap

QUICK = {"border": {"rings": 1}, "mesh": {"edge_mm": 5.0}}


class Sent:
    """A pipe that keeps what is sent."""

    def __init__(self) -> None:
        self.messages: list[Any] = []

    def send(self, message: Any) -> None:
        self.messages.append(message)


def table(name: str = "dome", **sections: Any) -> dict[str, Any]:
    return asterism.new(name).to_dict() | QUICK | sections


@pytest.mark.slow
def test_a_verification_sends_numbers_and_then_the_exact_shape_beside_the_preview_and_its_files(tmp_path: Path) -> None:
    pipe = Sent()
    run_verify(pipe, 3, table(border={"rings": 2}), ".", str(tmp_path / "out"))
    *reports, result = pipe.messages
    assert all(isinstance(message, JobProgress) for message in reports)
    stages = list(dict.fromkeys(report.stage for report in reports))
    assert stages == ["design", *STAGES, "report"]
    for stage in stages:
        of_stage = [report for report in reports if report.stage == stage]
        done = [report.done for report in of_stage]
        assert done == sorted(done) and done[0] == 0  # never leads back
        assert all(0 <= report.done <= report.of for report in of_stage)
        assert stage != STAGES[1] or len(of_stage) > 2
    seconds = [report.seconds for report in reports]
    assert seconds == sorted(seconds)

    assert isinstance(result, Settled) and result.job == 3
    assert {Path(name).name for name in result.files} == {
        *("report.html", "summary.json"),
        *(f"{sheet}.{kind}" for sheet in ("exact", "preview") for kind in ("vtu", "obj")),
    }
    assert all(Path(name).is_file() for name in result.files)
    exact, preview = (result.frame.arrays[name] for name in ("positions", "before"))
    assert exact.shape == preview.shape == (len(result.frame.mesh_arrays["printed"]), 3)
    # the summary compares cell means, without the stars' bumps
    rms = np.sqrt(np.mean(np.sum((exact - preview) ** 2, axis=1))) / result.summary["diameter_mm"] * 100.0
    assert rms == pytest.approx(result.summary["rms_percent"], rel=0.5)
    assert result.frame.stage == "exact" and result.shown.numbers["is_minimum"]


@pytest.mark.parametrize(
    ("changes", "kind"),
    [({"stars": {"length_mm": 40.0}}, "design"), ({"fabric": {"bending": "none"}}, "law"), ({"pins": 3}, "design")],
)
def test_what_cannot_be_verified_is_a_problem(tmp_path: Path, changes: dict[str, Any], kind: str) -> None:
    pipe = Sent()
    run_verify(pipe, 1, table(**changes), ".", str(tmp_path / "out"))
    problem = pipe.messages[-1]
    assert isinstance(problem, StudioProblem) and (problem.seq, problem.kind) == (1, kind)
    assert not (tmp_path / "out").exists()


def test_a_target_without_a_design_is_one_line() -> None:
    vertices, triangles = spherical_cap(30.0, 40.0)
    sent = Sent()
    run_fit(sent, 2, Surface(vertices, triangles), "cap.stl", "auto", "ultimaker2")
    problem = sent.messages[-1]
    assert isinstance(problem, StudioProblem) and problem.seq == 2
    assert problem.text.startswith("cap.stl: has room for")
