"""Marks of the supports of a sheet: balls at points, tubes along edges."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from asterism.draw.drawable import Drawable
from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.layout import off_curves_mm

# radius of a ball over the diameter of the sheet
BALL_RADIUS_FACTOR = 0.011
# radius of a tube over the diameter of the sheet
TUBE_RADIUS_FACTOR = 0.0045
# rings of points from pole to pole of a ball
BALL_RINGS = 5
# points around a ball and around a tube
MARK_SIDES = 8
# longest piece of a tube, in radii of the tube
MAX_TUBE_STEP_RADII = 4.0
# a tube that turns by more than this angle has a ball at the corner
MIN_JOINT_ANGLE_RAD = 0.3

Marks = tuple[Floats, Floats, Ints]  # points (n, 3) mm, their normals, triangles (m, 3) with these to the outside


def pin_marks(shape: Drawable) -> Marks:
    """The marks of a supported sheet; empty for a free sheet, and if the shape carries no layout."""
    plan = shape.layout if shape.held else None
    if plan is None or not plan.pins:
        return _together([])
    size, border = diameter(shape.positions), plan.edges.start
    points = plan.pin_points
    runs = [run for pin in plan.pins for run in pin.chains(plan.edges)]
    lines = [_line(border, run, MAX_TUBE_STEP_RADII * TUBE_RADIUS_FACTOR * size) for run in runs]
    sharp = np.flatnonzero(np.abs(plan.edges.turns) > MIN_JOINT_ANGLE_RAD)
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
