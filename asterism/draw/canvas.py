"""A white canvas for renderings, text and scale bars; coordinates are pixels from the lower left."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw

from asterism.draw.colours import INK
from asterism.draw.lettering import lettered
from asterism.equilibrium.arrays import Floats

# resolution of pictures; it determines the size of the text
PICTURE_DPI = 200


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
