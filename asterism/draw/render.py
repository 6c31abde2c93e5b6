"""One view of a sheet as an image: plastic side cream, fabric side blue-grey, arms dark, supports red."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter

from asterism.draw.scene import Camera, Scene
from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import formula, loop

# each pixel of the image is the mean of SUPERSAMPLING^2 rendered pixels
SUPERSAMPLING = 2
# two neighbours may both draw a pixel on their common edge, so that rounding leaves no hole; in pixels
EDGE_TOLERANCE_PX = 1e-6
PLASTIC_SIDE = (0.985, 0.92, 0.80)
FABRIC_SIDE = (0.63, 0.725, 0.845)
ARMS = (0.20, 0.205, 0.24)
PINS = (0.86, 0.25, 0.16)
OUTLINE_COLOUR = (0.16, 0.16, 0.18)
# unit vector towards the light: upper left, in front
KEY_LIGHT = np.array([-0.50, 0.62, 0.60]) / np.linalg.norm([-0.50, 0.62, 0.60])
# brightness of the key light and of the highlight, by the cosine that each of them needs
KEY_TABLE = np.linspace(0.0, 1.0, 4096) ** 1.6
GLOSS_TABLE = np.linspace(0.0, 1.0, 4096) ** 40


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
    # halfway between light and viewer, for the specular highlight
    halfway = KEY_LIGHT + np.array([0.0, 0.0, 1.0])
    lights = np.stack([KEY_LIGHT, view.axes[:, 2], halfway / np.linalg.norm(halfway)])
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


@loop
def shade(  # type: ignore[no-untyped-def]
    face, depth, around, plastic_side, normals, colours, first_arm, first_mark, lights, key_table, gloss_table,
    outline_step, sky_scale, image,
):  # fmt: skip
    """Write colour and opacity to image (height, width, 4), row 0 the lowest.

    Parameters
    ----------
    face, depth : (rows, columns) of the raster, a whole multiple of those of the image.
    around : (height, width) mean depth of the neighbourhood.
    plastic_side : (T,) whether the plastic side of a triangle is seen.
    normals : (3, T, 3) normals on the plastic side, in the axes of the view, of any length, as functions of the pixel.
    colours : (3, T, 3) colours as functions of the pixel; without rows for the usual colours.
    first_arm, first_mark : numbers of the first triangle of the arms and of the supports' marks.
    lights : (3, 3), rows are unit vectors to the key light, to the sky, and halfway from the light to the viewer.
    key_table, gloss_table : `KEY_TABLE`, `GLOSS_TABLE`.
    outline_step : step of the depth (mm) behind a visible edge.
    sky_scale : 1/mm, see `_open_sky`.
    """
    colour, towards = np.empty(3), np.empty(3)
    fineness = face.shape[0] // image.shape[0]
    for row in range(image.shape[0]):
        for column in range(image.shape[1]):
            red = green = blue = seen = 0.0
            for part in range(fineness * fineness):
                y, x = fineness * row + part // fineness, fineness * column + part % fineness
                t = face[y, x]
                if _is_behind_edge(depth, y, x, outline_step):
                    colour[0], colour[1], colour[2] = OUTLINE_COLOUR
                elif t < 0:
                    continue
                else:
                    front, arm = plastic_side[t], t >= first_arm
                    if t >= first_mark:
                        colour[0], colour[1], colour[2] = PINS
                    elif arm:
                        colour[0], colour[1], colour[2] = ARMS
                    elif colours.shape[1] > 0:
                        for c in range(3):
                            colour[c] = _at_pixel(colours, t, c, x, y)
                    elif front:
                        colour[0], colour[1], colour[2] = PLASTIC_SIDE
                    else:
                        colour[0], colour[1], colour[2] = FABRIC_SIDE
                    for k in range(3):
                        towards[k] = 0.0
                    square = 0.0
                    for c in range(3):
                        normal = _at_pixel(normals, t, c, x, y)
                        square += normal * normal
                        for k in range(3):
                            towards[k] += normal * lights[k, c]
                    scale = (1.0 if front else -1.0) / max(np.sqrt(square), 1e-12)
                    # wrapped diffuse light: a large source such as a window also lights what turns slightly away
                    key = _tabulated(key_table, 0.5 + 0.5 * scale * towards[0])
                    light = 0.36 + 0.54 * key + 0.13 * (0.5 + 0.5 * scale * towards[1])
                    shine = (0.10 if arm else 0.03) * _tabulated(gloss_table, scale * towards[2])
                    sky = _open_sky(around[row, column] - depth[y, x], sky_scale)
                    for c in range(3):
                        colour[c] = min(max(colour[c] * light + shine, 0.0), 1.0) * sky
                red += colour[0]
                green += colour[1]
                blue += colour[2]
                seen += 1.0
            # divided by the opacity: otherwise the empty part of a pixel would darken the edges
            share = max(seen, 1e-9)
            image[row, column, 0], image[row, column, 1], image[row, column, 2] = (
                red / share,
                green / share,
                blue / share,
            )
            image[row, column, 3] = seen / (fineness * fineness)


@formula
def _at_pixel(functions, t, c, x, y):  # type: ignore[no-untyped-def]
    """The value of component c of triangle t at the centre of a pixel."""
    return functions[0, t, c] * (x + 0.5) + functions[1, t, c] * (y + 0.5) + functions[2, t, c]


@formula
def _tabulated(table, value):  # type: ignore[no-untyped-def]
    """A function of values from 0 to 1 from its table, finer than the shades of a screen; powers would take longer."""
    return table[int(min(max(value * (table.shape[0] - 1), 0.0), table.shape[0] - 1.0))]


@formula
def _open_sky(nearer_mm, scale):  # type: ignore[no-untyped-def]
    """Factor below 1 where the neighbourhood is nearer to the viewer: in folds and behind edges.

    Reference: Luft, Colditz and Deussen, Image enhancement by unsharp masking the depth buffer, 2006.
    """
    return 1.0 - 0.38 * min(max(nearer_mm * scale, 0.0), 1.0)


@formula
def _is_behind_edge(depth, y, x, step):  # type: ignore[no-untyped-def]
    """Whether a neighbour of a pixel is nearer by more than a step (mm)."""
    # depth of the background, mm
    here = max(depth[y, x], -1e9)
    for v in range(max(y - 1, 0), min(y + 2, depth.shape[0])):
        for u in range(max(x - 1, 0), min(x + 2, depth.shape[1])):
            if depth[v, u] - here > step:
                return True
    return False
