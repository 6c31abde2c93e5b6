"""Undo and redo over whole documents, one step a gesture, and small plans of the last states."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from asterism.pattern.layout.layout import Layout
from asterism.studio.step_words import step_words


@dataclass(frozen=True)
class Step:
    """A state of the document.

    Attributes
    ----------
    revision : number of the state; no two states of a session share it.
    label : what made it; empty for changes of values, which speak for themselves.
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

    Attributes
    ----------
    position : number of the state that is shown.

    Examples
    --------
    >>> history = History({"name": "a"})
    >>> history.push({"name": "b"}, "name")
    1
    >>> history.go(0).table, history.can_undo, history.go(1).table
    ({'name': 'a'}, False, {'name': 'b'})
    """

    def __init__(self, table: dict[str, Any]) -> None:
        self._next = 0
        self._steps = [self._step(table, "Opened")]
        self.position = 0
        self._undone: list[Step] = []  # states that the last push dropped

    def _step(self, table: dict[str, Any], label: str) -> Step:
        step = Step(self._next, label, zlib.compress(json.dumps(table).encode()))
        self._next += 1
        return step

    @property
    def shown(self) -> Step:
        """The state that is shown."""
        return self._steps[self.position]

    @property
    def can_undo(self) -> bool:
        """Whether there is an earlier state."""
        return self.position > 0

    @property
    def can_redo(self) -> bool:
        """Whether a later state was undone."""
        return self.position < len(self._steps) - 1

    @property
    def steps(self) -> tuple[Step, ...]:
        """All states, oldest first."""
        return tuple(self._steps)

    def push(self, table: dict[str, Any], label: str) -> int:
        """Append a state after the shown one, drop those that were undone, and return its revision."""
        self._undone = self._steps[self.position + 1 :]
        del self._steps[self.position + 1 :]
        self._steps.append(self._step(table, label))
        if len(self._steps) > 10_000:
            del self._steps[1]  # the first state stays: undoing everything gives it
        self.position = len(self._steps) - 1
        return self.shown.revision

    def replace(self, table: dict[str, Any]) -> int:
        """Put another table in place of the shown state, and return its revision."""
        self._steps[self.position] = self._step(table, self.shown.label)
        return self.shown.revision

    def drop(self) -> None:
        """Take back the last `push`, as if it had not been made."""
        if self.position:
            self._steps[self.position :] = self._undone
            self._undone = []
            self.position -= 1

    def go(self, position: int) -> Step:
        """Show the state at a position, or the nearest one."""
        self.position = min(max(position, 0), len(self._steps) - 1)
        return self.shown


class Thumbnails:
    """Outline, places and sizes of the stars, by the revision of a state."""

    def __init__(self) -> None:
        self._plans: dict[int, dict[str, Any]] = {}

    def add(self, revision: int, layout: Layout) -> None:
        """Keep the plan of a state; the oldest ones are forgotten."""
        self._plans.pop(revision, None)
        self._plans[revision] = thumbnail(layout)
        for old in list(self._plans)[:-30]:
            del self._plans[old]

    def data(self, history: History) -> list[dict[str, Any]]:
        """The states of a history that have a plan, oldest first: position, revision, what made it, plan (mm)."""
        listed = []
        for position, step in enumerate(history.steps):
            if (plan := self._plans.get(step.revision)) is None:
                continue
            words, before = step.label, history.steps[position - 1]
            if not words:
                known = self._plans.get(before.revision)
                words = step_words(before.table, step.table, () if known is None else (known, plan)) or "No change"
            is_shown = position == history.position
            listed.append(
                {"position": position, "revision": step.revision, "words": words, "is_shown": is_shown, **plan}
            )
        return listed


def thumbnail(layout: Layout) -> dict[str, Any]:
    """Outline, places and sizes of the stars (mm), for a small picture."""
    return {
        "outline_mm": _rounded(layout.outline),
        "at_mm": _rounded(layout.lattice.place(layout.sheet_sites)),
        "sizes_mm": _rounded(layout.site_sizes_mm),
    }


def _rounded(values: Any) -> list[Any]:
    plain: list[Any] = np.round(np.asarray(values, dtype=float), 2).tolist()
    return plain
