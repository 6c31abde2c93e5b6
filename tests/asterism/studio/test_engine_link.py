"""Processes of the engine: those that end or hang are replaced, and the design goes on with the next one."""

from __future__ import annotations

import asyncio
import multiprocessing
import os
import queue
import signal
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.studio.child import ENGINE, run_child
from asterism.studio.engine_link import EngineLink
from asterism.studio.inbox import Inbox
from asterism.studio.messages import Busy, Edit, Flip, Frame, Ready, ShapeSummary, Sign, StudioProblem
from tests.asterism.studio.engine_pipe import table
from tests.event_loop import run_coroutine

QUICK = "tests.asterism.studio.quick_engines:serve"
PATIENCE_S = 60.0


class Links:
    """A link and what it has passed on."""

    def __init__(self, **options: Any) -> None:
        self.messages: list[Any] = []
        self._changed = asyncio.Event()
        self.link = EngineLink(self._receive, self._changed.set, QUICK, **options)

    def _receive(self, message: Any) -> None:
        self.messages.append(message)
        self._changed.set()

    async def until(self, holds: Callable[[], bool]) -> None:
        async with asyncio.timeout(PATIENCE_S):
            while not holds():
                self.link.watch()
                self._changed.clear()
                try:
                    await asyncio.wait_for(self._changed.wait(), 0.1)
                except TimeoutError:
                    continue

    def frames(self, seq: int) -> list[Frame]:
        return [message for message in self.messages if isinstance(message, Frame) and message.seq == seq]


def run(test: Callable[[Links], Awaitable[None]], **options: Any) -> None:
    async def body() -> None:
        links = Links(**options)
        try:
            await test(links)
        finally:
            links.link.close()

    run_coroutine(body())


@pytest.mark.slow
def test_the_next_engine_is_given_the_form_of_the_last_one_unless_a_design_was_opened(tmp_path: Path):
    mark = tmp_path / "mark"

    async def test(links: Links) -> None:
        links.link.edit(Edit(1, {"name": "a"}, is_opened=True))
        await links.until(lambda: bool(links.frames(1)))
        for seq, is_opened, snapshot in ((2, False, b"12"), (3, True, b"3")):
            mark.touch()
            links.link.edit(Edit(seq, {"die_once": str(mark)}, is_opened=is_opened))
            await links.until(lambda seq=seq: bool(links.frames(seq)))  # type: ignore[misc]
            assert links.frames(seq)[-1].snapshot == snapshot

    run(test, keeps_spare=False)


def test_an_engine_is_ready_only_when_its_answer_has_been_passed_on():
    seen: list[tuple[str, int]] = []

    async def test(links: Links) -> None:
        changed = links.link._changed

        def note() -> None:
            seen.append((links.link.status, len(links.frames(1))))
            changed()

        links.link._changed = note
        links.link.edit(Edit(1, {"name": "a"}))
        await links.until(lambda: bool(links.frames(1)) and links.link.status == "ready")

    run(test)
    assert seen[-1][0] == "ready" and seen[-1][1] > 0


def test_a_search_is_named_until_something_else_is_asked_for():
    async def test(links: Links) -> None:
        links.link.edit(Edit(1, {"name": "a"}))
        await links.until(lambda: links.link.status == "ready")
        assert links.link.searching is None
        links.link.ask(Flip(2))  # the quick engine does not answer it
        assert (links.link.searching, links.link.status) == ("flip", "computing")
        links.link.stop()
        links.link.edit(Edit(3, {"name": "a"}))
        assert links.link.searching is None
        await links.until(lambda: bool(links.frames(3)) and links.link.status == "ready")

    run(test, keeps_spare=False)


@pytest.mark.slow
def test_a_design_that_ends_every_engine_waits_for_another_edit():
    async def test(links: Links) -> None:
        links.link.edit(Edit(1, {"die": True}))
        await links.until(lambda: links.link.status == "failed")
        assert any(isinstance(message, StudioProblem) for message in links.messages)
        assert sum(isinstance(message, Busy) for message in links.messages) == 2  # as many engines have ended
        links.link.edit(Edit(2, {"name": "a"}))
        await links.until(lambda: bool(links.frames(2)) and links.link.status == "ready")

    run(test, keeps_spare=False)


@pytest.mark.slow
def test_closing_ends_all_processes():
    async def test(links: Links) -> None:
        links.link.edit(Edit(1, {"name": "a"}))
        await links.until(lambda: bool(links.frames(1)))
        children = [child for child in (links.link._child, links.link._spare) if child is not None]
        links.link.close()
        assert len(children) == 2 and not any(child.process.is_alive() for child in children)

    run(test)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("failure", "why"),
    [
        ("hang_once", "the preview gave no sign for 5 s and was started again"),
        ("loop_once", "the preview was stuck and was started again"),
    ],
)
def test_an_engine_that_hangs_is_replaced_after_five_seconds_and_that_is_said(
    tmp_path: Path, failure: str, why: str
) -> None:
    mark = tmp_path / "mark"
    mark.touch()

    async def test(links: Links) -> None:
        links.link.edit(Edit(1, {"name": "a"}))
        await links.until(lambda: bool(links.frames(1)))
        begun = time.monotonic()
        links.link.edit(Edit(2, {failure: str(mark)}))
        await links.until(lambda: bool(links.frames(2)))
        assert time.monotonic() - begun < 15.0
        said = [message.what for message in links.messages if isinstance(message, Busy)]
        assert why in said

    run(test)


def waiting(*messages: Any) -> list[Any]:
    """What an inbox hands out that got these messages before anybody asked."""
    pipe: queue.Queue[Any] = queue.Queue()
    for message in messages:
        pipe.put(message)

    def receive() -> Any:
        try:
            return pipe.get_nowait()
        except queue.Empty:
            raise EOFError from None

    inbox = Inbox(receive)
    with inbox._changed:
        assert inbox._changed.wait_for(lambda: inbox.is_closed, 10.0)
    return list(inbox._waiting)


def test_an_edit_of_a_design_that_waits_to_be_opened_opens_it() -> None:
    opened = Edit(1, {"name": "a"}, is_opened=True, snapshot=b"form")
    (edit,) = waiting(opened, Edit(2, {"name": "b"}, is_dragging=True))
    assert (edit.seq, edit.design, edit.is_opened, edit.is_dragging) == (2, {"name": "b"}, True, True)
    assert edit.snapshot == b"form"
    (edit,) = waiting(opened, Edit(2, {"name": "b"}, is_opened=True))
    assert (edit.design, edit.snapshot) == ({"name": "b"}, None)


def test_an_edit_that_follows_a_search_opens_nothing() -> None:
    opened, flip, edit = waiting(Edit(1, {"name": "a"}, is_opened=True), Flip(2), Edit(3, {"name": "a"}))
    assert opened.is_opened and not edit.is_opened and edit.snapshot is None and flip.seq == 2


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
