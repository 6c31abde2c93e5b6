"""Reads the table of measured strips."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from asterism.measure.strips import arc
from asterism.measure.strips.reading import Reading
from asterism.measure.strips.table_checks import check_given_once, check_not_swapped
from asterism.pattern.design.stars import THICKNESS_RANGE_MM
from asterism.results.csv_cells import Row, TableError, read_rows

# columns that are known before the measurement
KNOWN_COLUMNS = ("strip", "thickness_mm", "length_mm", "stretch", "fabric_thickness_mm")
# columns of the boxes around the arcs
BOX_COLUMNS = ("box_width_mm", "box_height_mm", "peeled_box_width_mm", "peeled_box_height_mm")
# columns of curvatures, which may replace boxes
CURVATURE_COLUMNS = ("curvature_per_mm", "peeled_curvature_per_mm")
STRIP_COLUMNS = (*KNOWN_COLUMNS, *BOX_COLUMNS, *CURVATURE_COLUMNS)
# allowed lengths of strips; shorter ones are given in another unit or hardly bend
LENGTH_RANGE_MM = (10.0, 1000.0)
FABRIC_RANGE_MM = (0.01, 10.0)
STRETCH_RANGE = (1.01, 3.0)
MAX_BOX_MM = 2000.0
# steps to which a ruler or a screen is read
RULER_STEPS_MM = (1.0, 0.5, 0.25, 0.2, 0.1, 0.05, 0.02, 0.01)
# sides of boxes that determine the step of the ruler
MIN_SIDES_FOR_STEP = 6
# a reading is left out if the arc of its box differs from the length of the strip by more than this part
ARC_TOLERANCE = 0.1
# a box is at most as high as wide, but that of a strip that is nearly a circle may be read higher, by this factor ...
MAX_HEIGHT_OVER_WIDTH = 1.02
# ... and this length
HEIGHT_READING_ERROR_MM = 1.0
# arc of a box over the length of its strip, if the box or the length is given in another unit
_UNITS_OF_BOX = {"inches": 1 / 25.4, "centimetres": 0.1, "metres": 0.001}
_UNITS_OF_LENGTH = {"inches": 25.4, "centimetres": 10.0}


def read_strips(
    path: Path, stretch: float | None = None, fabric_thickness_mm: float | None = None, *, outside: bool = False
) -> list[Reading]:
    """Read the table of measured strips.

    Parameters
    ----------
    stretch, fabric_thickness_mm : values of all strips, if the table gives none.
    outside : the boxes enclose the thickness of the strips.

    Raises
    ------
    TableError
        The table is wrong; the message names file, row and column.
    """
    rows = read_rows(path, STRIP_COLUMNS, ("strip", "thickness_mm", "length_mm"))
    if not rows:
        raise TableError(path, None, None, "has a header but no strips")
    check_given_once(rows, "stretch", stretch, "--stretch")
    check_given_once(rows, "fabric_thickness_mm", fabric_thickness_mm, "--fabric-thickness")
    seen: dict[str, int] = {}
    readings: list[Reading] = []
    boxes: list[tuple[float, float] | None] = []  # sides in the table; None for curvatures and "flat"
    for row in rows:
        name = row.cells.get("strip", "")
        if not name:
            raise row.wrong("strip", "every strip needs a name or number")
        if name in seen:
            raise row.wrong("strip", f"{name!r} is already in row {seen[name]}")
        seen[name] = row.number
        for reading, box in _readings(row, name, stretch, fabric_thickness_mm, outside):
            readings.append(reading)
            boxes.append(box)
    if not readings:
        raise TableError(path, None, None, "no strip has been measured yet: fill in the boxes or curvatures")
    check_not_swapped(rows, readings)
    step = _ruler_step([side for box in boxes if box is not None for side in box])
    return [replace(r, step_mm=step) if box is not None else r for r, box in zip(readings, boxes, strict=True)]


def _ruler_step(sides: list[float]) -> float:
    """Largest step of a ruler (mm) whose multiples all sides are; 0 for few sides and for finer steps."""
    if len(sides) < MIN_SIDES_FOR_STEP:
        return 0.0
    return next(
        (step for step in RULER_STEPS_MM if all(abs(side / step - round(side / step)) < 1e-6 for side in sides)), 0.0
    )


Measured = tuple[Reading, tuple[float, float] | None]


def _readings(row: Row, name: str, stretch: float | None, fabric_mm: float | None, outside: bool) -> list[Measured]:
    """The readings of one row with their boxes: none, one (with fabric or peeled), or both."""
    thickness = _needed(row, "thickness_mm", THICKNESS_RANGE_MM)
    length = _needed(row, "length_mm", LENGTH_RANGE_MM)
    fabric = _needed(row, "fabric_thickness_mm", FABRIC_RANGE_MM, fabric_mm, "--fabric-thickness")
    stretched = _needed(row, "stretch", STRETCH_RANGE, stretch, "--stretch")
    plain = Reading(name, row.number, thickness, length, stretched, fabric, False, None)
    readings: list[Measured] = []
    for peeled in (False, True):
        prefix = "peeled_" if peeled else ""
        reading = replace(plain, peeled=peeled)
        curvature = row.number_in(f"{prefix}curvature_per_mm", -1.0 if peeled else 0.0, 1.0, "1/mm")
        boxed = [row.cells.get(f"{prefix}box_{side}_mm", "") for side in ("width", "height")]
        if curvature is not None and any(boxed):
            raise row.wrong(f"{prefix}curvature_per_mm", "give the box or the curvature, not both")
        if curvature is not None:
            readings.append((replace(reading, curvature_per_mm=curvature or None), None))
        elif any(boxed):
            around = thickness + (0.0 if peeled else fabric) if outside else 0.0
            readings.append(_boxed(row, prefix, reading, around))
    return readings


def _boxed(row: Row, prefix: str, reading: Reading, around: float) -> Measured:
    """The reading from a box; `around` is the thickness (mm) that the box includes."""
    across, up = f"{prefix}box_width_mm", f"{prefix}box_height_mm"
    if row.cells.get(up, "").lower() == "flat":
        return reading, None
    height = row.number_in(up, 0.0, MAX_BOX_MM)
    width = row.number_in(across, 0.1, MAX_BOX_MM)
    for column, value in ((across, width), (up, height)):
        if value is None:
            raise row.wrong(column, "is empty, but the other side of the box is given")
    assert width is not None and height is not None
    if height > MAX_HEIGHT_OVER_WIDTH * width + HEIGHT_READING_ERROR_MM:
        raise row.wrong(up, f"{height:g} must be at most the width {width:g}: the width lies along the arc's chord")
    box = width, height
    height = min(height, width)
    if around:
        try:
            width, height = arc.line_box(width, height, around)
        except ValueError as error:
            raise row.wrong(across, str(error)) from None
    ratio = float(arc.arc_length(width, height)) / reading.length_mm
    for unit, factor in _UNITS_OF_LENGTH.items():
        if abs(ratio / factor - 1) < ARC_TOLERANCE:
            length, arc_mm = reading.length_mm, ratio * reading.length_mm
            raise row.wrong(
                "length_mm", f"{length:g} must be the length in mm, about {arc_mm:.0f} by its box; is it in {unit}?"
            )
    for unit, factor in _UNITS_OF_BOX.items():
        if abs(ratio / factor - 1) < ARC_TOLERANCE:
            raise row.wrong(
                across, f"a strip of {reading.length_mm:g} mm has no arc of this size; is it in {unit}? write mm"
            )
    measured = replace(reading, curvature_per_mm=float(arc.curvature(width, height)) or None)
    rolled_over_itself = ratio < 1 and height > 0.95 * width
    if abs(ratio - 1) > ARC_TOLERANCE and not rolled_over_itself:
        arc_mm = ratio * reading.length_mm
        reason = f"its box holds an arc of {arc_mm:.1f} mm, the strip has {reading.length_mm:g}"
        return replace(measured, left_out=reason), box
    return measured, box


def _needed(
    row: Row, column: str, limits: tuple[float, float], default: float | None = None, option: str = ""
) -> float:
    value = row.number_in(column, *limits, "" if column == "stretch" else "mm")
    if value is None:
        value = default
    if value is None:
        raise row.wrong(column, f"is empty; fill it in or give {option}" if option else "is empty")
    return value
