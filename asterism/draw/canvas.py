"""A white canvas for renderings, text and scale bars; coordinates are pixels from the lower left."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from asterism.draw.style import INK
from asterism.equilibrium.arrays import Floats

# resolution of pictures; it determines the size of the text
PICTURE_DPI = 200
# all letters below this number, those of European languages, are in the usual font; the tests check it
FIRST_RARE_LETTER = 0x250


class Canvas:
    """A canvas of `width` x `height` pixels.

    Attributes
    ----------
    image : the picture, RGB.

    Examples
    --------
    >>> canvas = Canvas(200, 40)
    >>> canvas.text(10, 12, "dome", size=8, color="#000000")
    >>> canvas.image.getextrema()[0]
    (0, 255)
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
        parts = lettered(text, round(size * PICTURE_DPI / 72, 2), bold)
        if centred:
            x -= sum(font.getlength(part) for font, part in parts) / 2
        for font, part in parts:
            self._draw.text((x, self.height - y), part, color, font, anchor="ls")
            x += font.getlength(part)

    def line(self, xs: Floats, ys: Floats, width: float) -> None:
        """Draw a straight line along an axis of the picture between two points, `width` typographic points wide."""
        ends = [(round(x), round(self.height - y)) for x, y in zip(xs, ys, strict=True)]
        self._draw.line(ends, INK, max(round(width * PICTURE_DPI / 72), 1))

    def bar(self, middle: float, bottom: float, scale: float, width_mm: float) -> None:
        """A scale bar of a round length, about a third of a drawing `width_mm` wide; `scale` is pixels per mm."""
        power = 10.0 ** np.floor(np.log10(width_mm / 3))
        length = max(step * power for step in (1, 2, 5) if step * power <= width_mm / 3)
        left, right = middle + np.array([-1, 1]) * length * scale / 2
        y, tick = bottom + 38, 7
        for xs, ys in (
            ([left, right], [y, y]),
            ([left, left], [y - tick, y + tick]),
            ([right] * 2, [y - tick, y + tick]),
        ):
            self.line(np.array(xs), np.array(ys), 1.1)
        self.text(middle, bottom, f"{length:g} mm", size=8, color=INK, centred=True)


def lettered(text: str, pixels: float, bold: bool = False) -> list[tuple[ImageFont.FreeTypeFont, str]]:
    """Parts of a text, each with a font of this size that has its letters.

    >>> [part for _, part in lettered("7 × 3 mm", 20.0)]
    ['7 × 3 mm']
    """
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
