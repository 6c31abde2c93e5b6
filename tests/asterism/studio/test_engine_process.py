"""The engine in a process of its own."""

from __future__ import annotations

import multiprocessing
import os
import signal
from typing import Any

import numpy as np
import pytest

from asterism.studio.child import ENGINE, run_child
from asterism.studio.messages import Edit, Frame, Ready, ShapeSummary, Sign
from tests.asterism.studio.engine_pipe import table

START_S = 180.0


@pytest.mark.slow
def test_an_engine_serves_in_a_process_gives_signs_and_ends_with_its_pipe() -> None:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=run_child, args=(ENGINE, 0, theirs), daemon=True)
    process.start()
    theirs.close()
    design = table(border={"rings": 2})
    ours.send(Edit(1, design))
    answers: list[Any] = []
    while not (answers and isinstance(answers[-1], ShapeSummary)):
        assert ours.poll(START_S)
        answers.append(ours.recv())
    assert any(isinstance(answer, Ready) for answer in answers)
    frame = next(answer for answer in answers if isinstance(answer, Frame))
    # forms travel to the server and back
    ours.send(Edit(2, design, is_opened=True, snapshot=frame.snapshot))
    while not (isinstance(answers[-1], Frame) and answers[-1].seq == 2):
        assert ours.poll(START_S)
        answers.append(ours.recv())
    assert np.abs(answers[-1].arrays["positions"] - frame.arrays["positions"]).max() < 1e-4
    if hasattr(signal, "SIGSTOP"):  # it gives signs until it hangs
        assert process.pid is not None
        while not isinstance(ours.recv(), Sign):
            assert ours.poll(START_S)
        os.kill(process.pid, signal.SIGSTOP)
        while ours.poll(0.1):
            ours.recv()
        assert not ours.poll(3.0)
        os.kill(process.pid, signal.SIGCONT)
    ours.close()
    process.join(START_S)
    assert process.exitcode == 0
