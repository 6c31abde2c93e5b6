"""One view of a sheet as an image: plastic side cream, fabric side blue-grey, arms dark, supports red."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter, maximum_filter

from asterism.draw.pin_marks import pin_marks
from asterism.draw.raster import Raster, rasterise
from asterism.draw.ribbons import ribbons
from asterism.shape.shape import Shape
from equilibrium.arrays import Array, Bools, Floats, Ints
from pattern.geometry.normals import vertex_normals

PLASTIC_SIDE = (0.985, 0.92, 0.80)
FABRIC_SIDE = (0.63, 0.725, 0.845)
SIDES = np.array([FABRIC_SIDE, PLASTIC_SIDE], dtype=np.float32)
ARMS = (0.20, 0.205, 0.24)
PINS = (0.86, 0.25, 0.16)
OUTLINE_COLOUR = (0.16, 0.16, 0.18)
# unit vector towards the light: upper left, in front
KEY_LIGHT = np.array([-0.50, 0.62, 0.60]) / np.linalg.norm([-0.50, 0.62, 0.60])
# unit vector halfway between light and viewer, for the specular highlight
HALFWAY = (KEY_LIGHT + np.array([0.0, 0.0, 1.0])) / np.linalg.norm(KEY_LIGHT + np.array([0.0, 0.0, 1.0]))
# brightness of the key light and of the highlight, by the cosine that each of them needs
KEY_TABLE = (np.linspace(0.0, 1.0, 4096) ** 1.6).astype(np.float32)
GLOSS_TABLE = (np.linspace(0.0, 1.0, 4096) ** 40).astype(np.float32)
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


def scene(shape: Shape) -> Scene:
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

    image = np.zeros((rows * columns, 4), dtype=np.float32)
    plastic_side, around = _turns_left(places, triangles), _depth_around(raster)
    normals = raster.affine(thing.normals @ view.axes.T, triangles)
    colours = None if thing.colours is None else raster.affine(thing.colours, triangles)
    for piece in raster.pieces():
        face = piece.face.ravel()[piece.pixels]
        front = plastic_side[face]
        colour: Array = SIDES[front.astype(np.intp)] if colours is None else piece.at_pixels(colours)
        arm = face >= thing.sheet_triangles
        colour[arm] = ARMS
        colour[face >= len(triangles) - marks] = PINS
        colour = _lit(colour, piece.at_pixels(normals), front, arm, view.axes[:, 2])
        image[piece.pixels, :3] = colour * _open_sky(piece, around, fine)[:, None]
    image[raster.pixels, 3] = 1.0
    image = image.reshape(rows, columns, 4)
    image[_outline(raster, fine)] = (*OUTLINE_COLOUR, 1.0)
    image = _coarser(image)
    # divide by the opacity: otherwise the empty part of a pixel would darken the edges
    image[..., :3] /= np.maximum(image[..., 3:], 1e-9)
    return image


def _coarser(image: Floats) -> Floats:
    """The mean over blocks of SUPERSAMPLING x SUPERSAMPLING pixels."""
    steps = range(SUPERSAMPLING)
    parts = [image[row::SUPERSAMPLING, column::SUPERSAMPLING] for row in steps for column in steps]
    return np.asarray(sum(parts[1:], start=parts[0]) / len(parts))


def _lit(colour: Array, normals: Floats, front: Bools, arm: Bools, up: Floats) -> Floats:
    """(P, 3) colours in a key light from the upper left, soft light from the sky, with a weak highlight.

    Parameters
    ----------
    colour : (P, 3) of the surface.
    normals : (P, 3) on the plastic side, in the axes of the view, of any length.
    front : (P,) whether the plastic side is seen.
    arm : (P,) whether an arm is seen.
    up : (3,) direction of the sky, in the axes of the view.
    """
    directions = np.stack([KEY_LIGHT, up, HALFWAY], axis=1)
    length = np.sqrt(np.einsum("pk,pk->p", normals, normals))
    towards = (normals @ directions).astype(np.float32)
    towards *= (np.where(front, 1.0, -1.0) / np.maximum(length, 1e-12)).astype(np.float32)[:, None]
    # wrapped diffuse light: a large source such as a window also lights surfaces that turn slightly away
    key = _tabulated(KEY_TABLE, 0.5 + 0.5 * towards[:, 0])
    light = 0.36 + 0.54 * key + 0.13 * (0.5 + 0.5 * towards[:, 1])
    shine = np.where(arm, 0.10, 0.03) * _tabulated(GLOSS_TABLE, towards[:, 2])
    return np.asarray(np.clip(colour * light[:, None] + shine[:, None], 0.0, 1.0))


def _tabulated(table: Array, values: Array) -> Array:
    """A function of values from 0 to 1 from its table, finer than the shades of a screen; powers would take longer."""
    return np.asarray(table[np.clip(values * (len(table) - 1), 0, len(table) - 1).astype(np.intp)])


def _depth_around(raster: Raster) -> Floats:
    """(rows, columns) mean depth over a neighbourhood, on the coarse image because it is smooth."""
    covered = np.isfinite(raster.depth)
    depth = np.where(covered, raster.depth, 0.0)
    reach = _reach(raster)
    share = gaussian_filter(_coarser(covered.astype(np.float32)), reach, truncate=2.5)
    return np.asarray(
        gaussian_filter(_coarser(depth.astype(np.float32)), reach, truncate=2.5) / np.maximum(share, 1e-6)
    )


def _reach(raster: Raster) -> float:
    """Standard deviation of the neighbourhood, in pixels of the coarse image."""
    return 0.015 * float(np.hypot(*raster.depth.shape)) / SUPERSAMPLING


def _open_sky(raster: Raster, around: Floats, pixels_per_mm: float) -> Floats:
    """(P,) factor below 1 where the neighbourhood is nearer to the viewer: in folds and behind edges.

    Reference: Luft, Colditz and Deussen, Image enhancement by unsharp masking the depth buffer, 2006.
    """
    row, column = np.divmod(raster.pixels, raster.depth.shape[1])
    nearer = around[row // SUPERSAMPLING, column // SUPERSAMPLING] - raster.depth.ravel()[raster.pixels]
    return np.asarray(1 - 0.38 * np.clip(nearer * pixels_per_mm / (2.5 * SUPERSAMPLING * _reach(raster)), 0.0, 1.0))


def _outline(raster: Raster, pixels_per_mm: float) -> np.ndarray:
    """(rows, columns) bool, pixels directly behind a visible edge of the sheet."""
    depth = np.where(np.isfinite(raster.depth), raster.depth, -1e9)
    step = maximum_filter(depth, size=3) - depth
    return np.asarray(step > 1.0 + 8 / pixels_per_mm)


def _turns_left(places: Floats, triangles: Ints) -> np.ndarray:
    """(T,) bool, whether the corners run counterclockwise on the image, so that the plastic side is visible."""
    a, b, c = (places[triangles[:, k]] for k in range(3))
    return (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] > 0
