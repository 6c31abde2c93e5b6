"""An engine in the test's own process, with a pipe of queues."""

from __future__ import annotations

import queue
import threading
from typing import Any

import numpy as np

import asterism
from asterism.studio.engine import Engine
from asterism.studio.inbox import Inbox
from asterism.studio.messages import Edit, Frame, ShapeSummary, StudioProblem

PATIENCE_S = 120.0


class EnginePipe:
    """Sends messages to an engine that serves in a thread, and collects its answers."""

    def __init__(self) -> None:
        self._to: queue.Queue[Any] = queue.Queue()
        self._back: queue.Queue[Any] = queue.Queue()
        self.answers: list[Any] = []
        engine = Engine(Inbox(self._receive), self._back.put)
        self._thread = threading.Thread(target=engine.serve, daemon=True)
        self._thread.start()

    def _receive(self) -> Any:
        """The next message to the engine; the pipe ends with None."""
        if (message := self._to.get()) is None:
            raise EOFError
        return message

    def send(self, *messages: Any) -> None:
        for message in messages:
            self._to.put(message)

    def until(self, ends: Any) -> Any:
        """The next answer for which `ends` is true; all answers are kept."""
        while True:
            answer = self._back.get(timeout=PATIENCE_S)
            self.answers.append(answer)
            if ends(answer):
                return answer

    def frame(self, seq: int, stage: str = "equilibrium") -> Frame:
        """The next frame of a message."""
        return self.until(lambda answer: isinstance(answer, Frame) and (answer.seq, answer.stage) == (seq, stage))

    def show(self, seq: int, design: dict[str, Any], *stroke: Any, **options: Any) -> Frame:
        """Send an edit; the frame of its equilibrium."""
        self.send(Edit(seq, design, *stroke, **options))
        return self.frame(seq)

    def rest(self, seq: int, design: dict[str, Any], *stroke: Any, **options: Any) -> ShapeSummary:
        """Send an edit; its summary."""
        self.send(Edit(seq, design, *stroke, **options))
        return self.summary(seq)

    def meshes(self) -> dict[int, dict[str, Any]]:
        """The arrays of the meshes so far, by number."""
        return {answer.mesh: answer.mesh_arrays for answer in self.answers if isinstance(answer, Frame)}

    def summary(self, seq: int) -> ShapeSummary:
        """The summary of a message."""
        return self.until(lambda answer: isinstance(answer, ShapeSummary) and answer.seq == seq)

    def problem(self, seq: int) -> StudioProblem:
        """The problem of a message."""
        return self.until(lambda answer: isinstance(answer, StudioProblem) and answer.seq == seq)

    def close(self) -> None:
        self._to.put(None)
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive()


def is_same_shape(one: Frame, other: Frame) -> bool:
    return np.allclose(one.arrays["positions"], other.arrays["positions"], rtol=0.0, atol=1e-4)


def table(name: str = "dome", **sections: Any) -> dict[str, Any]:
    data = asterism.new(name).to_dict() | {"mesh": {"edge_mm": 4.0}}
    for section, entries in sections.items():
        data[section] = data[section] | entries if isinstance(entries, dict) else entries
    return data
