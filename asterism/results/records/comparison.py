"""The summaries of comparisons with a printed sheet: one for scans, one for outlines from photographs."""

from __future__ import annotations

from typing import ClassVar

from asterism.results.record import Record, key

# an rms distance beyond this part of the diameter may mean a wrong pose
POOR_FIT_PERCENT = 1.5
# a fit beyond this part of the diameter is none: prints differ from computed shapes by a few percent
NO_FIT_PERCENT = 6.0


def _rms(record: ScanDistancesRecord | OutlineDistancesRecord) -> str:
    return f"{record.rms_mm:.3f} mm, {record.rms_percent:.2f} % of the shape's diameter"


def _is_poor(record: ScanDistancesRecord | OutlineDistancesRecord) -> bool:
    return record.rms_percent > POOR_FIT_PERCENT


def _poor_scan(record: ScanDistancesRecord) -> str | None:
    advice = "crop the scan if it holds other things, or use --trim 0.5; is it of this design?"
    return advice if _is_poor(record) else None


def _poor_outline(record: OutlineDistancesRecord) -> str | None:
    advice = "is it of this design, in mm, and from this --view? look at compare.png"
    return advice if _is_poor(record) else None


def _another_shape(record: ScanDistancesRecord) -> str | None:
    """A fit that is poor only with the points that are left out, such as that of a mirror image."""
    whole = 100.0 * record.rms_of_all_points_mm / record.diameter_mm
    # if more of the points are left out, they may belong to the sheet
    if _is_poor(record) or record.points_left_out_percent <= 3.0 or whole <= POOR_FIT_PERCENT:
        return None
    return f"{whole:.1f} % with the points left out: are these a table or clamps, or the sheet?"


def _another_size(record: ScanDistancesRecord) -> str | None:
    ratio, left, lifted = record.best_size, record.rms_percent_at_best_size, record.rms_percent_lifted
    # a scan has another size than the shape if its best size differs by more than this part, ...
    if ratio is None or left is None or lifted is None or abs(ratio - 1.0) <= 0.01:
        return None
    # a scan shows one side of the sheet, which on a roll looks like another size
    # ... if it is nearer than 1 % at its best size, and twice as near as on a surface parallel to the shape's
    if left > min(1.0, lifted / 2.0):
        return None
    return f"{ratio:.3f} times the shape's; scaled to the shape's size it is {left:.2f} % off"


def _poses(record: ScanDistancesRecord) -> str | None:
    count = record.poses_as_good
    return f"{count}: the shape looks alike from several sides" if count > 1 else None


def _lines(record: OutlineComparisonRecord) -> str | None:
    return f"{record.lines}, of which the largest is compared" if record.lines > 1 else None


class ComparisonRecord(Record):
    """What was compared, and how."""

    version: str = key("Version of asterism.")
    shape: str = key("Path of the shape; its name if it was given in Python.")
    shape_made: str = key("Model that computed the shape: `by the exact model` or `by the preview`.")
    shape_is_minimum: bool | None = key("The shape is certified as a minimum; null if its summary is missing.")
    scan: str = key("Path of the scan or outline.")
    trim: float = key("Largest part of the scan that may not belong to the sheet.")
    units: str = key("Unit of the numbers in the file; `its own` if an SVG gives its size.")


class ScanDistancesRecord(Record):
    """Distances of a scan's points from a shape.

    The computed shape is the middle of the fabric, and a scan shows one side of the sheet. The rigid motion removes
    most of this offset, and all of it on shallow sheets. A distance to the nearest place of the shape is never larger
    than the distance of corresponding places, so a sheet that has slid along itself remains undetected.
    """

    scan_triangles: int = key("Triangles of the scan; 0 for a cloud of points.")
    scan_vertices: int = key("Vertices of the scan's file.")
    rms_mm: float = key("Rms distance of the used points from the nearest place of the shape.")
    rms_percent: float = key("The same in percent of the shape's diameter.")
    median_mm: float = key("Median distance of the used points.")
    largest_twentieth_above_mm: float = key("Distance that 5 % of the used points exceed.")
    max_mm: float = key("Largest distance of a used point.")
    mean_to_plastic_side_mm: float = key("Mean distance, positive on the plastic side.")
    rms_of_all_points_mm: float = key("Rms distance of all points, with those left out.")
    points: int = key("Points of the scan that were compared.")
    points_left_out_percent: float = key("Part of the points that lie too far away to belong to the sheet.")
    left_out_beyond_mm: float = key("Larger distances are left out: 3 % of the diameter, or 5 times the scatter.")
    shape_covered_percent: float = key("Part of the shape's area that was scanned.")
    diameter_mm: float = key("Largest distance of two points of the shape.")
    best_size: float | None = key("Scan's size over that in which it fits best; null for scans of a part.")
    rms_percent_at_best_size: float | None = key("Rms distance in that size; null for scans of a part.")
    rms_percent_lifted: float | None = key("Rms distance from a parallel surface; null for scans of a part.")
    poses_as_good: int = key("Number of poses that fit as well as the first, which is used.")
    scan_to_shape: list[list[float]] = key("The rigid motion: a 4 x 4 matrix for points in mm.")


class ScanComparisonRecord(ScanDistancesRecord, ComparisonRecord):  # the keys of the second class come first
    """The summary of a comparison with a scan in space."""

    rows: ClassVar = {
        "rms_mm": ("rms", _rms),
        "median_mm": ("median, 95 %, largest", "{median_mm:.3f}, {largest_twentieth_above_mm:.3f}, {max_mm:.3f} mm"),
        "mean_to_plastic_side_mm": ("mean", "{mean_to_plastic_side_mm:+.3f} mm to the plastic side"),
        "points_left_out_percent": (
            "left out",
            "{points_left_out_percent:.1f} % of the points, beyond {left_out_beyond_mm:.2f} mm",
        ),
        "shape_covered_percent": ("scanned", "{shape_covered_percent:.0f} % of the shape"),
        "rms_percent": ("a poor fit", _poor_scan),
        "rms_of_all_points_mm": ("perhaps another shape", _another_shape),
        "best_size": ("perhaps another size", _another_size),
        "poses_as_good": ("poses as good", _poses),
    }


class OutlineDistancesRecord(Record):
    """Distances of an outline from the silhouette of a shape."""

    rows: ClassVar = {
        "rms_mm": ("rms", _rms),
        "median_mm": ("median, largest", "{median_mm:.3f}, {max_mm:.3f} mm"),
        "mean_outwards_mm": ("mean", "{mean_outwards_mm:+.3f} mm outwards"),
        "area_of_outline_mm2": ("area", "{area_of_outline_mm2:.0f} mm2, the shape's {area_of_shape_mm2:.0f}"),
    }

    rms_mm: float = key("Rms distance of points along the outline from the silhouette.")
    rms_percent: float = key("The same in percent of the shape's diameter in space.")
    median_mm: float = key("Median distance of points along the outline.")
    max_mm: float = key("Largest distance of a point of the outline from the silhouette.")
    mean_outwards_mm: float = key("Mean distance, positive outside the silhouette.")
    max_from_silhouette_mm: float = key("Largest distance of a point of the silhouette from the outline.")
    area_of_shape_mm2: float = key("Area of the silhouette.")
    area_of_outline_mm2: float = key("Area within the outline.")
    diameter_mm: float = key("Largest distance of two points of the shape in space.")
    turn_deg: float = key("Turn of the outline, counterclockwise.")
    shift_mm: list[float] = key("Shift of the outline after the turn.")


class _SeenRecord(ComparisonRecord):
    """What was compared, and from where the outline was seen."""

    view: str = key("Direction of the photograph: `above`, `front` or `side`.")
    lines: int = key("Closed lines in the file; the largest is compared.")


class OutlineComparisonRecord(OutlineDistancesRecord, _SeenRecord):  # the keys of the second class come first
    """The summary of a comparison with an outline from a photograph."""

    rows: ClassVar = OutlineDistancesRecord.rows | {
        "lines": ("lines in the file", _lines),
        "rms_percent": ("a poor fit", _poor_outline),
    }
