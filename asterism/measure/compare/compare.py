"""Comparison of a computed shape with a scan or an outline: the functions of `asterism compare`, and its picture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from asterism.draw.fonts import write_title
from asterism.draw.render import bare, drawn_size, render, sheet_camera
from asterism.draw.style import INK, PALE, style_axes
from asterism.equilibrium.arrays import Floats, Ints
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


SIGNED_DISTANCE_COLOURS = colormaps["RdBu_r"]
# resolution of the picture, and its size in inches
_DPI = 100
_WIDTH_IN, _HEIGHT_IN = 16.0, 8.6


def draw_scan(comparison: ScanComparison, title: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw the comparison with a scan as PNG."""
    numbers = comparison.distances()
    words = (
        f"rms {numbers.rms_mm:.2f} mm ({numbers.rms_percent:.2f} % of the diameter)   ·   "
        f"largest {numbers.max_mm:.2f} mm   ·   {numbers.points_left_out_percent:.0f} % of the points left out   ·   "
        f"{numbers.shape_covered_percent:.0f} % of the shape scanned"
    )
    figure = _figure(title, words)
    used, positions = comparison.distance[comparison.used], comparison.shape.positions
    said = "distance of the scan, mm; red: on the plastic side; grey: not scanned"
    scale = _scale(figure, (0.06, 0.075, 0.4, 0.022), used, said)
    low, high = positions.min(axis=0), positions.max(axis=0)
    distance = comparison.vertex_distance
    colours = np.where(np.isnan(distance)[:, None], (0.86, 0.86, 0.88), scale.to_rgba(distance)[:, :3])
    sheet = bare(comparison.shape.positions, comparison.shape.triangles, colours)
    view = sheet_camera("oblique", positions)
    room = np.array([0.46 * _WIDTH_IN, 0.68 * _HEIGHT_IN]) * _DPI
    image = render(sheet, view, float((room / drawn_size(sheet, view)).min()))
    height, width = image.shape[:2]
    canvas = image[..., 3:] * image[..., :3] + 1 - image[..., 3:]
    left, bottom = 0.27 * _WIDTH_IN * _DPI - width / 2, 0.5 * _HEIGHT_IN * _DPI - height / 2
    figure.figimage(canvas, left, bottom, origin="lower")
    for along, place in ((0, (0.56, 0.66, 0.42, 0.2)), (1, (0.56, 0.37, 0.42, 0.2))):
        _section(figure.add_axes(place), comparison, along, float((low + high)[1 - along] / 2))
    below = "mm, positive on the plastic side"
    _histogram(figure.add_axes((0.56, 0.09, 0.42, 0.19)), used, "points of the scan at each distance", below)
    figure.savefig(path_or_file, format="png", dpi=_DPI)


def draw_outline(outline_fit: OutlineFit, title: str, words: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw the comparison with an outline as PNG."""
    figure = _figure(title, words)
    axes = figure.add_axes((0.05, 0.09, 0.6, 0.77))
    axes.fill(*outline_fit.silhouette.T, facecolor="#eceef2", edgecolor=INK, linewidth=1.2)
    scale = _scale(figure, (0.72, 0.62, 0.25, 0.025), outline_fit.distance, "distance, mm; red: outside")
    ends = np.stack([outline_fit.places, np.roll(outline_fit.places, -1, axis=0)], axis=1)
    # a grey line below, because distance 0 is white
    axes.add_collection(LineCollection(list(ends), colors="#b8b8c0", linewidths=4.5))
    axes.add_collection(LineCollection(list(ends), colors=scale.to_rgba(outline_fit.distance), linewidths=3))
    axes.set_aspect("equal")
    axes.margins(0.05)
    style_axes(axes, "the outline in the colour of its distance, on the shape's silhouette", "mm")
    below = figure.add_axes((0.72, 0.15, 0.25, 0.34))
    _histogram(below, outline_fit.distance, "length of outline at each distance", "mm")
    for narrow in figure.axes[1:]:  # they have room for four numbers
        narrow.xaxis.set_major_locator(MaxNLocator(4))
    figure.savefig(path_or_file, format="png", dpi=_DPI)


def _figure(title: str, words: str) -> Figure:
    figure = Figure(figsize=(_WIDTH_IN, _HEIGHT_IN), dpi=_DPI, facecolor="white")
    FigureCanvasAgg(figure)
    write_title(figure, 0.025, 0.945, title, 15 * min(1.0, 90 / max(len(title), 1)))
    figure.text(0.025, 0.91, words, fontsize=10, color=PALE, parse_math=False)
    return figure


def _scale(figure: Figure, place: tuple[float, float, float, float], distance: Floats, title: str) -> ScalarMappable:
    """Colours for distances, with their bar."""
    far = max(float(np.quantile(np.abs(distance), 0.98)), 0.1)
    scale = ScalarMappable(Normalize(-far, far), SIGNED_DISTANCE_COLOURS)
    bar = figure.add_axes(place)
    figure.colorbar(scale, cax=bar, orientation="horizontal")
    bar.set_title(title, fontsize=9, color=PALE)
    return scale


def _section(axes: Axes, comparison: ScanComparison, along: int, level: float) -> None:
    """Draw the section of the shape along x (0) or y (1), where the other coordinate is `level` (mm), with the scan."""
    across = 1 - along
    segments = surface_cut(comparison.shape.positions, comparison.shape.triangles, across, level)[:, :, [along, 2]]
    near = np.abs(comparison.points[:, across] - level) < 1.0
    for selected, colour in ((near & ~comparison.used, "#b0b0b8"), (near & comparison.used, "#c8553d")):
        axes.plot(*comparison.points[selected][:, [along, 2]].T, ".", color=colour, markersize=2.5)
    axes.add_collection(LineCollection(list(segments), colors=INK, linewidths=1.2))
    positions = comparison.shape.positions[:, [along, 2]]
    low, high = positions.min(axis=0), positions.max(axis=0)
    room = 0.06 * float((high - low).max()) + 1.0
    axes.set_xlim(low[0] - room, high[0] + room)
    axes.set_ylim(low[1] - room, high[1] + room)
    axes.set_aspect("equal")
    style_axes(axes, f"cut along {'xy'[along]} through the middle: shape black, scan red, left out grey", "mm")


def surface_cut(positions: Floats, triangles: Ints, axis: int, level: float) -> Floats:
    """(k, 2, 3) segments in which triangles intersect the plane where a coordinate is `level`."""
    import trimesh  # slow to import

    mesh, normal = trimesh.Trimesh(positions, triangles, process=False), np.eye(3)[axis]
    return np.asarray(trimesh.intersections.mesh_plane(mesh, normal, level * normal))


def _histogram(axes: Axes, distance: Floats, title: str, below: str) -> None:
    axes.hist(distance, bins=80, color="#2a6f97")
    axes.set_yticks([])
    style_axes(axes, title, below)
