"""Picture of a shape: one perspective view, and two drawings to scale, from above and from the front."""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import IO, Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from asterism.draw.colours import INK, PALE
from asterism.draw.fonts import families, printable
from asterism.draw.render import OBLIQUE, VIEWS, Camera, Scene, camera, render, scene
from asterism.results.words import distance_error
from asterism.shape.shape import Shape
from equilibrium.arrays import Floats

# size of the picture, pixels
PICTURE_WIDTH_PX = 2000
PICTURE_HEIGHT_PX = 1120
# resolution; it determines the size of the text
PICTURE_DPI = 200
# empty border of the picture
PICTURE_MARGIN_PX = 60
# height of the title and the caption at the top
CAPTION_HEIGHT_PX = 150
# the perspective view fills the left part of the picture, the two drawings to scale fill the rest
PERSPECTIVE_WIDTH_PX = 1240
# a smaller energy is rounding error, and the caption gives it as 0
MIN_SHOWN_ENERGY_N_MM = 1e-4


def draw_shape(shape: Shape, title: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a shape as PNG: a supported sheet as it stands, a free sheet turned to its principal axes.

    Parameters
    ----------
    shape : the shape. The caption shows `stars_up`, `stars_total`, `energy_n_mm`, `converged`, `is_minimum` and, for a
        preview, `expected_rms_percent` of its summary, as far as they exist.
    title : name of the design.
    path_or_file : path of the PNG, or an open binary file.
    """
    shape = shape if shape.held else shape.aligned()
    figure = Figure(
        figsize=(PICTURE_WIDTH_PX / PICTURE_DPI, PICTURE_HEIGHT_PX / PICTURE_DPI), dpi=PICTURE_DPI, facecolor="none"
    )
    text_canvas: Any = FigureCanvasAgg(figure)
    canvas = np.ones((PICTURE_HEIGHT_PX, PICTURE_WIDTH_PX, 3))
    thing = scene(shape)
    low, high = shape.positions.min(axis=0), shape.positions.max(axis=0)
    _perspective(canvas, thing, (low + high) / 2, float(np.linalg.norm(high - low)))
    _to_scale(figure, canvas, thing, (low + high) / 2)
    # a long name is printed in smaller letters
    _text(
        figure,
        PICTURE_MARGIN_PX,
        PICTURE_HEIGHT_PX - 72,
        title,
        size=15 * min(1.0, 70 / max(len(title), 1)),
        weight="bold",
        color=INK,
    )
    _text(figure, PICTURE_MARGIN_PX, PICTURE_HEIGHT_PX - 112, caption(shape), size=8.5, color=PALE)
    text_canvas.draw()
    picture = Image.fromarray(np.rint(255 * canvas[::-1]).astype(np.uint8)).convert("RGBA")
    picture.alpha_composite(Image.fromarray(np.asarray(text_canvas.buffer_rgba())))
    picture.convert("RGB").save(path_or_file, format="png", dpi=(PICTURE_DPI, PICTURE_DPI))


def shape_image(shape: Shape, title: str) -> Image.Image:
    """The picture of `draw_shape` as an image, for notebooks."""
    stream = BytesIO()
    draw_shape(shape, title, stream)
    return Image.open(stream)


def small_png(image: Image.Image) -> bytes:
    """PNG of an image in 256 colours. MAXCOVERAGE keeps colours of few pixels, such as the red of the supports."""
    out = BytesIO()
    # the k-means step smooths the shades
    image.convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=1).save(out, "PNG", optimize=True)
    return out.getvalue()


def caption(shape: Shape) -> str:
    """One line of numbers, as far as the summary holds them."""
    summary: Mapping[str, Any] = shape.summary
    parts = [
        f"height {summary.get('height_mm', shape.height_mm):.1f} mm",
        "extent " + " × ".join(f"{size:.1f}" for size in summary.get("extent_mm", shape.extent_mm)) + " mm",
    ]
    if summary.get("stars_total"):
        parts.append(f"{summary['stars_up']} of {summary['stars_total']} stars up")
    if "energy_n_mm" in summary:
        energy = summary["energy_n_mm"]
        total = energy.get("total", sum(energy.values())) if isinstance(energy, Mapping) else energy
        parts.append(f"energy {total if abs(total) >= MIN_SHOWN_ENERGY_N_MM else 0.0:.4g} N mm")
    if "is_minimum" in summary:
        certified = summary["is_minimum"] and summary.get("converged", True)
        sure = "certified minimum" if certified else "not certified"
        parts.append(_of_preview(summary, certified) if summary.get("model") == "preview" else sure)
    return "   ·   ".join(parts)


def _of_preview(summary: Mapping[str, Any], certified: bool) -> str:
    """Caption of a preview: its estimated error.

    The certificate of a preview holds for the shell model, and does not give the distance to the exact model.
    """
    if not certified:
        return "preview, not certified"
    expected = summary.get("expected_rms_percent")
    if expected is None:
        return "preview, without an error estimate"
    return f"preview, estimated error {distance_error(expected, summary.get('diameter_mm'))}"


def _perspective(canvas: Floats, thing: Scene, centre: Floats, diameter: float) -> None:
    """The large view on the left."""
    view = camera(*OBLIQUE, centre, distance_mm=2.6 * diameter)
    room = np.array(
        [PERSPECTIVE_WIDTH_PX - 2 * PICTURE_MARGIN_PX, PICTURE_HEIGHT_PX - CAPTION_HEIGHT_PX - PICTURE_MARGIN_PX]
    )
    scale = float((room / _size(thing, view)).min())
    _paste(canvas, render(thing, view, scale), PERSPECTIVE_WIDTH_PX / 2, PICTURE_MARGIN_PX + room[1] / 2)


def _to_scale(figure: Figure, canvas: Floats, thing: Scene, centre: Floats) -> None:
    """Two drawings to the same scale, the sheet from above and below it from the front, with a scale bar."""
    above, front = (camera(*VIEWS[name], centre) for name in ("above", "front"))
    (x, y), (_, z) = _size(thing, above), _size(thing, front)
    column, bar_room, label_room = PICTURE_WIDTH_PX - PICTURE_MARGIN_PX - PERSPECTIVE_WIDTH_PX, 70, 64
    room = PICTURE_HEIGHT_PX - CAPTION_HEIGHT_PX - PICTURE_MARGIN_PX - bar_room - 2 * label_room
    scale = float(min(column / x, room / (y + z)))
    middle = PERSPECTIVE_WIDTH_PX + column / 2
    gap = min((room - scale * (y + z)) / 3, 60.0)
    used = scale * (y + z) + bar_room + 2 * label_room + gap

    bottom = PICTURE_MARGIN_PX + (PICTURE_HEIGHT_PX - CAPTION_HEIGHT_PX - PICTURE_MARGIN_PX - used) / 2
    _bar(figure, middle, bottom, scale, x)
    bottom += bar_room + label_room
    if scale * z < 1.0:  # lower than one pixel: drawn as a line
        ends = (middle + np.array([-x, x]) * scale / 2) / PICTURE_WIDTH_PX
        figure.add_artist(Line2D(ends, 2 * [bottom / PICTURE_HEIGHT_PX], color=INK, linewidth=0.8))
    else:
        _paste(canvas, render(thing, front, scale), middle, bottom + scale * z / 2)
    _text(figure, middle, bottom - 36, "from the front", size=8, color=PALE, ha="center")
    bottom += scale * z + gap + label_room
    _paste(canvas, render(thing, above, scale), middle, bottom + scale * y / 2)
    _text(figure, middle, bottom - 36, "from above", size=8, color=PALE, ha="center")


def _bar(figure: Figure, middle: float, bottom: float, scale: float, width_mm: float) -> None:
    """A scale bar of a round length, about a third of the drawing."""
    power = 10.0 ** np.floor(np.log10(width_mm / 3))
    length = max(step * power for step in (1, 2, 5) if step * power <= width_mm / 3)
    left, right = (middle + np.array([-1, 1]) * length * scale / 2) / PICTURE_WIDTH_PX
    y, tick = (bottom + 38) / PICTURE_HEIGHT_PX, 7 / PICTURE_HEIGHT_PX
    for ends in (([left, right], [y, y]), ([left, left], [y - tick, y + tick]), ([right, right], [y - tick, y + tick])):
        figure.add_artist(Line2D(*ends, color=INK, linewidth=1.1))
    _text(figure, middle, bottom, f"{length:g} mm", size=8, color=INK, ha="center")


def _size(thing: Scene, view: Camera) -> Floats:
    """(2,) mm, width and height of the view; at least 0.001 mm, so that a flat sheet has a side view."""
    return np.asarray(np.maximum(np.ptp(view.project(thing.points)[:, :2], axis=0), 1e-3))


def _paste(canvas: Floats, image: Floats, x: float, y: float) -> None:
    """Blend an image with opacity into the canvas, its centre at (x, y) pixels from the lower left."""
    height, width = image.shape[:2]
    row, column = round(y - height / 2), round(x - width / 2)
    under = canvas[row : row + height, column : column + width]
    opacity = image[..., 3:]
    under[:] = opacity * image[..., :3] + (1 - opacity) * under


def _text(figure: Figure, x: float, y: float, text: str, **style: Any) -> None:
    """Write text with its baseline at (x, y) pixels from the lower left; `$` does not start an equation."""
    place = x / PICTURE_WIDTH_PX, y / PICTURE_HEIGHT_PX
    figure.text(*place, printable(text), parse_math=False, family=families(), **style)
