"""What a reader of a format gives: lines, the unit of their numbers, and counts of what was left out."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error

MM_OF_UNITS = {"mm": 1.0, "cm": 10.0, "in": 25.4, "px": 25.4 / 96.0, "pt": 25.4 / 72.0}
# groups, blocks and what they use, within each other
MAX_DEPTH = 100
# elements of a drawing after all that is used stands in its place
MAX_ELEMENTS = 100_000


class DrawingError(Error, ValueError):
    """A drawing that cannot be read; the message is one line that does not name the file."""


class NoUnitError(DrawingError):
    """A drawing without a unit of length; it can be read with one."""

    def __init__(self, problem: str, sizes: str) -> None:
        super().__init__(f"{problem}, or its unit here: units = {sizes}")
        self.problem = problem  # the message without the sizes that units give


class DrawingWarning(UserWarning):
    """A part of a drawing is left out."""


@dataclass(frozen=True)
class FileLine:
    """One line of a drawing."""

    points: Floats  # (n, 2) mm, y upwards; the last is the first if it is closed
    layer: str  # name of its layer
    width_mm: float | None  # of its stroke, or of the polyline in DXF; None if the file gives none
    name: str = "line"  # of the entity, for messages
    unevenness: float = 1.0  # of a stroke that a transform has stretched: the largest width over the least

    @property
    def is_closed(self) -> bool:
        """Whether it returns to its first point."""
        return len(self.points) > 3 and np.array_equal(self.points[0], self.points[-1])


@dataclass(frozen=True)
class Source:
    """An open file."""

    mm: float | None  # length of its unit; None if it says none
    problem: str  # what is wrong with the unit, if it says none
    is_silent: bool  # it says nothing at all about its size
    # the visible lines in the unit of the file, for the largest distance of a curve from its polyline; what is not read
    # is counted by its name, as `text|s`.
    lines: Callable[[float, Counter[str]], Iterator[FileLine]]


def checked(points: Floats, layer: str, name: str) -> Floats:
    """The points, if all of them can be places."""
    # larger numbers are no places
    if not (np.abs(points) <= 1e9).all():
        raise DrawingError(f"holds places that are no sensible numbers: {name} in layer {layer!r}")
    return points
