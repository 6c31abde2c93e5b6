"""Light and colour of the pixels of a rasterised sheet, each of them the mean of several rendered ones."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.compiled import formula, loop

PLASTIC_SIDE = (0.985, 0.92, 0.80)
FABRIC_SIDE = (0.63, 0.725, 0.845)
ARMS = (0.20, 0.205, 0.24)
PINS = (0.86, 0.25, 0.16)
OUTLINE_COLOUR = (0.16, 0.16, 0.18)
# unit vector towards the light: upper left, in front
KEY_LIGHT = np.array([-0.50, 0.62, 0.60]) / np.linalg.norm([-0.50, 0.62, 0.60])
# unit vector halfway between light and viewer, for the specular highlight
HALFWAY = (KEY_LIGHT + np.array([0.0, 0.0, 1.0])) / np.linalg.norm(KEY_LIGHT + np.array([0.0, 0.0, 1.0]))
# brightness of the key light and of the highlight, by the cosine that each of them needs
KEY_TABLE = np.linspace(0.0, 1.0, 4096) ** 1.6
GLOSS_TABLE = np.linspace(0.0, 1.0, 4096) ** 40


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
