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
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from asterism.draw.fonts import write_title
from asterism.draw.render import render
from asterism.draw.scene import bare, drawn_size, sheet_camera
from asterism.draw.style import BLUE, INK, PALE, RED, style_axes
from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.outline import OUTLINE_FORMATS, OutlineFit, fit_outline, read_outline, silhouette
from asterism.measure.registration import Pose, distinct_poses, register
from asterism.measure.scan import Scan, ScanError, check_file, check_size, extents, read_scan
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
    ScanDistancesRecord,
)
from asterism.shape.shape import Shape
from asterism.shape.surface import NearestOnSurface, surface_triangle_areas
from asterism.shape.vtu import folder_of, read_shape


@dataclass(frozen=True)
class FittedSize:
    """The size of a scan relative to the size in which it fits its shape best."""

    ratio: float  # 1.1 if the scan is a tenth too large
    rms_mm: float  # rms distance from the shape, if the scan is scaled by 1 / `ratio`
    # rms distance in the scan's own size from a surface parallel to the shape, because a scan shows one side of the
    # sheet
    lifted_rms_mm: float


def fitted_size(shape: Shape, points: Floats, cut_mm: float) -> FittedSize | None:
    """The size of a scan whose points (n, 3) mm lie in their pose on a shape; None for a scan of a part.

    Gauss-Newton steps on rotation, shift and scale, or lift. The distances run from the scan to the shape, and outwards
    from the rim of the shape to the scan, so that a smaller scan does not fit inside. Points farther than `cut_mm`
    belong to other objects.

    Chen and Medioni 1992 (point to plane); Umeyama 1991 (motion with scale).
    """
    surface = NearestOnSurface(shape.positions, shape.triangles)
    rim = _rim(shape.positions, shape.triangles, surface.normals)
    scaled, lifted = (_fit(surface, rim, points, cut_mm, lift) for lift in (False, True))
    if scaled is None:
        return None
    # without a fit in its own size the scan counts as far away
    return FittedSize(1.0 / scaled[0], scaled[1], cut_mm if lifted is None else lifted[1])


def _fit(
    surface: NearestOnSurface, rim: tuple[Floats, Floats], points: Floats, cut_mm: float, lift: bool
) -> tuple[float, float] | None:
    """Scale factor of points (n, 3) mm, or with `lift` the lift of the surface in mm; and the rms distance left."""
    places, outwards = rim
    rng = np.random.default_rng(0)
    some = points[rng.choice(len(points), min(len(points), 3000), replace=False)]
    tree = cKDTree(points)
    # random points in a half plane: distance of the nearest point from a place on the rim, over the spacing of the
    # points
    inside = (2.0 * np.sqrt(2.0) / np.pi) * float(np.median(tree.query(some, k=2)[0][:, 1]))
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    motion, shift, factor, raised = np.eye(3), np.zeros(3), 1.0, 0.0
    for _ in range(30):
        here = surface(laid := some @ motion.T + shift)
        # the rim moves to the scan, so that the search tree of the scan stays valid
        gap, last = tree.query((places - shift) @ motion / factor**2)
        of_sheet, scanned = np.abs(here.distance) <= cut_mm, factor * gap <= cut_mm
        if np.count_nonzero(of_sheet) < 10 or np.mean(scanned) < 0.1:
            return None
        away, side = (laid - here.places)[of_sheet], surface.normals[here.triangle[of_sheet]]
        away -= raised * side
        length = np.linalg.norm(away, axis=1)
        direction = np.concatenate([away / np.maximum(length, 1e-12)[:, None], outwards[scanned]])
        last_laid = points[last[scanned]] @ motion.T + shift
        beyond = np.einsum("ni,ni->n", last_laid - places[scanned], outwards[scanned]) + inside
        ours, offset = np.concatenate([laid[of_sheet], last_laid]), np.concatenate([length, beyond])
        centre = ours.mean(axis=0)
        arm = (ours - centre) / size
        lifts = np.concatenate([-np.einsum("ni,ni->n", direction[: len(side)], side), np.zeros(len(beyond))])
        last_column = lifts if lift else np.einsum("ni,ni->n", arm, direction)
        rows = np.column_stack([np.cross(arm, direction), direction, last_column])
        information = rows.T @ rows
        # flat and round shapes have motions that change no distance: damp them
        information += 1e-6 * np.trace(information) / 7 * np.eye(7)
        step = -np.linalg.solve(information, rows.T @ offset)
        # mm, largest distance from the middle of the fabric to the scanned side
        if lift and abs(raised + step[6]) > (most := 2.0):
            step[6] = np.copysign(most, raised + step[6]) - raised
            step[:6] = -np.linalg.solve(information[:6, :6], rows[:, :6].T @ (offset + step[6] * rows[:, 6]))
        larger = 1.0 if lift else 1.0 + step[6] / size
        turn = larger * Rotation.from_rotvec(step[:3] / size).as_matrix()
        motion, shift = turn @ motion, turn @ (shift - centre) + centre + step[3:6]
        factor *= larger
        raised += float(step[6]) if lift else 0.0
        if np.abs(step[3:]).max() <= 1e-5 * size:
            break
    # a piece without all its rim fits a smooth shape in many sizes
    if not lift and np.mean(scanned) < 0.9:
        return None
    left = surface((some @ motion.T + shift)[of_sheet]).distance - raised
    return raised if lift else factor, float(np.sqrt(np.mean(left**2)))


def _rim(vertices: Floats, triangles: Ints, normals: Floats) -> tuple[Floats, Floats]:
    """Midpoints (r, 3) mm of the boundary edges, and unit vectors (r, 3) in the surface that point outwards."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    single = first[count == 1]
    start, end = vertices[edges[single]].transpose(1, 0, 2)
    outwards = np.cross(end - start, normals[single % len(triangles)])
    return 0.5 * (start + end), outwards / np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-12)


@dataclass(frozen=True)
class ScanComparison:
    """A scan compared with a shape."""

    shape: Shape  # the shape
    scan: Scan  # the scan in its own pose
    points: Floats  # (n, 3) mm, the scan's points after the motion onto the shape
    distance: Floats  # (n,) mm, distance of each point from the shape, positive on its plastic side
    triangle: Ints  # (n,) the nearest triangle of the shape
    used: np.ndarray  # (n,) bool, points that belong to the sheet; others (a table, clamps) are farther than `cut_mm`
    cut_mm: float
    covered: np.ndarray  # (T,) bool, triangles of the shape with points of the scan nearby
    poses: tuple[Pose, ...]  # all poses of the registration, the best first
    size: FittedSize | None  # the size in which the scan fits best; None for a scan of a part

    @property
    def vertex_distance(self) -> Floats:
        """(V,) mm, mean distance of the used points around each vertex; NaN without such points."""
        corners = self.shape.triangles[self.triangle[self.used]]
        count = len(self.shape.positions)
        total = np.bincount(corners.ravel(), np.repeat(self.distance[self.used], 3), minlength=count)
        points = np.bincount(corners.ravel(), minlength=count)
        return np.where(points > 0, total / np.maximum(points, 1), np.nan)

    def distances(self) -> ScanDistancesRecord:
        """The distances in numbers."""
        used, size = np.abs(self.distance[self.used]), diameter(self.shape.positions)
        rms = float(np.sqrt(np.mean(used**2)))
        area = surface_triangle_areas(self.shape.positions, self.shape.triangles)
        own = self.size
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.poses[0].rotation, self.poses[0].shift
        return ScanDistancesRecord(
            scan_triangles=self.scan.triangles,
            scan_vertices=self.scan.vertices,
            rms_mm=rms,
            rms_percent=100 * rms / size,
            median_mm=float(np.median(used)),
            largest_twentieth_above_mm=float(np.quantile(used, 0.95)),
            max_mm=float(used.max()),
            mean_to_plastic_side_mm=float(self.distance[self.used].mean()),
            rms_of_all_points_mm=float(np.sqrt(np.mean(self.distance**2))),
            points=len(self.distance),
            points_left_out_percent=100 * float(np.mean(~self.used)),
            left_out_beyond_mm=self.cut_mm,
            shape_covered_percent=100 * float(area[self.covered].sum() / area.sum()),
            diameter_mm=size,
            best_size=None if own is None else own.ratio,
            rms_percent_at_best_size=None if own is None else 100 * own.rms_mm / size,
            rms_percent_lifted=None if own is None else 100 * own.lifted_rms_mm / size,
            # 0.02 mm is the error of the registration
            poses_as_good=sum(p.spread_mm <= 1.1 * self.poses[0].spread_mm + 0.02 for p in self.poses),
            scan_to_shape=matrix.tolist(),
        )


def compare_scan(shape: Shape, scan: Scan, trim: float = 0.2) -> ScanComparison:
    """Register a scan with a shape, and measure the distances; at most a part `trim` of its points are other things."""
    hard = 3  # factor of the number of starts: a sheet among many other objects needs more of them
    effort = hard if trim > 0.3 else 1
    poses = register(scan.points, shape.positions, shape.triangles, trim, 0, effort)
    if effort == 1 and poses[0].spread_mm >= 0.002 * diameter(shape.positions):
        poses += register(scan.points, shape.positions, shape.triangles, trim, 1, hard)
        poses = distinct_poses(poses)
    points = poses[0](scan.points)
    nearest = NearestOnSurface(shape.positions, shape.triangles)(points)
    distance = np.abs(nearest.distance)
    scatter = 1.4826 * float(np.quantile(distance, (1 - trim) / 2))
    # points nearer than a part of the diameter belong to the sheet in any case
    cut = max(5 * scatter, 0.03 * diameter(shape.positions))
    used = distance <= cut
    covered, size = _covered(shape, points[used], 5 * scatter), fitted_size(shape, points, cut)
    return ScanComparison(
        shape, scan, points, nearest.distance, nearest.triangle, used, cut, covered, tuple(poses), size
    )


def _covered(shape: Shape, points: Floats, off_mm: float) -> np.ndarray:
    """(T,) bool, triangles with a point nearer to their centre than point spacing and triangle size."""
    tree = cKDTree(points)
    corners = shape.positions[shape.triangles]
    size = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    some = points[:: max(len(points) // 1000, 1)]
    gap = float(np.quantile(tree.query(some, k=2)[0][:, 1], 0.9))
    distance, _ = tree.query(corners.mean(axis=1))
    return np.asarray(distance <= np.hypot(size + gap, off_mm))


@dataclass(frozen=True)
class MeasuredComparison:
    """A printed sheet compared with its computed shape."""

    # the scan in its pose on the shape, or the outline in its pose on the shape's silhouette
    laid: ScanComparison | OutlineFit
    summary: ScanComparisonRecord | OutlineComparisonRecord  # all numbers; the content of summary.json
    title: str  # head of the picture

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
        about = about | {"units": outlined.unit or "its own"}
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
    pixels = figure.bbox.size
    room = np.array([0.46, 0.68]) * pixels
    image = render(sheet, view, float((room / drawn_size(sheet, view)).min()))
    height, width = image.shape[:2]
    canvas = image[..., 3:] * image[..., :3] + 1 - image[..., 3:]
    left, bottom = np.array([0.27, 0.5]) * pixels - np.array([width, height]) / 2
    figure.figimage(canvas, left, bottom, origin="lower")
    for along, place in ((0, (0.56, 0.66, 0.42, 0.2)), (1, (0.56, 0.37, 0.42, 0.2))):
        _section(figure.add_axes(place), comparison, along, float((low + high)[1 - along] / 2))
    below = "mm, positive on the plastic side"
    _histogram(figure.add_axes((0.56, 0.09, 0.42, 0.19)), used, "points of the scan at each distance", below)
    figure.savefig(path_or_file, dpi=figure.dpi, format="png")


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
    figure.savefig(path_or_file, dpi=figure.dpi, format="png")


def _figure(title: str, words: str) -> Figure:
    figure = Figure(figsize=(16.0, 8.6), dpi=100, facecolor="white")
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
    for selected, colour in ((near & ~comparison.used, "#b0b0b8"), (near & comparison.used, RED)):
        axes.plot(*comparison.points[selected][:, [along, 2]].T, ".", color=colour, markersize=2.5)
    axes.add_collection(LineCollection(list(segments), colors=INK, linewidths=1.2))
    title = f"cut along {'xy'[along]} through the middle: shape black, scan red, left out grey"
    frame_section(axes, comparison.shape.positions[:, [along, 2]], title)


def frame_section(axes: Axes, points: Floats, title: str) -> None:
    """Set the limits and the style of a section to scale, around points (n, 2) mm."""
    low, high = points.min(axis=0), points.max(axis=0)
    room = 0.06 * float((high - low).max()) + 1.0
    axes.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room), aspect="equal")
    style_axes(axes, title, "mm")


def surface_cut(positions: Floats, triangles: Ints, axis: int, level: float) -> Floats:
    """(k, 2, 3) segments in which triangles intersect the plane where a coordinate is `level`."""
    import trimesh  # slow to import

    mesh, normal = trimesh.Trimesh(positions, triangles, process=False), np.eye(3)[axis]
    return np.asarray(trimesh.intersections.mesh_plane(mesh, normal, level * normal))


def _histogram(axes: Axes, distance: Floats, title: str, below: str) -> None:
    axes.hist(distance, bins=80, color=BLUE)
    axes.set_yticks([])
    style_axes(axes, title, below)
