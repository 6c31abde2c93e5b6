"""One view of a sheet as an image: plastic side cream, fabric side blue-grey, arms dark, supports red."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.ndimage import gaussian_filter

from asterism.draw.ribbons import Drawable, ribbons
from asterism.draw.shading import GLOSS_TABLE, HALFWAY, KEY_LIGHT, KEY_TABLE, shade
from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.geometry.normals import vertex_normals
from asterism.pattern.layout.layout import off_curves_mm

View = Literal["oblique", "above", "front", "side"]
# (azimuth, elevation) of the cameras in deg: OBLIQUE for the perspective view, VIEWS for drawings to scale
OBLIQUE = (-62.0, 30.0)
# distance of the viewer in the perspective view, in diagonals of the box around the sheet
VIEWER_DISTANCE = 2.6
VIEWS = {"above": (-90.0, 90.0), "front": (-90.0, 0.0), "side": (0.0, 0.0)}
# each pixel of the image is the mean of SUPERSAMPLING^2 rendered pixels
SUPERSAMPLING = 2
# two neighbours may both draw a pixel on their common edge, so that rounding leaves no hole; in pixels
EDGE_TOLERANCE_PX = 1e-6
# radius of a ball over the diameter of the sheet
BALL_RADIUS_FACTOR = 0.011
# radius of a tube over the diameter of the sheet
TUBE_RADIUS_FACTOR = 0.0045
# rings of points from pole to pole of a ball
BALL_RINGS = 5
# points around a ball and around a tube
MARK_SIDES = 8


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
        return camera(*OBLIQUE, (low + high) / 2, VIEWER_DISTANCE * float(np.linalg.norm(high - low)))
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


def render(thing: Scene, view: Camera, pixels_per_mm: float) -> Floats:
    """Draw a scene: (height, width, 4) colour and opacity, row 0 the lowest. The image encloses the scene."""
    seen = view.project(thing.points)
    fine = SUPERSAMPLING * pixels_per_mm
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    width, height = np.ceil((high - low) * pixels_per_mm).astype(int) + 4
    rows, columns = SUPERSAMPLING * height, SUPERSAMPLING * width
    places = (seen[:, :2] - (low + high) / 2) * fine + np.array([columns, rows]) / 2
    # ribbons are visible from the plastic side only, marks from outside only
    strips = thing.triangles[thing.sheet_triangles :]
    seen_strips = _turns_left(places, strips)
    marks = int(np.count_nonzero(seen_strips[len(strips) - thing.mark_triangles :]))
    strips = strips[seen_strips]
    triangles = np.concatenate([thing.triangles[: thing.sheet_triangles], strips])
    depth = seen[:, 2].copy()
    depth[np.unique(strips)] += thing.lift_mm
    raster = rasterise(places, depth, triangles, rows, columns)
    around, colours = _depth_around(raster), thing.colours
    lights = np.stack([KEY_LIGHT, view.axes[:, 2], HALFWAY])
    image = np.zeros((height, width, 4))
    shade(
        raster.face,
        raster.depth,
        around,
        _turns_left(places, triangles),
        raster.affine(thing.normals @ view.axes.T, triangles),
        np.empty((3, 0, 3)) if colours is None else raster.affine(colours, triangles),
        thing.sheet_triangles,
        len(triangles) - marks,
        lights,
        KEY_TABLE,
        GLOSS_TABLE,
        1.0 + 8 / fine,
        fine / (2.5 * SUPERSAMPLING * _reach(raster)),
        image,
    )
    return image


def _coarser(image: Floats) -> Floats:
    """The mean over blocks of SUPERSAMPLING x SUPERSAMPLING pixels."""
    rows, columns = np.floor_divide(image.shape, SUPERSAMPLING)
    return np.asarray(image.reshape(rows, SUPERSAMPLING, columns, SUPERSAMPLING).mean(axis=(1, 3)))


def _depth_around(raster: Raster) -> Floats:
    """(height, width) mean depth over a neighbourhood, on the coarse image because it is smooth."""
    covered = np.isfinite(raster.depth)
    depth = np.where(covered, raster.depth, 0.0)
    reach = _reach(raster)
    share = gaussian_filter(_coarser(covered.astype(np.float32)), reach, truncate=2.5)
    mean = gaussian_filter(_coarser(depth.astype(np.float32)), reach, truncate=2.5) / np.maximum(share, 1e-6)
    return np.asarray(mean, dtype=float)


def _reach(raster: Raster) -> float:
    """Standard deviation of the neighbourhood, in pixels of the coarse image."""
    return 0.015 * float(np.hypot(*raster.depth.shape)) / SUPERSAMPLING


def _turns_left(places: Floats, triangles: Ints) -> np.ndarray:
    """(T,) bool, whether the corners run counterclockwise on the image, so that the plastic side is visible."""
    a, b, c = (places[triangles[:, k]] for k in range(3))
    return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] > 0


def bare(positions: Floats, triangles: Ints, colour: Floats | Sequence[float]) -> Scene:
    """A surface with vertices (V, 3) mm and triangles (T, 3), without arms and supports.

    `colour`: (3,) one colour, or (V, 3) one for each vertex, 0 to 1.
    """
    colours = np.broadcast_to(np.asarray(colour, dtype=float), (len(positions), 3))
    return Scene(positions, vertex_normals(positions, triangles), triangles, len(triangles), colours=colours)


@dataclass(frozen=True)
class Raster:
    """The visible triangle and its depth at each pixel."""

    face: Ints  # (height, width) visible triangle, -1 in the background. Row 0 is the lowest.
    depth: Floats  # (height, width) depth of that triangle, -inf in the background
    # (3, T, 3), the barycentric weights of a triangle's corners at pixel (x, y): `functions[0] x + functions[1] y +
    # functions[2]`.
    functions: Floats

    def affine(self, values: Floats, triangles: Ints) -> Floats:
        """Values (V, m) of the vertices as affine functions of the pixel, like `functions`: (3, T, m)."""
        return np.asarray(np.einsum("ptk,tkm->ptm", self.functions, values[triangles]))


def rasterise(places: Floats, depth: Floats, triangles: Ints, height: int, width: int) -> Raster:
    """Find the nearest triangle at the centre of every pixel.

    Parameters
    ----------
    places : (V, 2) pixels from the lower left corner of the image.
    depth : (V,) larger values are nearer; interpolated linearly on the image.
    triangles : (T, 3).
    height, width : size of the image in pixels.
    """
    functions = _weight_functions(places[triangles])
    depths = np.einsum("ptk,tk->tp", functions, depth[triangles])
    face, nearest = np.full((height, width), -1, dtype=np.int64), np.full((height, width), -np.inf)
    _fill(places[triangles, 1], functions, depths, face, nearest)
    return Raster(face, nearest, functions)


def _weight_functions(corners: Floats) -> Floats:
    """(3, T, 3); zero for triangles seen edge-on, which cover no pixel."""
    following, last = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    across = following[..., 1] - last[..., 1]
    upwards = last[..., 0] - following[..., 0]
    constant = following[..., 0] * last[..., 1] - last[..., 0] * following[..., 1]
    twice_area = constant.sum(axis=1, keepdims=True)
    flat = np.abs(twice_area) < 1e-9
    scale = np.where(flat, 0.0, 1 / np.where(flat, 1.0, twice_area))
    return np.stack([across * scale, upwards * scale, constant * scale])


@loop
def _fill(corner_y, functions, depths, face, nearest):  # type: ignore[no-untyped-def]
    """Write the nearest triangle to face and its depth to nearest, both (height, width).

    corner_y (T, 3), functions (3, T, 3) the weights, depths (T, 3) the depth as `x, y, 1` times its row.
    """
    height, width = face.shape
    for t in range(corner_y.shape[0]):
        if functions[0, t, 0] == 0.0 and functions[0, t, 1] == 0.0 and functions[0, t, 2] == 0.0:
            continue
        low = max(np.ceil(min(corner_y[t, 0], corner_y[t, 1], corner_y[t, 2]) - 0.5), 0.0)
        high = min(np.floor(max(corner_y[t, 0], corner_y[t, 1], corner_y[t, 2]) - 0.5), height - 1.0)
        if not low <= high:
            continue
        for row in range(int(low), int(high) + 1):
            # the part of the row where all three weights are at least zero
            left, right = -np.inf, np.inf
            for k in range(3):
                slope = functions[0, t, k]
                value = functions[1, t, k] * (row + 0.5) + functions[2, t, k]
                if abs(slope) < 1e-12:
                    if value < -1e-9:
                        right = -np.inf
                elif slope > 0:
                    left = max(left, -value / slope)
                else:
                    right = min(right, -value / slope)
            first = np.ceil(max(left - 0.5 - EDGE_TOLERANCE_PX, 0.0))
            last = np.floor(min(right - 0.5 + EDGE_TOLERANCE_PX, width - 1.0))
            if not first <= last:
                continue
            start = depths[t, 1] * (row + 0.5) + depths[t, 2] + 0.5 * depths[t, 0]
            for column in range(int(first), int(last) + 1):
                here = start + depths[t, 0] * column
                if here >= nearest[row, column]:
                    nearest[row, column] = here
                    face[row, column] = t


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
    polar = np.linspace(0.0, np.pi, BALL_RINGS)
    circles = np.stack(
        [np.outer(np.sin(polar), part) for part in _circle()] + [np.outer(np.cos(polar), np.ones(MARK_SIDES))]
    )
    normals = circles.reshape(3, -1).T
    return centre + radius * normals, normals, _grid(BALL_RINGS)


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
