"""A small chart as SVG: curves, dots and a picture over millimetres, in one scale along both axes."""

from __future__ import annotations

from base64 import b64encode

import numpy as np

from asterism.draw.style import INK, PALE
from asterism.equilibrium.arrays import Floats

# pixels around the frame: to the left and below for the numbers, to the right for a colour bar
LEFT, BELOW, AROUND, RIGHT = 62.0, 46.0, 14.0, 92.0
MAX_TICKS = 7


class Chart:
    """A frame with ticks around the box from `low` to `high`, (2,) mm each.

    Parameters
    ----------
    low, high : corners of the box.
    width, height : largest size of the frame in pixels.
    names : of both axes.
    right : pixels to the right of the frame.

    Examples
    --------
    >>> chart = Chart(np.zeros(2), np.array([100.0, 50.0]), 500.0, 400.0)
    >>> chart.at(np.array([[50.0, 50.0]])).tolist()
    [[312.0, 14.0]]
    >>> chart.line(np.array([[0.0, 0.0], [100.0, 50.0]]), "black")
    >>> chart.svg()[:5]
    b'<svg '
    """

    def __init__(
        self, low: Floats, high: Floats, width: float, height: float, names: tuple[str, str] = ("mm", "mm"),
        right: float = AROUND,
    ) -> None:  # fmt: skip
        span = np.maximum(high - low, 1e-6)
        self._low, self.scale = low, float(min(width / span[0], height / span[1]))
        self.size = span * self.scale
        self._whole = LEFT + self.size[0] + right, AROUND + self.size[1] + BELOW
        self._parts: list[str] = []
        for axis, name in enumerate(names):
            self._ticks(axis, ticks(low[axis], high[axis], int(min(MAX_TICKS, 2 + self.size[axis] / 50))), name)

    def at(self, points: Floats) -> Floats:
        """(n, 2) pixels from the upper left corner, of points (n, 2) mm."""
        x, y = ((points - self._low) * self.scale).T
        return np.column_stack([LEFT + x, AROUND + self.size[1] - y])

    def picture(self, png: bytes) -> None:
        """Fill the frame with a picture."""
        width, height = self.size
        data = b64encode(png).decode()
        place = f'x="{LEFT}" y="{AROUND}" width="{width:.1f}" height="{height:.1f}" preserveAspectRatio="none"'
        self._parts.append(f'<image {place} href="data:image/png;base64,{data}"/>')

    def line(self, points: Floats, colour: str, width: float = 2.0) -> None:
        """A curve through points (n, 2) mm."""
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in self.at(points))
        self._parts.append(f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width}"/>')

    def dots(self, points: Floats, colours: Floats) -> None:
        """Dots at points (n, 2) mm in colours (n, 3) from 0 to 1."""
        for (x, y), colour in zip(self.at(points), colours, strict=True):
            where = f'cx="{x:.1f}" cy="{y:.1f}" r="4" stroke="#666"'
            self._parts.append(f'<circle {where} fill="rgb{tuple(int(255 * part + 0.5) for part in colour)}"/>')

    def colour_bar(self, table: Floats, most: float, name: str) -> None:
        """A bar to the right of the frame from 0 to `most`, in the colours (n, 3) of a table."""
        x, step = LEFT + self.size[0] + 12.0, self.size[1] / len(table)
        for number, colour in enumerate(table):
            y, fill = AROUND + self.size[1] - (number + 1) * step, tuple(int(255 * part + 0.5) for part in colour)
            self._parts.append(f'<rect x="{x}" y="{y:.2f}" width="12" height="{step + 0.5:.2f}" fill="rgb{fill}"/>')
        for value in ticks(0.0, most, 6):
            self._text(x + 17.0, AROUND + self.size[1] * (1.0 - value / most) + 4.0, f"{value:g}", "start")
        self._text(x + 62.0, AROUND + self.size[1] / 2, name, turned=True)

    def svg(self) -> bytes:
        """The chart as the text of a file."""
        width, height = self._whole
        head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}"'
        style = 'font-family="system-ui, sans-serif" font-size="13"'
        return "\n".join(
            [f'{head} width="{width:.0f}" height="{height:.0f}" {style}>', *self._back(), *self._parts, "</svg>"]
        ).encode()

    def _back(self) -> list[str]:
        width, height = self.size
        frame = f'x="{LEFT}" y="{AROUND}" width="{width:.1f}" height="{height:.1f}"'
        return [
            '<rect width="100%" height="100%" fill="white"/>',
            f'<rect {frame} fill="none" stroke="{PALE}"/>',
        ]

    def _ticks(self, axis: int, values: Floats, name: str) -> None:
        bottom = AROUND + self.size[1]
        for value in values:
            x, y = self.at(np.where(np.arange(2) == axis, value, self._low)[None])[0]
            if axis == 0:
                self._parts.append(f'<path d="M{x:.1f} {AROUND}V{bottom:.1f}" stroke="#eee"/>')
                self._text(x, bottom + 18.0, f"{value:g}")
            else:
                self._parts.append(f'<path d="M{LEFT} {y:.1f}H{LEFT + self.size[0]:.1f}" stroke="#eee"/>')
                self._text(LEFT - 7.0, y + 4.0, f"{value:g}", "end")
        if axis == 0:
            self._text(LEFT + self.size[0] / 2, bottom + 38.0, name)
        else:
            self._text(14.0, AROUND + self.size[1] / 2, name, turned=True)

    def _text(self, x: float, y: float, text: str, anchor: str = "middle", turned: bool = False) -> None:
        turn = f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
        self._parts.append(f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{INK}"{turn}>{text}</text>')


def ticks(low: float, high: float, most: int) -> Floats:
    """Round numbers from low to high, at most about `most` of them.

    >>> ticks(0.0, 9.0, 5).tolist()
    [0.0, 2.0, 4.0, 6.0, 8.0]
    """
    power = 10.0 ** np.floor(np.log10((high - low) / most))
    step = next(times * power for times in (1.0, 2.0, 5.0, 10.0) if times * power * most >= high - low)
    return np.round(np.arange(np.ceil(low / step), np.floor(high / step) + 1.0) * step, 9) + 0.0
