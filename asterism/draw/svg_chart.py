"""Axes of a chart as SVG: equal scale in x and y, ticks at round numbers, lines, dots and a picture below them."""

from __future__ import annotations

from base64 import b64encode
from html import escape

import numpy as np

from asterism.draw.colours import INK, PALE
from equilibrium.arrays import Floats

# px: letters and the room that ticks and labels take around the axes
FONT_PX = 12
LEFT_PX, BELOW_PX, ABOVE_PX, RIGHT_PX = 52.0, 44.0, 26.0, 10.0
MAX_TICKS = 6
# room between the drawn points and the frame, over their largest extent
MARGIN_SHARE = 0.04


def round_ticks(low: float, high: float) -> list[float]:
    """At most `MAX_TICKS` round numbers at equal distances between two numbers.

    >>> round_ticks(-57.9, 58.1), round_ticks(0.0, 0.53)
    ([-40.0, -20.0, 0.0, 20.0, 40.0], [0.0, 0.1, 0.2, 0.3, 0.4, 0.5])
    """
    power = 10.0 ** np.floor(np.log10((high - low) / MAX_TICKS))
    steps = (step * power for step in (1.0, 2.0, 2.5, 5.0, 10.0, 20.0))
    step = next(step for step in steps if (high - low) / step <= MAX_TICKS)
    first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
    return [float(f"{n * step:.10g}") + 0.0 for n in np.arange(first, last + 1)]


class SvgAxes:
    """Axes with room for points between `low` and `high`, (2,) in the unit of the data.

    Attributes
    ----------
    width, height : px, of the axes with their labels.
    scale : px per unit.

    Examples
    --------
    >>> axes = SvgAxes(np.zeros(2), np.array([100.0, 50.0]), 300.0, "x, mm", "y, mm")
    >>> axes.line(np.array([[0.0, 0.0], [100.0, 50.0]]), "#4f6d92")
    >>> "polyline" in axes.group(), bool(axes.height < axes.width)
    (True, True)
    """

    def __init__(
        self, low: Floats, high: Floats, width_px: float, x_label: str, y_label: str, max_height_px: float = np.inf
    ) -> None:
        margin = MARGIN_SHARE * float((high - low).max())
        self._low, self._high = low - margin, high + margin
        size = self._high - self._low
        room = np.array([width_px - LEFT_PX - RIGHT_PX, max_height_px - BELOW_PX - ABOVE_PX])
        self.scale = float((room / size).min())
        self.width, self._drawn_height = width_px, size[1] * self.scale
        self.height = self._drawn_height + BELOW_PX + ABOVE_PX
        self._left = LEFT_PX + (room[0] - size[0] * self.scale) / 2
        self._parts = [self._ticks(0), self._ticks(1)]
        middle = self._px((self._low + self._high) / 2)
        self.text(middle[0], self.height - 8, x_label)
        self.text(14.0, middle[1], y_label, turned=True)

    def _px(self, points: Floats) -> Floats:
        """Places in px from the upper left."""
        x, y = np.moveaxis((points - self._low) * self.scale, -1, 0)
        return np.stack([self._left + x, ABOVE_PX + self._drawn_height - y], axis=-1)

    def _ticks(self, axis: int) -> str:
        lines = []
        for value in round_ticks(self._low[axis], self._high[axis]):
            ends = np.stack([self._low, self._high])
            ends[:, axis] = value
            (x0, y0), (x1, y1) = self._px(ends)
            lines.append(f'<path d="M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}" stroke="#ebebeb"/>')
            place, anchor = ((x0, y0 + 16), "middle") if axis == 0 else ((x0 - 6, y0 + 4), "end")
            lines.append(_text(*place, f"{value:g}", anchor))
        return "".join(lines)

    def text(self, x: float, y: float, text: str, turned: bool = False) -> None:
        """Write a text centred at a place in px."""
        self._parts.append(_text(x, y, text, "middle", turned))

    def title(self, text: str) -> None:
        """Write a text above the axes."""
        self.text(float(self._px((self._low + self._high) / 2)[0]), 16.0, text)

    def line(self, points: Floats, colour: str, width: float = 2.0, closed: bool = False) -> None:
        """Draw a line through points (n, 2)."""
        places = " ".join(f"{x:.1f},{y:.1f}" for x, y in self._px(points))
        kind = "polygon" if closed else "polyline"
        self._parts.append(f'<{kind} points="{places}" fill="none" stroke="{colour}" stroke-width="{width}"/>')

    def dots(self, points: Floats, colours: list[str], radius: float = 3.2) -> None:
        """Draw a dot at each point (n, 2)."""
        for (x, y), colour in zip(self._px(points), colours, strict=True):
            self._parts.append(
                f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}" stroke="{PALE}" stroke-width="0.8"/>'
            )

    def picture(self, png: bytes, low: Floats, high: Floats) -> None:
        """Lay a picture between two corners, (2,) in the unit of the data."""
        x, y = self._px(np.array([low[0], high[1]]))
        width, height = (high - low) * self.scale
        place = f'x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}"'
        self._parts.append(f'<image {place} href="data:image/png;base64,{b64encode(png).decode()}"/>')

    def group(self, x: float = 0.0, y: float = 0.0) -> str:
        """The SVG of the axes, moved by px."""
        return f'<g transform="translate({x:.1f} {y:.1f})">' + "".join(self._parts) + "</g>"


def colour_bar(x: float, y: float, height: float, stops: list[str], largest: float, label: str) -> str:
    """A bar of colours from 0 at the bottom to the largest value at the top, with ticks and a label on its right."""
    step = height / len(stops)
    parts = [
        # each a little higher than its share, so that no gap shows
        f'<rect x="{x:.1f}" y="{y + height - (n + 1) * step:.2f}" width="14" height="{step + 0.3:.2f}" fill="{stop}"/>'
        for n, stop in enumerate(stops)
    ]
    for value in round_ticks(0.0, largest):
        parts.append(_text(x + 19, y + height * (1.0 - value / largest) + 4, f"{value:g}", "start"))
    parts.append(_text(x + 62, y + height / 2, label, "middle", True))
    return "".join(parts)


def svg_picture(width: float, height: float, parts: list[str]) -> str:
    """An SVG picture on white, as an element of an HTML page."""
    return (
        f'<svg viewBox="0 0 {width:.0f} {height:.0f}" '
        f'font-family="system-ui, sans-serif" font-size="{FONT_PX}">'
        f'<rect width="100%" height="100%" fill="#fff"/>{"".join(parts)}</svg>'
    )


def _text(x: float, y: float, text: str, anchor: str, turned: bool = False) -> str:
    turn = f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{INK}"{turn}>{escape(text)}</text>'
