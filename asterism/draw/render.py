"""One view of a sheet as an image: plastic side cream, fabric side blue-grey, arms dark, supports red."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.ndimage import gaussian_filter

from asterism.draw.drawable import Drawable
from asterism.draw.pin_marks import pin_marks
from asterism.draw.raster import Raster, rasterise
from asterism.draw.ribbons import ribbons
from asterism.draw.shading import GLOSS_TABLE, HALFWAY, KEY_LIGHT, KEY_TABLE, shade
from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.normals import vertex_normals

View = Literal["oblique", "above", "front", "side"]
# (azimuth, elevation) of the cameras in deg: OBLIQUE for the perspective view, VIEWS for drawings to scale
OBLIQUE = (-62.0, 30.0)
# distance of the viewer in the perspective view, in diagonals of the box around the sheet
VIEWER_DISTANCE = 2.6
VIEWS = {"above": (-90.0, 90.0), "front": (-90.0, 0.0), "side": (0.0, 0.0)}
# each pixel of the image is the mean of SUPERSAMPLING^2 rendered pixels
SUPERSAMPLING = 2


@dataclass(frozen=True)
class Camera:
    """Direction and position of the viewer.

    Attributes
    ----------
    axes : (3, 3), rows are unit vectors to the right, upwards and towards the viewer.
    centre : (3,) mm, centre of the view.
    distance_mm : distance of the viewer from the centre; infinite for a parallel projection.
    """

    axes: Floats
    centre: Floats
    distance_mm: float = np.inf

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
    """Sheet, ribbons of the arms and marks of the supports as triangles.

    Attributes
    ----------
    points, normals : (n, 3) mm and unit normals on the plastic side.
    triangles : (m, 3), the sheet first, then the ribbons, then the marks.
    sheet_triangles : number of triangles of the sheet.
    lift_mm : shift of ribbons and marks towards the viewer, so that creases below do not cut them.
    colours : (n, 3), 0 to 1, colours of both sides of the sheet; the usual two colours by default.
    mark_triangles : number of triangles of the marks.
    """

    points: Floats
    normals: Floats
    triangles: Ints
    sheet_triangles: int
    lift_mm: float = 0.8
    colours: Floats | None = None
    mark_triangles: int = 0


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
    steps = range(SUPERSAMPLING)
    parts = [image[row::SUPERSAMPLING, column::SUPERSAMPLING] for row in steps for column in steps]
    return np.asarray(sum(parts[1:], start=parts[0]) / len(parts))


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


def bare(shape: Drawable, colour: Floats | Sequence[float]) -> Scene:
    """The sheet without arms and supports.

    Parameters
    ----------
    colour : (3,) one colour, or (V, 3) one for each vertex, 0 to 1.
    """
    normals = vertex_normals(shape.positions, shape.triangles)
    colours = np.broadcast_to(np.asarray(colour, dtype=float), (len(shape.positions), 3))
    return Scene(shape.positions, normals, shape.triangles, len(shape.triangles), colours=colours)
