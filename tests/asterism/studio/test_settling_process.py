"""The process of exact shapes: in the pose of the page, ended by a newer order, and followed by the release."""

from __future__ import annotations

import multiprocessing
import pickle
import threading
from collections.abc import Iterator
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.pattern.design.design import Design
from asterism.studio.job_processes import run_settling
from asterism.studio.messages import JobProgress, Parts, Released, Settle, Settled, StudioProblem
from tests.asterism.studio.test_job_processes import table

pytestmark = pytest.mark.slow


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


def test_a_design_without_an_exact_shape_is_one_line(ours: Connection) -> None:
    ours.send(Settle(7, table(gravity={"on": True}, pins=[]), ".", None, None, Parts(0)))
    problem = answer(ours)
    assert isinstance(problem, StudioProblem) and problem.seq == 7 and "\n" not in problem.text
