"""Entries of a design's table by dotted paths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import is_deep

MAX_STEPS = 20


def with_entries(table: Mapping[str, Any], entries: Mapping[str, Any]) -> dict[str, Any]:
    """The table of a design with other values at dotted paths; the table itself stays as it is.

    Raises `DesignError` if a path leads through an entry that is no table or list, or beyond the end of a list.

    `entries`: values by paths such as `fabric.stretch`, `border` or `rods.draw.0.width_mm`; None takes a key away.
    Missing tables on the way are made.

    >>> with_entries({"name": "a", "fabric": {"stretch": 1.35}}, {"fabric.stretch": 1.75, "name": None})
    {'fabric': {'stretch': 1.75}}
    >>> with_entries({"rods": {"draw": [{"width_mm": 1.0}]}}, {"rods.draw.0.width_mm": 2.0})
    {'rods': {'draw': [{'width_mm': 2.0}]}}
    """
    changed = dict(table)
    for path, value in entries.items():
        steps = path.split(".") if isinstance(path, str) else []
        if not 1 <= len(steps) <= MAX_STEPS or not all(steps):
            raise DesignError("", "must be a key of the design file, as fabric.stretch", path)
        if is_deep(value):
            raise DesignError(path, "is nested too deeply")
        place: Any = changed
        for count, step in enumerate(steps, 1):
            at: Any = _position(place, step, ".".join(steps[: count - 1])) if isinstance(place, list) else step
            if count < len(steps):
                inner = place[at] if isinstance(place, list) else place.get(at)
                if not isinstance(inner, dict | list | None):
                    here = ".".join(steps[:count])
                    raise DesignError(path, f"{here} is {inner!r}, which has no {steps[count]!r}")
                place[at] = {} if inner is None else inner.copy()
                place = place[at]
            elif value is None and isinstance(place, dict):
                place.pop(at, None)
            else:
                place[at] = value
    return changed


def _position(place: list[Any], step: str, path: str) -> int:
    if not step.isdecimal() or int(step) >= len(place):
        has = f"0 to {len(place) - 1}" if place else "no entry"
        raise DesignError(f"{path}.{step}", f"{path} is a list, with {has}")
    return int(step)
