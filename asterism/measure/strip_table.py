"""Reads the table of measured strips, whose arcs lie in boxes; all in mm and 1/mm."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.stars import THICKNESS_RANGE_MM
from asterism.process.settings import StripFitSettings
from asterism.results.csv_table import Row, TableError, read_rows

# columns that are known before the measurement
KNOWN_COLUMNS = ("strip", "thickness_mm", "length_mm", "stretch", "fabric_thickness_mm")
# direction of the strip on fabric with a grain, in tables of both directions
DIRECTION_COLUMN = "direction"
Direction = Literal["along", "across"]
DIRECTIONS: tuple[Direction, ...] = get_args(Direction)
# columns of the boxes around the arcs
BOX_COLUMNS = ("box_width_mm", "box_height_mm", "peeled_box_width_mm", "peeled_box_height_mm")
# curvatures may replace boxes
STRIP_COLUMNS = (*KNOWN_COLUMNS, DIRECTION_COLUMN, *BOX_COLUMNS, "curvature_per_mm", "peeled_curvature_per_mm")
# allowed values; a shorter strip is given in another unit or hardly bends
_RANGES = {
    "thickness_mm": THICKNESS_RANGE_MM,
    "length_mm": (10.0, 1000.0),
    "stretch": (1.01, 3.0),
    "fabric_thickness_mm": (0.01, 10.0),
}


@dataclass(frozen=True)
class Reading:
    """The measured arc of a strip, with fabric or peeled."""

    strip: str  # name of the strip
    row: int  # row of the table; the header is row 1
    thickness_mm: float  # of the plastic
    length_mm: float
    stretch: float  # of the fabric
    fabric_thickness_mm: float  # of the released fabric
    peeled: bool  # measured without fabric
    curvature_per_mm: float | None  # positive if the plastic is outside; None for a strip that looks flat
    left_out: str | None = None  # why this reading is not used; None if it is used
    step_mm: float = 0.0  # step of the ruler to which the sides of the box are rounded; 0 if unknown
    direction: Direction | None = None  # of the strip to the grain of the fabric; None in tables without directions

    @property
    def name(self) -> str:
        """Name of the reading in messages."""
        return f"strip {self.strip} {'peeled' if self.peeled else 'with fabric'}"


Box = tuple[float, float]
Measured = tuple[Reading, Box | None]


def read_strips(path: Path, settings: StripFitSettings) -> list[Reading]:
    """Read the table of measured strips, with the stretch and the thickness of the fabric that it does not have.

    Raises TableError: the table is wrong; the message names file, row and column.
    """
    rows = read_rows(path, STRIP_COLUMNS, ("strip", "thickness_mm", "length_mm"))
    if not rows:
        raise TableError(path, None, None, "has a header but no strips")
    given = {
        "stretch": ("--stretch", settings.stretch),
        "fabric_thickness_mm": ("--fabric-thickness", settings.fabric_thickness_mm),
    }
    seen: dict[str, int] = {}
    measured: list[Measured] = []
    for row in rows:
        name = row.cells.get("strip", "")
        if not name:
            raise row.wrong("strip", "every strip needs a name or number")
        if name in seen:
            raise row.wrong("strip", f"{name!r} is already in row {seen[name]}")
        seen[name] = row.number
        measured += _readings(row, name, given, settings.outside)
    if not measured:
        raise TableError(path, None, None, "no strip has been measured yet: fill in the boxes or curvatures")
    _check_not_swapped(rows, [reading for reading, _ in measured])
    _check_directions(rows)
    step = _ruler_step([side for _, box in measured for side in box or ()])
    return [replace(reading, step_mm=step) if box else reading for reading, box in measured]


def _ruler_step(sides: list[float]) -> float:
    """Largest step of a ruler (mm) whose multiples all sides are; 0 for few sides and for finer steps."""
    steps = (1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02, 0.01) if len(sides) >= 6 else ()
    return next((step for step in steps if all(abs(side / step - round(side / step)) < 1e-6 for side in sides)), 0.0)


def _readings(row: Row, name: str, given: dict[str, tuple[str, float | None]], outside: bool) -> list[Measured]:
    """The readings of one row with their boxes: none, one (with fabric or peeled), or both."""
    thickness, length, stretch, fabric = (_known(row, column, *given.get(column, ("", None))) for column in _RANGES)
    lies = row.cells.get(DIRECTION_COLUMN, "").lower()
    direction = next((each for each in DIRECTIONS if each == lies), None)
    if lies and direction is None:
        raise row.wrong(DIRECTION_COLUMN, f"must be along or across the grain of the fabric, not {lies!r}")
    readings: list[Measured] = []
    for prefix in ("", "peeled_"):
        peeled = bool(prefix)
        curvature = row.number_in(f"{prefix}curvature_per_mm", -1.0 if peeled else 0.0, 1.0, "1/mm")
        boxed = any(row.cells.get(f"{prefix}box_{side}_mm") for side in ("width", "height"))
        if curvature is not None and boxed:
            raise row.wrong(f"{prefix}curvature_per_mm", "give the box or the curvature, not both")
        reading = Reading(
            name, row.number, thickness, length, stretch, fabric, peeled, curvature or None, direction=direction
        )
        if boxed:
            around = thickness + (0.0 if peeled else fabric) if outside else 0.0
            readings.append(_boxed(row, prefix, reading, around))
        elif curvature is not None:
            readings.append((reading, None))
    return readings


def _known(row: Row, column: str, option: str, default: float | None) -> float:
    """A value that is known before the measurement, from the table or from an option."""
    if default is not None and (text := row.cells.get(column)):
        problem = f"is {text}, and {option} is {default:g}: {option} is for tables without this column"
        raise row.wrong(column, problem)
    value = row.number_in(column, *_RANGES[column], "" if column == "stretch" else "mm")
    if value is None and default is None:
        raise row.wrong(column, f"is empty; fill it in or give {option}" if option else "is empty")
    return float(default if value is None else value)  # type: ignore[arg-type]


def _boxed(row: Row, prefix: str, reading: Reading, around: float) -> Measured:
    """The reading from a box; `around` is the thickness (mm) that the box includes."""
    across, up = f"{prefix}box_width_mm", f"{prefix}box_height_mm"
    if row.cells.get(up, "").lower() == "flat":
        return reading, None
    height = row.number_in(up, 0.0, 2000.0)
    width = row.number_in(across, 0.1, 2000.0)
    if width is None or height is None:
        raise row.wrong(across if width is None else up, "is empty, but the other side of the box is given")
    # a box is at most as high as wide, but that of a strip that is nearly a circle may be read higher
    if height > 1.02 * width + 1.0:
        raise row.wrong(up, f"{height:g} must be at most the width {width:g}: the width lies along the arc's chord")
    box = width, height
    height = min(height, width)
    if around:
        try:
            width, height = line_box(width, height, around)
        except ValueError as error:
            raise row.wrong(across, str(error)) from None
    # a reading is left out if the arc of its box differs from the length of the strip by more than this part
    length, tolerance = reading.length_mm, 0.1
    arc_mm = float(arc_length(width, height))
    for unit, factor in (("inches", 25.4), ("centimetres", 10.0), ("metres", 1000.0)):
        if abs(arc_mm / length / factor - 1) < tolerance and unit != "metres":
            problem = f"{length:g} must be the length in mm, about {arc_mm:.0f} by its box; is it in {unit}?"
            raise row.wrong("length_mm", problem)
        if abs(arc_mm / length * factor - 1) < tolerance:
            problem = f"a strip of {length:g} mm has no arc of this size; is it in {unit}? write mm"
            raise row.wrong(across, problem)
    reading = replace(reading, curvature_per_mm=float(arc_curvature(width, height)) or None)
    rolled_over_itself = arc_mm < length and height > 0.95 * width
    if abs(arc_mm / length - 1) > tolerance and not rolled_over_itself:
        reading = replace(reading, left_out=f"its box holds an arc of {arc_mm:.1f} mm, the strip has {length:g}")
    return reading, box


def _check_directions(rows: list[Row]) -> None:
    """Refuse tables with directions for some strips only."""
    without = [row for row in rows if not row.cells.get(DIRECTION_COLUMN)]
    if 0 < len(without) < len(rows):
        raise without[0].wrong(DIRECTION_COLUMN, "is empty, but other strips have one; fill in along or across")


def _check_not_swapped(rows: list[Row], readings: list[Reading]) -> None:
    """Refuse a table whose peeled strips bend clearly more than the same strips with their fabric."""
    curvature = {(each.strip, each.peeled): abs(each.curvature_per_mm or 0.0) for each in readings if not each.left_out}
    strips = [strip for strip, peeled in curvature if peeled and (strip, False) in curvature]
    pairs = np.array([[curvature[strip, False], curvature[strip, True]] for strip in strips]).reshape(-1, 2)
    # the columns count as swapped if the median curvature of peeled strips is larger than with fabric by this factor
    if not len(pairs) or np.median(pairs[:, 1]) <= 1.5 * np.median(pairs[:, 0]):
        return
    first = int(np.argmax(pairs[:, 1] > pairs[:, 0]))
    row = next(row for row in rows if row.cells["strip"] == strips[first])
    filled = (name for name, text in row.cells.items() if name.startswith("peeled_") and text)
    with_fabric, peeled = pairs[first]
    problem = f"the strip bends by {peeled:.4f} /mm, with its fabric by {with_fabric:.4f} /mm: peeled strips must bend "
    raise row.wrong(next(filled), problem + "less; are the columns with fabric and peeled swapped?")


def arc_curvature(width: ArrayLike, height: ArrayLike) -> Floats:
    """(n,) curvature of the arc in a box: `8 H / (W^2 + 4 H^2)` up to a half circle, `2 / W` beyond."""
    w, h = np.asarray(width, dtype=float), np.asarray(height, dtype=float)
    return np.where(2 * h <= w, 8 * h / (w**2 + 4 * h**2), 2 / w)


def arc_box(curvature: ArrayLike, length: ArrayLike) -> tuple[Floats, Floats]:
    """Width and height of the box of an arc, up to a full circle; the sign of the curvature does not matter."""
    k, length = np.broadcast_arrays(np.abs(np.asarray(curvature, dtype=float)), np.asarray(length, dtype=float))
    half = np.minimum(k * length / 2, np.pi)
    # sinc is exact for flat arcs
    chord = length * np.sinc(half / np.pi)
    height = length * half / 4 * np.sinc(half / 2 / np.pi) ** 2
    return np.where(half <= np.pi / 2, chord, 2 / np.maximum(k, 1e-300)), height


def arc_length(width: ArrayLike, height: ArrayLike) -> Floats:
    """(n,) length of the arc in a box."""
    w, h = np.asarray(width, dtype=float), np.asarray(height, dtype=float)
    k = arc_curvature(w, h)
    beyond = 2 / np.maximum(k, 1e-300) * np.arccos(np.clip(1 - h * k, -1, 1))
    half_angle = 2 * np.arctan2(2 * h, w)
    return np.where(2 * h > w, beyond, np.where(h > 0, w * half_angle / np.maximum(np.sin(half_angle), 1e-300), w))


def line_box(width: float, height: float, thickness: float) -> tuple[float, float]:
    """Box of the middle line of a strip from the box around the whole strip.

    The outer side of the strip has the radius `R + t/2`; its inner corners lie at `R - t/2`. If the box is at most as
    high as the thickness, the strip is flat: height 0. ValueError if the box is too small for this thickness.
    """
    if width <= 4 * thickness:
        raise ValueError(f"a strip {thickness:g} mm thick does not bend in a box {width:g} mm wide")
    if height <= thickness:
        return width, 0.0
    if height >= width / 2:
        return width - thickness, height * (width - thickness) / width

    def too_high(half: float) -> float:
        return float(width / 2 * np.tan(half / 2) + thickness * np.cos(half) - height)

    half = float(brentq(too_high, 0.0, np.pi / 2))
    radius = width / (2 * np.sin(half)) - thickness / 2
    return 2 * radius * np.sin(half), radius * (1 - np.cos(half))
