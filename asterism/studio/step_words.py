"""What a step of the history has changed, in names and values: `Star length 6 → 7.5 mm, 4 stars`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Array

STAR_SIZES = {"length_mm": "Star length", "thickness_mm": "Star thickness", "width_mm": "Star width"}
NAMES = {"border": "outline"}  # tables of the design file as the page says them
UNITS = {"mm": " mm", "mpa": " MPa", "deg": "°"}
MOST = 3  # statements about one step


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
        if not (has_sizes and path[0] == "stars" and path[-1] in STAR_SIZES):
            said.append(_value_words(path, old, new))
    said = list(dict.fromkeys(said))
    more = f" and {len(said) - MOST} more" if len(said) > MOST else ""
    return "; ".join(said[:MOST]) + more


def _star_words(before: Mapping[str, Any], after: Mapping[str, Any]) -> Iterator[str]:
    """Sizes of stars that stay at their places, removed stars and stars that come back."""
    if before["at_mm"] != after["at_mm"] or not before["at_mm"]:
        return
    old, new = (np.asarray(plan["sizes_mm"], dtype=float) for plan in (before, after))
    was, stays = old[:, 0] > 0.0, new[:, 0] > 0.0
    for which, what in ((was & ~stays, "removed"), (~was & stays, "restored")):
        if count := int(which.sum()):
            yield f"{_plural(count, 'star')} {what}"
    for column, name in enumerate(STAR_SIZES.values()):
        is_other = was & stays & (old[:, column] != new[:, column])
        if count := int(is_other.sum()):
            ranges = " → ".join(_range(sizes[is_other, column]) for sizes in (old, new))
            yield f"{name} {ranges} mm, {_plural(count, 'star')}"


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
    *words, last = [NAMES.get(part, part) for part in path]
    name, _, suffix = last.rpartition("_")
    unit = UNITS.get(suffix, "")
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
