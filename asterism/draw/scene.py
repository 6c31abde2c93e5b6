"""What a picture shows: sheet, arms as ribbons of their printed width and marks of supports as triangles; cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, Protocol, Self

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.layout import Layout, off_curves_mm

View = Literal["oblique", "above", "front", "side"]
# (azimuth, elevation) of the cameras for drawings to scale, in deg
VIEWS = {"above": (-90.0, 90.0), "front": (-90.0, 0.0), "side": (0.0, 0.0)}
# radius of a ball over the diameter of the sheet
BALL_RADIUS_FACTOR = 0.011
# radius of a tube over the diameter of the sheet
TUBE_RADIUS_FACTOR = 0.0045
# points around a ball and around a tube
MARK_SIDES = 8


class Drawable(Protocol):
    """A sheet in space with its arms, supports and numbers; attributes as of `asterism.shape.shape.Shape`."""

    @property
    def printed(self) -> np.ndarray: ...
    @property
    def positions(self) -> np.ndarray: ...
    @property
    def triangles(self) -> np.ndarray: ...
    @property
    def rods(self) -> Sequence[np.ndarray]: ...
    @property
    def rod_fields(self) -> Mapping[str, np.ndarray]: ...
    @property
    def summary(self) -> Mapping[str, Any]: ...
    @property
    def held(self) -> bool: ...
    @property
    def layout(self) -> Layout | None: ...
    @property
    def height_mm(self) -> float: ...
    @property
    def extent_mm(self) -> tuple[float, float, float]: ...
    def at(self, printed_points: Floats, off_sheet_mm: float = 0.0) -> Floats: ...
    def aligned(self) -> Self: ...


@dataclass(frozen=True)
class Camera:
    """Direction and position of the viewer."""

    axes: Floats  # (3, 3), rows are unit vectors to the right, upwards and towards the viewer
    centre: Floats  # (3,) mm, centre of the view
    distance_mm: float = np.inf  # distance of the viewer from the centre; infinite for a parallel projection

    def project(self, points: Floats) -> Floats:
        """(n, 3) mm to the right, upwards and towards the viewer, in perspective."""
        seen = (points - self.centre) @ self.axes.T
        return seen if np.isinf(self.distance_mm) else seen / (1 - seen[:, 2:] / self.distance_mm)


def camera(azimuth_deg: float, elevation_deg: float, centre: Floats, distance_mm: float = np.inf) -> Camera:
    """A camera with z upwards, at `azimuth_deg` from the x axis and `elevation_deg` above the xy plane."""
    a, e = np.deg2rad([azimuth_deg, elevation_deg])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
    return Camera(np.array([right, np.cross(towards, right), towards]), centre, distance_mm)


def sheet_camera(view: View, points: Floats) -> Camera:
    """The camera around a sheet with points (n, 3) mm: in perspective (`oblique`), or for a drawing to scale."""
    low, high = points.min(axis=0), points.max(axis=0)
    if view == "oblique":
        # the distance of the viewer is 2.6 diagonals of the box around the sheet
        return camera(-62.0, 30.0, (low + high) / 2, 2.6 * float(np.linalg.norm(high - low)))
    return camera(*VIEWS[view], (low + high) / 2)


@dataclass(frozen=True)
class Scene:
    """Sheet, ribbons of the arms and marks of the supports as triangles."""

    # points, normals: (n, 3) mm and unit normals on the plastic side.
    points: Floats
    normals: Floats
    triangles: Ints  # (m, 3), the sheet first, then the ribbons, then the marks
    sheet_triangles: int  # number of triangles of the sheet
    lift_mm: float = 0.8  # shift of ribbons and marks towards the viewer, so that creases below do not cut them
    # (n, 3), 0 to 1, colours of both sides of the sheet; the usual two colours by default.
    colours: Floats | None = None
    mark_triangles: int = 0  # number of triangles of the marks


def drawn_size(thing: Scene, view: Camera) -> Floats:
    """(2,) mm, width and height of the view; at least 0.001 mm, so that a flat sheet has a side view."""
    return np.asarray(np.maximum(np.ptp(view.project(thing.points)[:, :2], axis=0), 1e-3))


def scene(shape: Drawable) -> Scene:
    """The triangles of a shape: the sheet, the arms as ribbons on its plastic side, and marks at its supports."""
    points, normals, strips = ribbons(shape)
    mark_points, mark_normals, marks = pin_marks(shape)
    count = len(shape.positions)
    return Scene(
        np.concatenate([shape.positions, points, mark_points]),
        np.concatenate([vertex_normals(shape.positions, shape.triangles), normals, mark_normals]),
        np.concatenate([shape.triangles, strips + count, marks + count + len(points)]),
        len(shape.triangles),
        mark_triangles=len(marks),
    )


def bare(positions: Floats, triangles: Ints, colour: Floats | Sequence[float]) -> Scene:
    """A surface with vertices (V, 3) mm and triangles (T, 3), without arms and supports.

    `colour`: (3,) one colour, or (V, 3) one for each vertex, 0 to 1.
    """
    colours = np.broadcast_to(np.asarray(colour, dtype=float), (len(positions), 3))
    return Scene(positions, vertex_normals(positions, triangles), triangles, len(triangles), colours=colours)


def ribbons(shape: Drawable) -> tuple[Floats, Floats, Ints]:
    """Build strips of triangles along the arms, tangent to the sheet.

    Returns
    -------
    points : (2 P, 3) mm, first the P points left of the vertices of all arms, then those right of them.
    normals : (2 P, 3) unit normals at these points, away from the fabric.
    triangles : (2 R, 3), two for each of the R rod edges, counterclockwise seen from outside.
    """
    if not shape.rods:
        return np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 3), dtype=np.int64)
    vertices = np.concatenate(shape.rods)
    lengths = np.array([len(path) for path in shape.rods])
    first = np.cumsum(lengths) - lengths
    # each point of a rod but the last begins an edge; edges have the numbers of `shape.rod_edges`
    begins = np.ones(len(vertices), dtype=bool)
    begins[first + lengths - 1] = False
    begin = np.flatnonzero(begins)

    places = shape.positions[vertices]
    normals = vertex_normals(shape.positions, shape.triangles)[vertices]
    edges = places[begin + 1] - places[begin]
    along = np.zeros_like(places)
    along[begin] += edges
    along[begin + 1] += edges
    side = np.cross(normals, along)
    side /= np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-12)
    # width of the arms of a shape without the rod field `width_mm`
    half_width = _at_points(shape, "width_mm", 1.2, begin, len(vertices)) / 2
    below = _at_points(shape, "side", 1.0, begin, len(vertices)) < 0
    normals, side = (np.where(below[:, None], -each, each) for each in (normals, side))
    points = np.concatenate([places + half_width[:, None] * side, places - half_width[:, None] * side])
    left, right = begin, begin + len(vertices)
    triangles = np.concatenate(
        [np.column_stack([left, right, right + 1]), np.column_stack([left, right + 1, left + 1])]
    )
    return points, np.concatenate([normals, normals]), triangles


def _at_points(shape: Drawable, name: str, default: float, begin: Ints, count: int) -> Floats:
    """(P,) a field of the rod edges at the points of the rods: the mean of the adjacent edges."""
    values = np.asarray(shape.rod_fields.get(name, np.full(len(begin), default)), dtype=float)
    ends = np.concatenate([begin, begin + 1])
    total = np.bincount(ends, weights=np.tile(values, 2), minlength=count)
    # a rod of one point has no edge and is not drawn
    return total / np.maximum(np.bincount(ends, minlength=count), 1)


Marks = tuple[Floats, Floats, Ints]  # points (n, 3) mm, their normals, triangles (m, 3) with these to the outside


def pin_marks(shape: Drawable) -> Marks:
    """The marks of a supported sheet; empty for a free sheet, and if the shape carries no layout."""
    plan = shape.layout if shape.held else None
    if plan is None or not plan.pins:
        return _together([])
    size, border = diameter(shape.positions), plan.edges.start
    points = plan.pin_points
    runs = [run for pin in plan.pins for run in pin.chains(plan.edges)]
    # longest piece of a tube, in radii of the tube
    lines = [_line(border, run, 4.0 * TUBE_RADIUS_FACTOR * size) for run in runs]
    # a tube that turns by more than this angle has a ball at the corner
    sharp = np.flatnonzero(np.abs(plan.edges.turns) > 0.3)
    joints = [border[[corner for corner in run if corner in sharp or corner in (run[0], run[-1])]] for run in runs]
    try:
        off_sheet = off_curves_mm(plan, len(shape.printed))
        there = shape.at(np.concatenate([points, *lines, *joints]), off_sheet)
    except ValueError:  # the layout belongs to another print
        return _together([])
    ends = np.cumsum([len(points), *map(len, lines), *map(len, joints)])[:-1]
    balls, *curves = np.split(there, ends)
    parts = [_ball(place, BALL_RADIUS_FACTOR * size) for place in balls]
    parts += [_tube(line, TUBE_RADIUS_FACTOR * size) for line in curves[: len(lines)]]
    return _together(
        parts + [_ball(place, TUBE_RADIUS_FACTOR * size) for joint in curves[len(lines) :] for place in joint]
    )


def _line(border: Floats, corners: list[int], step: float) -> Floats:
    """(k, 2) mm, points along edges from corner to corner, at most `step` mm apart."""
    sides = [border[[first, second]] for first, second in pairwise(corners)]
    counts = [max(int(np.ceil(np.linalg.norm(end - start) / step)), 1) for start, end in sides]
    parts = [np.linspace(start, end, count + 1)[:-1] for (start, end), count in zip(sides, counts, strict=True)]
    return np.concatenate([*parts, border[corners[-1:]]])


def _together(parts: list[Marks]) -> Marks:
    points = np.concatenate([np.empty((0, 3)), *(part[0] for part in parts)])
    normals = np.concatenate([np.empty((0, 3)), *(part[1] for part in parts)])
    first = np.cumsum([0, *(len(part[0]) for part in parts)])
    numbered = [part[2] + start for part, start in zip(parts, first, strict=False)]
    return points, normals, np.concatenate([np.empty((0, 3), dtype=np.int64), *numbered])


def _ball(centre: Floats, radius: float) -> Marks:
    rings = 5  # of points, from pole to pole
    polar = np.linspace(0.0, np.pi, rings)
    circles = np.stack(
        [np.outer(np.sin(polar), part) for part in _circle()] + [np.outer(np.cos(polar), np.ones(MARK_SIDES))]
    )
    normals = circles.reshape(3, -1).T
    return centre + radius * normals, normals, _grid(rings)


def _tube(places: Floats, radius: float) -> Marks:
    """A tube around a line (k, 3) mm, open at its ends."""
    along = np.gradient(places, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
    aside = np.cross(along, np.eye(3)[np.abs(along).max(axis=0).argmin()])
    aside /= np.maximum(np.linalg.norm(aside, axis=1, keepdims=True), 1e-12)
    cosine, sine = _circle()
    normals = aside[:, None] * cosine[:, None] + np.cross(aside, along)[:, None] * sine[:, None]
    return (places[:, None] + radius * normals).reshape(-1, 3), normals.reshape(-1, 3), _grid(len(places))


def _circle() -> tuple[Floats, Floats]:
    angle = 2.0 * np.pi * np.arange(MARK_SIDES) / MARK_SIDES
    return np.cos(angle), np.sin(angle)


def _grid(rows: int) -> Ints:
    """(m, 3) triangles of a grid of `rows` rings with `MARK_SIDES` points each: two for each cell."""
    here = np.arange((rows - 1) * MARK_SIDES)
    turned = here // MARK_SIDES * MARK_SIDES + (here + 1) % MARK_SIDES
    below = np.column_stack([here, here + MARK_SIDES, turned + MARK_SIDES])
    return np.concatenate([below, np.column_stack([here, turned + MARK_SIDES, turned])])
