"""Undo and redo over whole documents: one step a gesture."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass
from typing import Any

MAX_STEPS = 10_000


@dataclass(frozen=True)
class Step:
    """A state of the document.

    Attributes
    ----------
    revision : number of the state; no two states of a session share it.
    label : what made it, in a word or two.
    packed : its table as compressed JSON, about 2 kB for 100 painted stars.
    """

    revision: int
    label: str
    packed: bytes

    @property
    def table(self) -> dict[str, Any]:
        """The table of the design file."""
        table: dict[str, Any] = json.loads(zlib.decompress(self.packed))
        return table


class History:
    """States of a document, oldest first, with the one that is shown.

    Examples
    --------
    >>> history = History({"name": "a"})
    >>> history.push({"name": "b"}, "name")
    1
    >>> history.undo().table, history.can_undo, history.redo().table
    ({'name': 'a'}, False, {'name': 'b'})
    """

    def __init__(self, table: dict[str, Any]) -> None:
        self._next = 0
        self._steps = [self._step(table, "opened")]
        self._shown = 0
        self._undone: list[Step] = []  # states that the last push dropped

    def _step(self, table: dict[str, Any], label: str) -> Step:
        step = Step(self._next, label, zlib.compress(json.dumps(table).encode()))
        self._next += 1
        return step

    @property
    def shown(self) -> Step:
        """The state that is shown."""
        return self._steps[self._shown]

    @property
    def can_undo(self) -> bool:
        """Whether there is an earlier state."""
        return self._shown > 0

    @property
    def can_redo(self) -> bool:
        """Whether a later state was undone."""
        return self._shown < len(self._steps) - 1

    @property
    def steps(self) -> tuple[Step, ...]:
        """All states, oldest first."""
        return tuple(self._steps)

    @property
    def labels(self) -> list[str]:
        """What made each state, oldest first."""
        return [step.label for step in self._steps]

    @property
    def position(self) -> int:
        """Number of the state that is shown."""
        return self._shown

    def push(self, table: dict[str, Any], label: str) -> int:
        """Append a state after the shown one, drop those that were undone, and return its revision."""
        self._undone = self._steps[self._shown + 1 :]
        del self._steps[self._shown + 1 :]
        self._steps.append(self._step(table, label))
        if len(self._steps) > MAX_STEPS:
            del self._steps[1]  # the first state stays: undoing everything gives it
        self._shown = len(self._steps) - 1
        return self.shown.revision

    def replace(self, table: dict[str, Any]) -> int:
        """Put another table in place of the shown state, and return its revision."""
        self._steps[self._shown] = self._step(table, self.shown.label)
        return self.shown.revision

    def drop(self) -> None:
        """Take back the last `push`, as if it had not been made."""
        if self._shown:
            self._steps[self._shown :] = self._undone
            self._undone = []
            self._shown -= 1

    def go(self, position: int) -> Step:
        """Show the state at a position, or the nearest one."""
        self._shown = min(max(position, 0), len(self._steps) - 1)
        return self.shown

    def undo(self) -> Step:
        """Show the state before, if there is one."""
        return self.go(self._shown - 1)

    def redo(self) -> Step:
        """Show the state after, if there is one."""
        return self.go(self._shown + 1)
