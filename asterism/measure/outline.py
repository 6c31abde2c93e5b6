"""Outlines from photographs: files as polygons in mm, and their registration with the silhouette of a shape."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely
from scipy.optimize import least_squares
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from asterism.draw.scene import VIEWS, camera
from asterism.equilibrium.arrays import Floats
from asterism.measure.registration import SPREAD, Pose, closest_points
from asterism.measure.scan import MM, ScanError, check_file
from asterism.pattern.drawing.read import MEET_MM, closed_curves, read_drawing
from asterism.pattern.drawing.records import DrawingError, NoUnitError
from asterism.pattern.geometry.planar import polygon_area
from asterism.results.csv_table import read_rows
from asterism.results.records.comparison import OutlineDistancesRecord
from asterism.shape.shape import Shape

OUTLINE_FORMATS = (".svg", ".csv")


@dataclass(frozen=True)
class Outline:
    """The largest closed line of a file."""

    corners: Floats  # (n, 2) mm, y upwards, not closed
    lines: int  # number of closed lines in the file
    unit: str | None  # unit of the numbers; None if the file gives its size


def read_outline(path: str | Path, unit: str | None = None) -> Outline:
    """The largest closed line in a file.

    `unit`: unit of the numbers in a CSV file, and in a drawing without a size; mm by default.

    Raises ScanError, TableError: the file is not an outline, or it gives its size and `unit` is given too.
    """
    path = Path(path)
    check_file(path)
    outline = (_from_csv if path.suffix.lower() == ".csv" else _from_drawing)(path, unit)
    corners = outline.corners
    length, width = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False) if len(corners) > 2 else (0.0, 0.0)
    if width <= 1e-12 * length:
        raise ScanError(path, "holds no outline: at least three corners, not on a line")
    if not shapely.Polygon(corners).is_valid:
        raise ScanError(path, "the outline crosses itself")
    return outline


def _from_csv(path: Path, unit: str | None) -> Outline:
    """The outline in a table with the columns x_mm and y_mm."""
    unit = unit or "mm"
    names = ("x_mm", "y_mm")
    rows = read_rows(path, names, names)
    corners = [[row.number_in(name, -1e6, 1e6, needed=True) for name in names] for row in rows]
    points = np.array(corners, dtype=float).reshape(-1, 2) * MM[unit]
    closed = len(points) > 1 and np.array_equal(points[0], points[-1])
    return Outline(points[:-1] if closed else points, 1, unit)


def _from_drawing(path: Path, unit: str | None) -> Outline:
    """The largest closed line of all visible shapes of a drawing."""
    unit_mm = None if unit in (None, "mm") else MM[unit]
    try:
        # mm, largest distance of a curve from its straight pieces
        drawing = read_drawing(path, 0.005, unit_mm, silent_mm=1.0, fills=True)
    except NoUnitError as error:
        raise ScanError(path, error.problem) from None
    except DrawingError as error:
        raise ScanError(path, str(error)) from None
    if drawing.has_unit and unit is not None:
        raise ScanError(path, "says its own size: --units is for files without one")
    # lines that a program has traced may miss their start by more than rounding
    # largest gap of a closed line over the size of the drawing
    rings = closed_curves(drawing.lines, max(MEET_MM, 1e-3 * float(drawing.size_mm.max())))
    if not rings and path.suffix.lower() == ".dxf":  # lines of CAD programs may cross at corners
        crossed = shapely.unary_union([shapely.LineString(line.points) for line in drawing.lines])
        areas = shapely.get_parts(shapely.unary_union(shapely.polygonize([crossed])))
        rings = [np.asarray(area.exterior.coords)[:-1] for area in areas if not area.is_empty]
    if not rings:
        raise ScanError(path, "holds no closed line with three corners or more")
    largest = max(rings, key=lambda ring: abs(polygon_area(ring)))
    return Outline(largest, len(rings), None if drawing.has_unit else unit or "mm")


@dataclass(frozen=True)
class OutlineFit:
    """An outline compared with a silhouette."""

    silhouette: Floats  # (m, 2) mm, outer outline of the shape in the view
    outline: Floats  # (n, 2) mm, the photographed outline after its motion
    distance: Floats  # (k,) mm, distance of points along the outline from the silhouette, positive outside
    places: Floats  # (k, 2) mm, these points
    missed: Floats  # (j,) mm, distance of points along the silhouette from the outline
    turn_deg: float  # rotation of the outline
    shift: Floats  # (2,) mm, after the rotation

    def distances(self, diameter_mm: float) -> OutlineDistancesRecord:
        """The distances in numbers; percentages refer to the shape's diameter (mm)."""
        distance = np.abs(self.distance)
        rms = float(np.sqrt(np.mean(distance**2)))
        return OutlineDistancesRecord(
            rms_mm=rms,
            rms_percent=100 * rms / diameter_mm,
            median_mm=float(np.median(distance)),
            max_mm=float(distance.max()),
            mean_outwards_mm=float(self.distance.mean()),
            max_from_silhouette_mm=float(self.missed.max()),
            area_of_shape_mm2=shapely.Polygon(self.silhouette).area,
            area_of_outline_mm2=shapely.Polygon(self.outline).area,
            diameter_mm=diameter_mm,
            turn_deg=self.turn_deg,
            shift_mm=self.shift.tolist(),
        )


def silhouette(shape: Shape, view: str) -> Floats:
    """(m, 2) mm, the outer outline of a shape seen from `above`, the `front` (along y) or the `side` (along x)."""
    seen = camera(*VIEWS[view], np.zeros(3)).project(shape.positions)[:, :2]
    # triangles that are seen from their edge are lines; a small width also closes the seams between triangles
    hulls = shapely.convex_hull(shapely.multipoints(seen[shape.triangles]))
    # half width of a triangle that is seen from its edge
    whole = shapely.union_all(shapely.buffer(hulls, 0.02, quad_segs=2))
    largest = max(shapely.get_parts(whole), key=shapely.area)
    return np.asarray(largest.exterior.coords)[:-1]


def fit_outline(outline: Floats, target: Floats, trim: float = 0.1) -> OutlineFit:
    """Register an outline (n, 2) with a silhouette (m, 2), both in mm, by a rotation and a shift without reflection.

    From many rotations, iterated closest points without the farthest part `trim`. The best result then minimises the
    sum of the distances, with squares of small distances.
    """
    ours, theirs = _along(outline), _along(target)
    tree = cKDTree(theirs)
    centre, goal = (np.array(shapely.Polygon(p).centroid.coords[0]) for p in (outline, target))
    few = ours[:: max(len(ours) // 400, 1)]
    angles = np.arange(72) * 2 * np.pi / 72
    turns = Rotation.from_rotvec(np.outer(angles, [0.0, 0.0, 1.0])).as_matrix()[:, :2, :2]
    poses = [closest_points(few, Pose(r, goal - r @ centre, np.inf), theirs, tree, trim, 15) for r in turns]
    best = min(poses, key=SPREAD)
    angle, shift = float(np.arctan2(best.rotation[1, 0], best.rotation[0, 0])), best.shift

    # the nearest minimum; rotations are scaled to the shifts that they cause
    some = ours[:: max(len(ours) // 1000, 1)]
    middle = some.mean(axis=0)
    size = float(np.linalg.norm(some - middle, axis=1).max())

    def place(motion: Floats) -> tuple[float, Floats]:
        turn = angle + motion[0] / size
        return turn, _turned(middle, angle) + shift + motion[1:] - _turned(middle, turn)

    def distances(motion: Floats) -> Floats:
        turn, moved = place(motion)
        return _outwards(_turned(some, turn) + moved, target)

    turn, moved = place(least_squares(distances, np.zeros(3), loss="soft_l1", diff_step=1e-6).x)
    placed = _turned(outline, turn) + moved
    places = _along(placed)
    missed = shapely.distance(shapely.points(theirs), shapely.LinearRing(placed))
    return OutlineFit(target, placed, _outwards(places, target), places, missed, float(np.rad2deg(turn)), moved)


def _along(corners: Floats) -> Floats:
    """Points with equal spacing along a closed line (n, 2) mm."""
    ring = shapely.LinearRing(corners)
    # spacing of the points along outline and silhouette
    count = max(round(ring.length / 0.25), 200)
    return shapely.get_coordinates(shapely.line_interpolate_point(ring, np.arange(count) * ring.length / count))


def _outwards(points: Floats, target: Floats) -> Floats:
    """(n,) distances from a closed line, negative within it."""
    places = shapely.points(points)
    inside = shapely.contains(shapely.Polygon(target), places)
    return np.asarray(shapely.distance(places, shapely.LinearRing(target)) * np.where(inside, -1.0, 1.0))


def _turned(points: Floats, angle: float) -> Floats:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))
