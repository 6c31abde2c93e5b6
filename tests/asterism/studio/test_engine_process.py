"""The engine in a process of its own, and random edits, of which none ends in an error."""

from __future__ import annotations

import multiprocessing
import os
import signal
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.pattern.layout.build import layout
from asterism.studio.child import ENGINE, run_child
from asterism.studio.messages import Edit, Flip, Frame, Ready, ShapeSummary, ShowForm, Sign, StudioProblem
from tests.asterism.studio.engine_pipe import EnginePipe

START_S = 180.0


def table(**sections: Any) -> dict[str, Any]:
    return asterism.new("dome").to_dict() | {"border": {"rings": 2}, "mesh": {"edge_mm": 5.0}} | sections


class Sketcher:
    """Asks an engine for random edits of one design, with sizes that have a law: to learn one takes minutes."""

    def __init__(self) -> None:
        self.rng = np.random.default_rng(0)
        self.table = table()
        plan = layout(asterism.Design.from_dict(self.table))
        self.sites, self.corners = plan.sheet_sites, plan.outline
        self.sizes = np.full((len(self.sites), 3), np.nan)
        self.removed = np.zeros(len(self.sites), dtype=bool)
        self.snapshots: list[Any] = []

    def message(self, seq: int) -> Any:
        rng, kind = self.rng, self.rng.integers(10)
        if kind == 0:
            return Flip(seq)
        if kind == 1:
            return ShowForm(seq, int(rng.integers(2)))
        snapshot = None
        star = rng.integers(len(self.sites))
        match kind:
            case 2 | 3:
                self.sizes[rng.integers(len(self.sites), size=4), 0] = rng.uniform(4.0, 9.5)
            case 4:
                self.sizes[star] = rng.uniform([4.0, 0.25, 1.0], [9.5, 0.5, 1.4])
            case 5:
                self.removed[star] ^= True
            case 6:
                corners = self.corners.copy()
                corners[rng.integers(len(corners))] += rng.normal(size=2) * 8.0
                self.table = self.table | {"border": {"polygon_mm": corners.tolist()}}
            case 7:
                points = self.corners[rng.permutation(6)[: rng.integers(1, 5)]] * 0.8
                target = np.column_stack([0.8 * points, rng.normal(size=len(points)) * 8.0])
                self.table = self.table | {"pins": [{"points_mm": points.tolist(), "target_mm": target.tolist()}]}
            case 8:
                pins = [{"where": "border", "scale": float(rng.uniform(0.6, 1.0))}] if rng.random() < 0.7 else []
                self.table = self.table | {"pins": pins}
            case 9 if self.snapshots:
                snapshot = self.snapshots[rng.integers(len(self.snapshots))]
        painted = ~np.isnan(self.sizes).all(axis=1)
        return Edit(
            seq,
            self.table,
            self.sites[painted],
            self.sizes[painted],
            self.sites[self.removed],
            is_dragging=bool(rng.random() < 0.3),
            is_opened=snapshot is not None,
            snapshot=snapshot,
        )


@pytest.mark.slow
def test_random_edits_have_a_shape_or_a_reason() -> None:
    engine, sketcher = EnginePipe(), Sketcher()
    engine.send(Edit(1, sketcher.table))
    first = engine.frame(1)
    for seq in range(2, 42):
        engine.send(sketcher.message(seq))
        answer = engine.until(
            lambda answer, seq=seq: (
                isinstance(answer, StudioProblem)
                or (isinstance(answer, Frame) and answer.seq == seq and answer.stage == "equilibrium")
            )
        )
        if isinstance(answer, StudioProblem):
            assert answer.seq == seq and answer.kind != "error", answer.text
            continue
        assert all(np.isfinite(part).all() for part in answer.arrays.values())
        if answer.snapshot is not None:
            sketcher.snapshots.append(answer.snapshot)
    # all undone: the first form
    engine.send(Edit(50, table(), is_opened=True, snapshot=first.snapshot))
    assert engine.frame(50).arrays["positions"] == pytest.approx(first.arrays["positions"], abs=1e-3)
    engine.close()


@pytest.mark.slow
def test_an_engine_serves_in_a_process_gives_signs_and_ends_with_its_pipe() -> None:
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=run_child, args=(ENGINE, 0, theirs), daemon=True)
    process.start()
    theirs.close()
    ours.send(Edit(1, table()))
    answers: list[Any] = []
    while not (answers and isinstance(answers[-1], ShapeSummary)):
        assert ours.poll(START_S)
        answers.append(ours.recv())
    assert any(isinstance(answer, Ready) for answer in answers)
    frame = next(answer for answer in answers if isinstance(answer, Frame))
    # forms travel to the server and back
    ours.send(Edit(2, table(), is_opened=True, snapshot=frame.snapshot))
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
