"""`asterism compare`: a shape and a scan or an outline in, a picture and numbers out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism import __version__
from asterism.measure.compare import outline
from asterism.measure.compare.comparison_picture import draw_outline, draw_scan
from asterism.measure.compare.errors import ScanError, check_file
from asterism.measure.compare.outline import Outline, read_outline
from asterism.measure.compare.scan import extent, read_scan
from asterism.measure.compare.scan_comparison import compare_scan
from asterism.measure.compare.silhouette import OutlineFit, fit_outline, silhouette
from asterism.measure.compare.units import check_size
from asterism.results.files import LAST, OutputError, check_writable, holds_result
from asterism.results.read_shape import folder_of, read_shape
from asterism.results.write_results import staged_result
from asterism.shape.diameter import diameter
from asterism.shape.shape import Shape
from pattern.design.errors import one_line

# farther off, the scan or outline may not have been laid on the shape rightly
POOR_PERCENT = 1.5
MANY_PERCENT = 3.0  # of the points: so many left out may be the sheet's
# a scan is of another size by this part and more, if in its own it is so near, and so many times nearer
OTHER_SIZE, NEAR_PERCENT, NEARER = 0.01, 1.0, 2.0


def compare(shape: Path, scan: Path, output: Path | None, unit: str | None, view: str | None, trim: float) -> list[str]:
    """Write compare.png and summary.json into a directory; returns the lines to print.

    `unit`: of the scan's numbers; mm unless it says its own size. `view`: of an outline, from above by default.

    Raises
    ------
    DesignError
        The shape cannot be read.
    ScanError, TableError
        The scan or outline cannot be read, or has the wrong size, or an option is not for it.
    OutputError
        The files cannot be written.
    """
    check_file(scan)
    found = read_shape(shape)
    directory = output or scan.with_name(f"{scan.stem}-compared")
    if directory.resolve() == folder_of(shape) and holds_result(directory):
        raise OutputError(f"--output: {str(directory)!r} is where the shape is and stays; choose another name")
    check_writable(directory)
    name = found.summary.get("design", {}).get("name", shape.stem)
    title = one_line(f"{name}, {found.made_by}, and {scan.name}")
    about: dict[str, Any] = {
        "version": __version__,
        "shape": str(shape),
        "shape_made": found.made_by,
        "shape_is_minimum": found.summary.get("is_minimum"),
        "scan": str(scan),
        "trim": trim,
    }
    if scan.suffix.lower() in outline.FORMATS:
        view = view or "above"
        outlined = read_outline(scan, unit)
        fitted = _fitted(found, scan, outlined, view, trim)
        about |= {"units": outlined.unit or "its own", "view": view, "lines": outlined.lines}
        numbers = {**about, **outline_numbers(fitted, diameter(found.positions))}
        rows = _outline_rows(numbers)
        words = _line(rows)
        if outlined.lines > 1:
            rows["lines in the file"] = f"{outlined.lines}, of which the largest is taken"
        rows |= _poor(numbers, "is it of this design, in mm, and from this --view? look at compare.png")
        with staged_result(directory) as folder:
            seen = "above" if view == "above" else f"the {view}"
            draw_outline(fitted, f"{title}, seen from {seen}", words, folder / "compare.png")
            _write(folder, numbers)
    else:
        if view is not None:
            raise ScanError(scan, "--view is for outlines (.svg, .csv): a scan may be in any pose")
        unit = unit or "mm"
        measured = read_scan(scan, unit)
        check_size(scan, measured.size_mm, extent(found.positions), unit)
        comparison = compare_scan(found, measured, trim)
        numbers = {
            **about,
            "units": unit,
            "scan_triangles": measured.triangles,
            "scan_vertices": measured.vertices,
            **comparison.summary(),
        }
        rows = _scan_rows(numbers)
        with staged_result(directory) as folder:
            draw_scan(comparison, title, folder / "compare.png")
            _write(folder, numbers)
    return [*(f"  {name:<22} {value}" for name, value in rows.items()), f"{directory}: compare.png, {LAST}"]


def _fitted(shape: Shape, file: Path, outlined: Outline, view: str, trim: float) -> OutlineFit:
    """A file's outline on the shape's."""
    target = silhouette(shape, view)
    sizes = [float(np.linalg.norm(np.ptp(points, axis=0))) for points in (outlined.corners, target)]
    check_size(file, sizes[0], sizes[1], outlined.unit)
    return fit_outline(outlined.corners, target, trim)


def outline_numbers(fitted: OutlineFit, diameter_mm: float) -> dict[str, Any]:
    """Numbers of a fitted outline; lengths in percent are of the shape's diameter, as those of scans."""
    distance = np.abs(fitted.distance)
    areas = [shapely.Polygon(points).area for points in (fitted.silhouette, fitted.outline)]
    rms = float(np.sqrt(np.mean(distance**2)))
    return {
        "rms_mm": rms,
        "rms_percent": 100 * rms / diameter_mm,
        "median_mm": float(np.median(distance)),
        "max_mm": float(distance.max()),
        "mean_outwards_mm": float(fitted.distance.mean()),
        "max_from_silhouette_mm": float(fitted.missed.max()),
        "area_of_shape_mm2": areas[0],
        "area_of_outline_mm2": areas[1],
        "diameter_mm": diameter_mm,
        "turn_deg": fitted.turn_deg,
        "shift_mm": fitted.shift.tolist(),
    }


def _scan_rows(s: dict[str, Any]) -> dict[str, str]:
    rows = {
        "rms": _rms(s),
        "median, 95 %, largest": f"{s['median_mm']:.3f}, {s['largest_twentieth_above_mm']:.3f}, {s['max_mm']:.3f} mm",
        "mean": f"{s['mean_to_plastic_side_mm']:+.3f} mm to the plastic side",
        "left out": f"{s['points_left_out_percent']:.1f} % of the points, beyond {s['left_out_beyond_mm']:.2f} mm",
        "scanned": f"{s['shape_covered_percent']:.0f} % of the shape",
    }
    rows |= _poor(s, "if the scan holds much else, crop it, or say --trim 0.5; is it of this design?")
    whole = 100.0 * s["rms_of_all_points_mm"] / s["diameter_mm"]
    if "a poor fit" not in rows and s["points_left_out_percent"] > MANY_PERCENT and whole > POOR_PERCENT:
        rows["perhaps another shape"] = f"{whole:.1f} % with what is left out: is that a table or clamps, or the sheet?"
    ratio, left = s["best_size"], s["rms_percent_at_best_size"]
    # a scan is of one side of the sheet, which on a roll is like another size
    if ratio and abs(ratio - 1.0) > OTHER_SIZE and left <= min(NEAR_PERCENT, s["rms_percent_lifted"] / NEARER):
        rows["perhaps another size"] = f"{ratio:.3f} times the shape's; without that it is {left:.2f} % off"
    if s["poses_as_good"] > 1:
        rows["poses as good"] = f"{s['poses_as_good']}: the shape looks alike from several sides"
    return rows


def _outline_rows(s: dict[str, Any]) -> dict[str, str]:
    return {
        "rms": _rms(s),
        "median, largest": f"{s['median_mm']:.3f}, {s['max_mm']:.3f} mm",
        "mean": f"{s['mean_outwards_mm']:+.3f} mm outwards",
        "area": f"{s['area_of_outline_mm2']:.0f} mm2, the shape's {s['area_of_shape_mm2']:.0f}",
    }


def _rms(s: dict[str, Any]) -> str:
    return f"{s['rms_mm']:.3f} mm, {s['rms_percent']:.2f} % of the shape's diameter"


def _poor(s: dict[str, Any], advice: str) -> dict[str, str]:
    """A row that says so, where the fit is poor."""
    return {"a poor fit": advice} if s["rms_percent"] > POOR_PERCENT else {}


def _line(rows: dict[str, str]) -> str:
    return "   ·   ".join(f"{name} {value}" for name, value in rows.items())


def _write(folder: Path, numbers: dict[str, Any]) -> None:
    (folder / LAST).write_text(json.dumps(numbers, indent=2, allow_nan=False) + "\n", encoding="utf-8")
