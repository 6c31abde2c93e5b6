"""The numbers of designs beside each other, and the entries in which they differ."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from asterism.print.job import Job
from asterism.results.compared import COMPARED_KEYS
from asterism.results.words import box_in_words
from asterism.shape.shape import Shape

# longer entries of a design are shortened
MAX_ENTRY_CHARACTERS = 100


@dataclass(frozen=True)
class ComparedDesign:
    """One of several designs.

    Attributes
    ----------
    name : its heading.
    job : the design on the printer's bed.
    shape : its shape; None if it has none.
    problem : why it has no shape; empty if it has one.
    distance_mm : rms distance of the surface from that of the first design at the same printed points, after the free
        motions; None if the sheets are printed differently, and for the first design.
    """

    name: str
    job: Job
    shape: Shape | None
    problem: str = ""
    distance_mm: float | None = None

    @property
    def summary(self) -> Mapping[str, Any]:
        """Summary of the shape; empty without one."""
        return {} if self.shape is None else self.shape.summary


@dataclass(frozen=True)
class ComparedNumber:
    """One row: a number of each design.

    Attributes
    ----------
    label : with the unit.
    values : numbers; None where a design has none.
    texts : the same in words.
    digits : of the numbers after the point.
    """

    label: str
    values: tuple[float | None, ...]
    texts: tuple[str, ...]
    digits: int = 0

    def with_differences(self) -> list[str]:
        """The texts, with the difference from the first design where these digits show one."""
        first = self.values[0]
        cells = [self.texts[0]]
        for value, text in zip(self.values[1:], self.texts[1:], strict=True):
            change = 0.0 if value is None or first is None else round(value - first, self.digits)
            if change and first:
                text += f" ({change:+.{self.digits}f}, {100.0 * change / first:+.0f} %)"
            elif change:
                text += f" ({change:+.{self.digits}f})"
            cells.append(text)
        return cells


def compared_numbers(designs: Sequence[ComparedDesign]) -> list[ComparedNumber]:
    """The rows: size, print, accuracy; a row without any number is left out."""

    def of(key: str) -> Callable[[ComparedDesign], float | None]:
        return lambda each: each.summary.get(key)

    rows = [
        _row(designs, "height, mm", of(COMPARED_KEYS[0]), 1),
        _sizes(designs, "finished size, mm", lambda each: each.summary.get(COMPARED_KEYS[1])),
        _sizes(designs, "printed size, mm", lambda each: _printed(each.job)),
        _row(designs, "rise over the needles, mm", of("above_needles_mm"), 1),
        _row(designs, "depth below the needles, mm", of("below_needles_mm"), 1),
        _row(designs, "contraction", of(COMPARED_KEYS[4]), 4),
        _row(designs, "estimated error of the surface, % of the diameter", of(COMPARED_KEYS[2]), 1),
        _row(designs, "estimated error of the height, mm", lambda each: _height_error(each.summary), 1),
        _row(designs, "mesh error, % of the diameter", of("mesh_error_percent"), 1),
        _row(designs, "distance from the first surface, rms, mm", lambda each: each.distance_mm, 2),
        _row(designs, "stars", lambda each: float(len(each.job.plan.centres)) or None, 0),
        _row(designs, "drawn rods", lambda each: float(len(each.job.plan.drawn_rods)) or None, 0),
        _row(designs, "needles", lambda each: float(len(each.job.needles)), 0),
        _row(designs, "print time, minutes", lambda each: each.job.cost.minutes, 0),
        _row(designs, "plastic, g", lambda each: each.job.cost.mass_g, 1),
        _row(designs, "filament, m", lambda each: each.job.cost.filament_m, 2),
    ]
    return [row for row in rows if any(text != "-" for text in row.texts)]


def differing_entries(designs: Sequence[ComparedDesign]) -> list[tuple[str, list[str]]]:
    """Paths of the entries in which the designs differ, names aside, and the entry of each design."""
    tables = [dict(_entries(each.job.drawn.to_dict())) for each in designs]
    paths = dict.fromkeys(path for table in tables for path in table if path != "name")
    rows = [(path, [table.get(path, "-") for table in tables]) for path in paths]
    return [(path, texts) for path, texts in rows if len(set(texts)) > 1]


def _row(
    designs: Sequence[ComparedDesign], label: str, of: Callable[[ComparedDesign], float | None], digits: int
) -> ComparedNumber:
    values = tuple(map(of, designs))
    texts = tuple("-" if value is None else f"{value:.{digits}f}" for value in values)
    return ComparedNumber(label, values, texts, digits)


def _sizes(
    designs: Sequence[ComparedDesign], label: str, of: Callable[[ComparedDesign], Sequence[float] | None]
) -> ComparedNumber:
    """A row of boxes, whose differences are not numbers."""
    texts = tuple("-" if (sizes := of(each)) is None else box_in_words(sizes).removesuffix(" mm") for each in designs)
    return ComparedNumber(label, (None,) * len(designs), texts)


def _printed(job: Job) -> list[float]:
    low, high = job.plan.outline.min(axis=0), job.plan.outline.max(axis=0)
    return [float(side) for side in high - low]


def _height_error(summary: Mapping[str, Any]) -> float | None:
    percent = summary.get(COMPARED_KEYS[3])
    return None if percent is None else percent / 100.0 * summary["height_mm"]


def _entries(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Dotted paths and texts of all entries of a table; lists of numbers are one entry."""
    if isinstance(value, Mapping) and value:
        for key, inner in value.items():
            yield from _entries(inner, f"{path}.{key}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], Mapping):
        for number, inner in enumerate(value):
            yield from _entries(inner, f"{path}.{number}")
    else:
        text = json.dumps(value, ensure_ascii=False)
        yield (
            path,
            text
            if len(text) <= MAX_ENTRY_CHARACTERS
            else f"{text[:MAX_ENTRY_CHARACTERS]} ... ({len(text)} characters)",
        )
