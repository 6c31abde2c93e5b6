"""Undo and redo over whole documents, one step a gesture; small plans of the last states, and what has changed."""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.pattern.design.stars import SIZE_KEYS, STAR_SIZES
from asterism.pattern.layout.layout import Layout


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
    """

    def __init__(self, table: dict[str, Any]) -> None:
        self._next = 0
        self._steps = [self._step(table, "Opened")]
        self.position = 0
        self._undone: list[Step] = []  # states that the last push dropped
        self._plans: dict[int, dict[str, Any]] = {}  # small ones of the last states, by revision

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

    def push(self, table: dict[str, Any], label: str) -> None:
        """Append a state after the shown one, and drop those that were undone."""
        self._undone = self._steps[self.position + 1 :]
        del self._steps[self.position + 1 :]
        self._steps.append(self._step(table, label))
        if len(self._steps) > 10_000:
            del self._steps[1]  # the first state stays: undoing everything gives it
        self.position = len(self._steps) - 1

    def replace(self, table: dict[str, Any]) -> None:
        """Put another table in place of the shown state."""
        self._steps[self.position] = self._step(table, self.shown.label)

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

    def add_plan(self, layout: Layout) -> None:
        """Keep a small plan of the shown state; the oldest ones are forgotten."""
        self._plans.pop(self.shown.revision, None)
        self._plans[self.shown.revision] = thumbnail(layout)
        for old in list(self._plans)[:-30]:
            del self._plans[old]

    def data(self) -> list[dict[str, Any]]:
        """The states that have a plan, oldest first: position, what made it, whether it is shown, plan (mm)."""
        listed = []
        for position, step in enumerate(self._steps):
            if (plan := self._plans.get(step.revision)) is None:
                continue
            words, before = step.label, self._steps[position - 1]
            if not words:
                known = self._plans.get(before.revision)
                words = step_words(before.table, step.table, () if known is None else (known, plan)) or "No change"
            listed.append({"position": position, "words": words, "is_shown": position == self.position, **plan})
        return listed


def thumbnail(layout: Layout) -> dict[str, Any]:
    """Outline, places and sizes of the stars (mm), for a small picture."""
    return {
        "outline_mm": rounded(layout.outline, 2),
        "at_mm": rounded(layout.lattice.place(layout.sheet_sites), 2),
        "sizes_mm": rounded(layout.site_sizes_mm, 2),
    }


def rounded(values: Any, digits: int = 5) -> list[Any]:
    """An array of floats as lists for a page."""
    plain: list[Any] = np.round(np.asarray(values, dtype=float), digits).tolist()
    return plain


def step_words(before: Mapping[str, Any], after: Mapping[str, Any], plans: tuple[Mapping[str, Any], ...]) -> str:
    """The difference of two tables of a design file.

    Parameters
    ----------
    plans : of both, with the places and sizes of their stars, as `thumbnail` makes them.

    Examples
    --------
    >>> step_words({"fabric": {"stretch": 1.4}}, {"fabric": {"stretch": 1.5}}, ())
    'Fabric stretch 1.4 → 1.5'
    """
    said = [*_star_words(*plans)] if plans else []
    has_sizes = bool(said)
    pins = [*_needle_words(_needles(before), _needles(after))]
    said += pins or ["Supports"] * (before.get("pins") != after.get("pins"))
    for path, (old, new) in sorted(_differences(before, after).items()):
        if path[0] == "pins" or path[:2] == ("stars", "override"):
            continue
        if not (has_sizes and path[0] == "stars" and path[-1] in SIZE_KEYS):
            said.append(_value_words(path, old, new))
    said = list(dict.fromkeys(said))
    return "; ".join(said[:3]) + (f" and {len(said) - 3} more" if len(said) > 3 else "")


def _star_words(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[str]:
    """Sizes of stars that stay at their places, removed stars and stars that come back."""
    if before["at_mm"] != after["at_mm"] or not before["at_mm"]:
        return
    old, new = (np.asarray(plan["sizes_mm"], dtype=float) for plan in (before, after))
    was, stays = old[:, 0] > 0.0, new[:, 0] > 0.0
    for which, what in ((was & ~stays, "removed"), (~was & stays, "restored")):
        if count := int(which.sum()):
            yield f"{_plural(count, 'star')} {what}"
    for column, size in enumerate(STAR_SIZES):
        is_other = was & stays & (old[:, column] != new[:, column])
        if count := int(is_other.sum()):
            ranges = " → ".join(_range(sizes[is_other, column]) for sizes in (old, new))
            yield f"Star {size.name} {ranges} mm, {_plural(count, 'star')}"


def _needles(table: Mapping[str, Any]) -> dict[tuple[float, ...], tuple[float, ...]]:
    """Targets (mm) of needles by their printed points."""
    return {
        tuple(point): tuple(target)
        for pins in table.get("pins", ())
        for point, target in zip(pins.get("points_mm") or (), pins.get("target_mm") or (), strict=False)
    }


def _needle_words(before: Mapping[Any, tuple[float, ...]], after: Mapping[Any, tuple[float, ...]]) -> Iterator[str]:
    for points, others, what in ((after, before, "added"), (before, after, "removed")):
        if count := len(points.keys() - others.keys()):
            yield f"{_plural(count, 'needle')} {what}"
    moved = [point for point in after if point in before and before[point] != after[point]]
    if moved and all(before[point][:2] == after[point][:2] for point in moved):
        ranges = " → ".join(_range(np.array([where[point][2] for point in moved])) for where in (before, after))
        yield f"Height {ranges} mm, {_plural(len(moved), 'needle')}"
    elif moved:
        yield f"{_plural(len(moved), 'needle')} moved"


def _differences(before: Any, after: Any, path: tuple[str, ...] = ()) -> dict[tuple[str, ...], tuple[Any, Any]]:
    """Values that differ, by their path in the tables."""
    if before == after:
        return {}
    if not (isinstance(before, Mapping) and isinstance(after, Mapping)):
        return {path: (before, after)}
    found: dict[tuple[str, ...], tuple[Any, Any]] = {}
    for key in before.keys() | after.keys():
        found |= _differences(before.get(key), after.get(key), (*path, key))
    return found


def _value_words(path: tuple[str, ...], old: Any, new: Any) -> str:
    """One value; of lists and tables the name alone."""
    *words, last = ["outline" if part == "border" else part for part in path]  # as the page says it
    name, _, suffix = last.rpartition("_")
    unit = {"mm": " mm", "mpa": " MPa", "deg": "°"}.get(suffix, "")
    plain = " ".join([*words, name if unit else last]).replace("_", " ")
    plain = plain[:1].upper() + plain[1:]
    if isinstance(old, list | Mapping) or isinstance(new, list | Mapping):
        return plain
    values = " → ".join("none" if value is None else _number(value) for value in (old, new))
    return f"{plain} {values}{unit}"


def _range(values: Array) -> str:
    low, high = (_number(float(value)) for value in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def _number(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _plural(count: int, word: str) -> str:
    return f"{count} {word}{'s' * (count != 1)}"
