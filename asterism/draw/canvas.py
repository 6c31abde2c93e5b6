"""A white canvas for renderings, text and scale bars; coordinates are pixels from the lower left."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from asterism.draw.colours import INK
from asterism.draw.fonts import families, printable
from equilibrium.arrays import Floats

# resolution of pictures; it determines the size of the text
PICTURE_DPI = 200


class Canvas:
    """A canvas of `width` x `height` pixels."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        size = (width / PICTURE_DPI, height / PICTURE_DPI)
        self._figure = Figure(figsize=size, dpi=PICTURE_DPI, facecolor="none")
        self._text_canvas: Any = FigureCanvasAgg(self._figure)
        self._pixels = np.ones((height, width, 3))

    def paste(self, image: Floats, x: float, y: float) -> None:
        """Blend an image (rows, columns, 4) with opacity into the canvas, centred at (x, y); what overhangs is cut."""
        rows, columns = image.shape[:2]
        row, column = round(y - rows / 2), round(x - columns / 2)
        first, left = max(-row, 0), max(-column, 0)
        image = image[first : max(self.height - row, 0), left : max(self.width - column, 0)]
        rows, columns = image.shape[:2]
        under = self._pixels[row + first : row + first + rows, column + left : column + left + columns]
        opacity = image[..., 3:]
        under[:] = opacity * image[..., :3] + (1 - opacity) * under

    def text(self, x: float, y: float, text: str, **style: Any) -> None:
        """Write text with its baseline at (x, y); `$` does not start an equation."""
        place = x / self.width, y / self.height
        self._figure.text(*place, printable(text), parse_math=False, family=families(), **style)

    def line(self, xs: Floats, ys: Floats, width: float) -> None:
        """Draw a straight line between two points, `width` typographic points wide."""
        ends = np.asarray(xs) / self.width, np.asarray(ys) / self.height
        self._figure.add_artist(Line2D(*ends, color=INK, linewidth=width))

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
        self.text(middle, bottom, f"{length:g} mm", size=8, color=INK, ha="center")

    def image(self) -> Image.Image:
        """The finished picture."""
        self._text_canvas.draw()
        picture = Image.fromarray(np.rint(255 * self._pixels[::-1]).astype(np.uint8)).convert("RGBA")
        picture.alpha_composite(Image.fromarray(np.asarray(self._text_canvas.buffer_rgba())))
        return picture.convert("RGB")
