"""Pictures of a shape: of three views together, and of one view at a size and a scale that can be chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import IO, Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from asterism.draw.render import render
from asterism.draw.scene import VIEWS, Drawable, Scene, View, drawn_size, scene, sheet_camera
from asterism.draw.style import INK, PALE
from asterism.equilibrium.arrays import Floats
from asterism.results.words import distance_error

# size of the picture, pixels
PICTURE_WIDTH_PX = 2000
PICTURE_HEIGHT_PX = 1120
# empty border of the picture
PICTURE_MARGIN_PX = 60
# height of the title and the caption at the top
CAPTION_HEIGHT_PX = 150
# the perspective view fills the left part of the picture, the two drawings to scale fill the rest
PERSPECTIVE_WIDTH_PX = 1240
# resolution of pictures; it determines the size of the text
PICTURE_DPI = 200
# all letters below this number, those of European languages, are in the usual font; the tests check it
FIRST_RARE_LETTER = 0x250


def draw_shape(shape: Drawable, title: str, path_or_file: str | Path | IO[bytes]) -> None:
    """Draw a shape as PNG: a supported sheet as it stands, a free sheet turned to its principal axes.

    Parameters
    ----------
    shape : the shape. The caption shows `stars_up`, `stars_total`, `energy_n_mm`, `converged`, `is_minimum` and, for a
        preview, `expected_rms_percent` of its summary, as far as they exist.
    title : name of the design.
    path_or_file : path of the PNG, or an open binary file.
    """
    shape = shape if shape.held else shape.aligned()
    canvas = Canvas(PICTURE_WIDTH_PX, PICTURE_HEIGHT_PX)
    thing, view = scene(shape), sheet_camera("oblique", shape.positions)
    room = np.array(
        [PERSPECTIVE_WIDTH_PX - 2 * PICTURE_MARGIN_PX, PICTURE_HEIGHT_PX - CAPTION_HEIGHT_PX - PICTURE_MARGIN_PX]
    )
    scale = float((room / drawn_size(thing, view)).min())
    canvas.paste(render(thing, view, scale), PERSPECTIVE_WIDTH_PX / 2, PICTURE_MARGIN_PX + room[1] / 2)
    _to_scale(canvas, thing, shape.positions)
    _write_captions(canvas, title, caption(shape), PICTURE_MARGIN_PX)
    # half the time of the usual level 6, for 8 % more bytes
    canvas.image.save(path_or_file, format="png", dpi=(PICTURE_DPI, PICTURE_DPI), compress_level=4)


def _write_captions(canvas: Canvas, title: str, line: str, margin: float) -> None:
    """Write a title and a line below it at the top left; long ones are printed in smaller letters."""
    # mean width of a letter in pixels per typographic point of its size
    room = (canvas.width - 2 * margin) / 1.75
    canvas.text(margin, canvas.height - 72, title, size=min(15.0, room / max(len(title), 1)), bold=True, color=INK)
    canvas.text(margin, canvas.height - 112, line, size=min(8.5, room / max(len(line), 1)), color=PALE)


def shape_image(shape: Drawable, title: str) -> Image.Image:
    """The picture of `draw_shape` as an image, for notebooks."""
    stream = BytesIO()
    draw_shape(shape, title, stream)
    return Image.open(stream)


def caption(shape: Drawable) -> str:
    """One line of numbers, as far as the summary holds them."""
    summary: Mapping[str, Any] = shape.summary
    parts = [
        f"height {summary.get('height_mm', shape.height_mm):.1f} mm",
        "extent " + " × ".join(f"{size:.1f}" for size in summary.get("extent_mm", shape.extent_mm)) + " mm",
    ]
    if summary.get("stars_total"):
        parts.append(f"{summary['stars_up']} of {summary['stars_total']} stars up")
    if "energy_n_mm" in summary:
        total = summary["energy_n_mm"]
        # a smaller energy is rounding error, and the caption gives it as 0
        parts.append(f"energy {total if abs(total) >= 1e-4 else 0.0:.4g} N mm")
    if "is_minimum" in summary:
        certified = summary["is_minimum"] and summary.get("converged", True)
        if summary.get("model") != "preview":
            parts.append("certified minimum" if certified else "not certified")
        elif not certified:
            parts.append("preview, not certified")
        elif (expected := summary.get("expected_rms_percent")) is None:
            parts.append("preview, without an error estimate")
        else:  # the certificate holds for the shell, and does not give the distance to the exact model
            parts.append(f"preview, estimated error {distance_error(expected, summary.get('diameter_mm'))}")
    return "   ·   ".join(parts)


def _to_scale(canvas: Canvas, thing: Scene, sheet: Floats) -> None:
    """Two drawings to the same scale, the sheet from above and below it from the front, with a scale bar."""
    above, front = sheet_camera("above", sheet), sheet_camera("front", sheet)
    (x, y), (_, z) = drawn_size(thing, above), drawn_size(thing, front)
    column, bar_room, label_room = PICTURE_WIDTH_PX - PICTURE_MARGIN_PX - PERSPECTIVE_WIDTH_PX, 70, 64
    room = PICTURE_HEIGHT_PX - CAPTION_HEIGHT_PX - PICTURE_MARGIN_PX - bar_room - 2 * label_room
    scale = float(min(column / x, room / (y + z)))
    middle = PERSPECTIVE_WIDTH_PX + column / 2
    gap = min((room - scale * (y + z)) / 3, 60.0)
    used = scale * (y + z) + bar_room + 2 * label_room + gap

    bottom = PICTURE_MARGIN_PX + (PICTURE_HEIGHT_PX - CAPTION_HEIGHT_PX - PICTURE_MARGIN_PX - used) / 2
    canvas.bar(middle, bottom, scale, x)
    bottom += bar_room + label_room
    if scale * z < 1.0:  # lower than one pixel: drawn as a line
        canvas.line((middle - x * scale / 2, middle + x * scale / 2), (bottom, bottom), 0.8)
    else:
        canvas.paste(render(thing, front, scale), middle, bottom + scale * z / 2)
    canvas.text(middle, bottom - 36, "from the front", size=8, color=PALE, centred=True)
    bottom += scale * z + gap + label_room
    canvas.paste(render(thing, above, scale), middle, bottom + scale * y / 2)
    canvas.text(middle, bottom - 36, "from above", size=8, color=PALE, centred=True)


def view_image(
    shape: Drawable,
    view: View = "oblique",
    size_px: tuple[int, int] = (1600, 1000),
    pixels_per_mm: float | None = None,
    plain: bool = False,
    title: str = "",
) -> Image.Image:
    """Draw one view of a shape, in the middle of a white picture.

    Parameters
    ----------
    view : in perspective (`oblique`), or a drawing to scale `above`, from the `front` or from the `side`.
    size_px : width and height of the picture.
    pixels_per_mm : scale, in perspective that at the middle of the sheet; by default the largest at which the sheet
        fits. At a larger one the sheet is cut off.
    plain : without title, numbers and scale bar.
    title : first line of a picture that is not plain.

    Raises ValueError: a size, the scale or the name of the view is not allowed.
    """
    check_picture(view, size_px, pixels_per_mm)
    shape = shape if shape.held else shape.aligned()
    canvas = Canvas(*size_px)
    scale = fitting_scale([shape], view, size_px, plain) if pixels_per_mm is None else pixels_per_mm
    thing, looking = scene(shape), sheet_camera(view, shape.positions)
    (left, low), (right, high) = _room(view, size_px, plain)
    canvas.paste(render(thing, looking, scale), (left + right) / 2, (low + high) / 2)
    if not plain:
        if view != "oblique":
            canvas.bar(size_px[0] / 2, PICTURE_MARGIN_PX / 2, scale, float(drawn_size(thing, looking)[0]))
        _write_captions(canvas, title, caption(shape), PICTURE_MARGIN_PX)
    return canvas.image


def fitting_scale(shapes: Sequence[Drawable], view: View, size_px: tuple[int, int], plain: bool) -> float:
    """The largest scale, in pixels per mm, at which each of several shapes fits a picture of `view_image`."""
    room = np.subtract(*_room(view, size_px, plain)[::-1])
    scales = []
    for shape in shapes:
        placed = shape if shape.held else shape.aligned()
        scales.append(float((room / drawn_size(scene(placed), sheet_camera(view, placed.positions))).min()))
    return min(scales)


def check_picture(view: str, size_px: tuple[int, int], pixels_per_mm: float | None) -> None:
    """Raise ValueError, with the allowed values, if these do not describe a picture."""
    if view not in ("oblique", *VIEWS):
        raise ValueError(f"view must be oblique, {', '.join(VIEWS)}, not {view!r}")
    # smallest and largest number of pixels of each side
    low, high = (100, 8000)
    if len(size_px) != 2 or not all(low <= side <= high and side == round(side) for side in size_px):
        raise ValueError(f"size must be two whole numbers of pixels from {low} to {high}, not {size_px}")
    if pixels_per_mm is not None and not 0.01 <= pixels_per_mm <= 1000.0:
        raise ValueError(f"scale must be from 0.01 to 1000 pixels per mm, not {pixels_per_mm:g}")


def _room(view: View, size_px: tuple[int, int], plain: bool) -> tuple[Floats, Floats]:
    """Lower left and upper right corner of the room for the drawing, in pixels."""
    width, height = size_px
    margin = min(PICTURE_MARGIN_PX, 0.05 * min(size_px))
    top = 0.0 if plain else CAPTION_HEIGHT_PX
    # room below a drawing for its scale bar
    bottom = 0.0 if plain or view == "oblique" else 100
    low, high = np.array([margin, margin + bottom]), np.array([width - margin, height - margin - top])
    return low, np.maximum(high, low + 1.0)


class Canvas:
    """A canvas of `width` x `height` pixels.

    `image`: the picture, RGB.
    """

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.image = Image.new("RGB", (width, height), "white")
        self._draw = ImageDraw.Draw(self.image)

    def paste(self, image: Floats, x: float, y: float) -> None:
        """Blend an image (rows, columns, 4) with opacity into the canvas, centred at (x, y); what overhangs is cut."""
        rows, columns = image.shape[:2]
        rendered = Image.fromarray(np.rint(255 * image[::-1]).astype(np.uint8))
        place = round(x - columns / 2), self.height - round(y - rows / 2) - rows
        self.image.paste(rendered, place, rendered)

    def text(
        self, x: float, y: float, text: str, *, size: float, color: str, bold: bool = False, centred: bool = False
    ) -> None:
        """Write text of a size in typographic points with its baseline at (x, y)."""
        parts = _lettered(text, round(size * PICTURE_DPI / 72, 2), bold)
        if centred:
            x -= sum(font.getlength(part) for font, part in parts) / 2
        for font, part in parts:
            self._draw.text((x, self.height - y), part, color, font, anchor="ls")
            x += font.getlength(part)

    def line(self, xs: Sequence[float], ys: Sequence[float], width: float) -> None:
        """Draw a straight line along an axis of the picture between two points, `width` typographic points wide."""
        ends = [(round(x), round(self.height - y)) for x, y in zip(xs, ys, strict=True)]
        self._draw.line(ends, INK, max(round(width * PICTURE_DPI / 72), 1))

    def bar(self, middle: float, bottom: float, scale: float, width_mm: float) -> None:
        """A scale bar of a round length, about a third of a drawing `width_mm` wide; `scale` is pixels per mm."""
        power = 10.0 ** np.floor(np.log10(width_mm / 3))
        length = max(step * power for step in (1, 2, 5) if step * power <= width_mm / 3)
        left, right = middle + np.array([-1, 1]) * length * scale / 2
        y, tick = bottom + 38, 7
        ticks = (y - tick, y + tick)
        for xs, ys in (((left, right), (y, y)), ((left, left), ticks), ((right, right), ticks)):
            self.line(xs, ys, 1.1)
        self.text(middle, bottom, f"{length:g} mm", size=8, color=INK, centred=True)


def _lettered(text: str, pixels: float, bold: bool = False) -> list[tuple[ImageFont.FreeTypeFont, str]]:
    """Parts of a text, each with a font of this size that has its letters."""
    if all(ord(letter) < FIRST_RARE_LETTER and letter.isprintable() for letter in text):
        return [(_font(usual_font(bold), pixels), text)]
    from asterism.draw.fonts import font_runs  # imports matplotlib, which takes long, for names with other letters

    return [(_font(file, pixels), run) for file, run in font_runs(text, bold)]


@cache
def usual_font(bold: bool) -> str:
    """File of the usual font in matplotlib's data; matplotlib itself is not imported."""
    package = find_spec("matplotlib")
    assert package is not None and package.origin is not None
    fonts = Path(package.origin).parent / "mpl-data" / "fonts" / "ttf"
    return str(fonts / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"))


@cache
def _font(file: str, pixels: float) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(file, pixels)
