"""Comparison of a computed shape with a scan or an outline: the functions behind `asterism compare`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from asterism.measure.compare.comparison_picture import draw_outline, draw_scan
from asterism.measure.compare.outline import OUTLINE_FORMATS, OutlineFit, fit_outline, read_outline, silhouette
from asterism.measure.compare.scan import ScanError, check_file, check_size, extents, read_scan
from asterism.measure.compare.scan_comparison import ScanComparison, compare_scan
from asterism.pattern.design.errors import one_line
from asterism.pattern.geometry.diameter import diameter
from asterism.process.version import __version__
from asterism.results.files import SUMMARY_FILE, OutputError, check_writable, holds_result, staged_result
from asterism.results.records.comparison import (
    NO_FIT_PERCENT,
    ComparisonRecord,
    OutlineComparisonRecord,
    OutlineDistancesRecord,
    ScanComparisonRecord,
)
from asterism.shape.shape import Shape
from asterism.shape.vtu import folder_of, read_shape


@dataclass(frozen=True)
class MeasuredComparison:
    """A printed sheet compared with its computed shape.

    Attributes
    ----------
    laid : the scan in its pose on the shape, or the outline in its pose on the shape's silhouette.
    summary : all numbers; the content of summary.json.
    title : head of the picture.
    """

    laid: ScanComparison | OutlineFit
    summary: ScanComparisonRecord | OutlineComparisonRecord
    title: str

    @property
    def is_fit(self) -> bool:
        """Whether there is a pose in which a scan lies on the shape; an outline may be of another view."""
        return not isinstance(self.laid, ScanComparison) or self.summary.rms_percent <= NO_FIT_PERCENT

    def draw(self, path_or_file: str | Path | IO[bytes]) -> None:
        """Draw the distance as PNG."""
        if isinstance(self.laid, ScanComparison):
            draw_scan(self.laid, self.title, path_or_file)
        else:
            rows = self.summary.table(OutlineDistancesRecord.rows).items()
            draw_outline(self.laid, self.title, "   ·   ".join(f"{name} {value}" for name, value in rows), path_or_file)


def compare(
    shape: Shape | str | Path,
    scan: str | Path,
    *,
    units: str | None = None,
    view: str | None = None,
    trim: float = 0.2,
) -> MeasuredComparison:
    """Measure how far a printed sheet is from its computed shape.

    The scan is turned and shifted onto the shape; it is never mirrored or scaled. It may cover a part of the sheet.

    Parameters
    ----------
    shape : a shape, a directory of results, or a `.vtu` file.
    scan : a scan in space (.obj, .stl, .ply), or an outline from a photograph (.svg, .csv).
    units : unit of the scan's numbers: mm, cm, m, in or um. The default is mm, unless an SVG gives its own size.
    view : direction of an outline's photograph: above (the default), front or side.
    trim : largest part of the scan that does not belong to the sheet, 0 to 0.8.

    Raises
    ------
    DesignError
        The shape cannot be read.
    ScanError, TableError
        The scan or outline cannot be read, its size differs from the shape's, or an option does not apply to it.

    Examples
    --------
    A shape compared with itself:

    >>> import asterism, tempfile, trimesh
    >>> shape = asterism.preview(asterism.new("tube"))
    >>> scan = Path(tempfile.mkdtemp()) / "scan.obj"
    >>> _ = trimesh.Trimesh(shape.positions, shape.triangles).export(scan)
    >>> compare(shape, scan).summary["rms_percent"] < 0.1
    True
    """
    scan = Path(scan)
    check_file(scan)
    target = shape if isinstance(shape, Shape) else read_shape(shape)
    name = target.summary.get("design", {}).get("name", "shape" if isinstance(shape, Shape) else Path(shape).stem)
    title = one_line(f"{name}, {target.made_by}, and {scan.name}")
    about = ComparisonRecord(
        version=__version__,
        shape=name if isinstance(shape, Shape) else str(shape),
        shape_made=target.made_by,
        shape_is_minimum=target.summary.get("is_minimum"),
        scan=str(scan),
        trim=trim,
        units=units or "mm",
    )
    if scan.suffix.lower() in OUTLINE_FORMATS:
        view = view or "above"
        outlined, seen = read_outline(scan, units), silhouette(target, view)
        size, expected = (float(np.linalg.norm(np.ptp(points, axis=0))) for points in (outlined.corners, seen))
        check_size(scan, size, expected, outlined.unit)
        fitted = fit_outline(outlined.corners, seen, trim)
        about = about.changed(units=outlined.unit or "its own")
        distances = fitted.distances(diameter(target.positions))
        summary = OutlineComparisonRecord(**about, view=view, lines=outlined.lines, **distances)
        return MeasuredComparison(fitted, summary, f"{title}, seen from {'' if view == 'above' else 'the '}{view}")
    if view is not None:
        raise ScanError(scan, "--view is for outlines (.svg, .csv): a scan may be in any pose")
    measured = read_scan(scan, about.units)
    size, expected = (float(extents(points)[0]) for points in (measured.points, target.positions))
    check_size(scan, size, expected, about.units)
    laid = compare_scan(target, measured, trim)
    return MeasuredComparison(laid, ScanComparisonRecord(**about, **laid.distances()), title)


def check_comparison_directory(directory: str | Path, shape: str | Path) -> None:
    """Raise OutputError if a directory holds the shape, or cannot be written to."""
    directory = Path(directory)
    if directory.resolve() == folder_of(Path(shape)) and holds_result(directory):
        raise OutputError(f"--output: {str(directory)!r} holds the shape, which would be lost; choose another name")
    check_writable(directory)


def write_comparison(comparison: MeasuredComparison, directory: str | Path) -> list[str]:
    """Write compare.png and summary.json into a directory, all or none; returns their names.

    Raises
    ------
    OutputError
        The files cannot be written.
    """
    with staged_result(directory) as folder:
        comparison.draw(folder / "compare.png")
        (folder / SUMMARY_FILE).write_text(comparison.summary.json_text(), encoding="utf-8")
    return ["compare.png", SUMMARY_FILE]
