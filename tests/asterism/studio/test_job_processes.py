"""The processes of jobs and of exact shapes: progress in numbers, then the result with its files, or one line."""

from __future__ import annotations

import multiprocessing
import pickle
import threading
from collections.abc import Iterator
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.pattern.design.design import Design
from asterism.studio.job_processes import run_fit, run_settling, run_verify
from asterism.studio.messages import JobProgress, Parts, Released, Settle, Settled, StudioProblem, Surface
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


def run_until_closed(connection: Connection) -> None:
    with suppress(EOFError):
        run_settling(connection)


@pytest.fixture
def ours() -> Iterator[Connection]:
    here, there = multiprocessing.Pipe()
    threading.Thread(target=run_until_closed, args=(there,), daemon=True).start()
    yield here
    here.close()


def answer(ours: Connection) -> Any:
    """The next message that is no progress."""
    while isinstance(message := ours.recv(), JobProgress):
        pass
    return message


@pytest.mark.slow
def test_exact_shapes_come_in_the_pose_of_the_page_and_a_newer_one_ends_the_last(ours: Connection) -> None:
    large = table(border={"rings": 3}, mesh={})
    small = table(pins=[])
    near = asterism.preview(Design.from_dict(small))
    turned = near.positions @ np.diag([-1.0, -1.0, 1.0]) + [0.0, 0.0, 7.0]
    orders = [
        Settle(1, large, ".", None, None, Parts(0)),
        Settle(2, small, ".", pickle.dumps(near), (near.printed, turned), Parts(0, smooth=True)),
    ]
    ours.send(orders[0])
    first = ours.recv()
    assert isinstance(first, JobProgress) and first.job == 1
    ours.send(orders[1])
    message = answer(ours)
    assert isinstance(message, Settled)
    frame = message.frame
    assert message.job == 2 and frame.stage == "exact" and frame.is_minimum
    assert {"before", "smooth"} < frame.arrays.keys()
    before = near.at(frame.mesh_arrays["printed"].astype(float), 0.1) @ np.diag([-1.0, -1.0, 1.0]) + [0.0, 0.0, 7.0]
    assert frame.arrays["before"] == pytest.approx(before, abs=0.05)
    gaps = np.linalg.norm(frame.arrays["positions"] - frame.arrays["before"], axis=1)
    assert gaps.max() < 0.1 * np.ptp(turned[:, 0])
    assert np.ptp(frame.arrays["smooth"][:, 0]) == pytest.approx(np.ptp(frame.arrays["positions"][:, 0]), rel=0.1)
    exact = pickle.loads(message.shape)
    assert message.shown.numbers["height_mm"] == exact.summary["height_mm"]


@pytest.mark.slow
@pytest.mark.parametrize("is_same", [True, False])
def test_the_release_follows_and_says_whether_a_print_takes_another_form(ours: Connection, is_same: bool) -> None:
    # the border holds the larger sheet so narrow that it has a form on either side
    sections = {"pins": []} if is_same else {"border": {"rings": 2}, "pins": [{"where": "border", "scale": 0.7}]}
    held = table(**sections)
    near = asterism.preview(Design.from_dict(held), side="auto" if is_same else "up")
    order = Settle(1, held, ".", pickle.dumps(near), None, Parts(0), release=True)
    ours.send(order)
    settled, released = answer(ours), answer(ours)
    assert isinstance(settled, Settled) and isinstance(released, Released) and released.job == 1
    assert released.is_same is is_same
    if is_same:
        assert released.other is None
    else:
        assert released.other is not None and released.apart_percent > 2.0
        energies = [pickle.loads(message.shape).summary["energy_n_mm"] for message in (settled, released.other)]
        assert released.energy_percent == pytest.approx(100.0 * (energies[1] / energies[0] - 1.0))
    # the same design with other parts is not computed again
    ours.send(Settle(3, held, ".", order.near, None, Parts(0, smooth=True, version=1), release=True))
    assert isinstance(ours.recv(), Settled) and isinstance(ours.recv(), Released)


@pytest.mark.slow
def test_a_design_without_an_exact_shape_is_one_line(ours: Connection) -> None:
    ours.send(Settle(7, table(gravity={"on": True}, pins=[]), ".", None, None, Parts(0)))
    problem = answer(ours)
    assert isinstance(problem, StudioProblem) and problem.seq == 7 and "\n" not in problem.text
