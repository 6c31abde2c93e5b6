"""A page with a field for the drawing and a column of text; with the paper's frame its size is A3."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats
from asterism.print.drawing import Circle, Drawing, DrawingLayer, Label, Polyline, font_size_within, offset_points
from asterism.print.layers import TEXT

# margin around the drawing and the column
PAGE_MARGIN_MM = 18.5
# width of the column of text, with its margin
COLUMN_MM = 123.0
# characters in a line of the column
_COLUMN_LETTERS = 48
# length of the ruler that shows whether the page is printed at 100 %
_RULER_MM = 100.0

DrawingItems = list[Polyline | Circle | Label]


def sheet_page(
    title: str,
    field_mm: ArrayLike,
    centre: ArrayLike,
    items: DrawingItems,
    name: str,
    what: str,
    paragraphs: Sequence[str],
    table: Sequence[str] = (),
) -> Drawing:
    """A page around a field of this size about `centre`, with its column.

    Parameters
    ----------
    items : items of the drawing.
    name, what : the two large lines at the head of the column.
    paragraphs : text of the column, without line breaks.
    table : lines in a font of fixed pitch.
    """
    half = np.asarray(field_mm) / 2
    low = np.asarray(centre) - half - PAGE_MARGIN_MM
    high = np.asarray(centre) + half + PAGE_MARGIN_MM + [COLUMN_MM, 0.0]
    at = np.array([high[0] - COLUMN_MM, high[1] - PAGE_MARGIN_MM - 6.0])
    column = _column(at, items, name, what, paragraphs, table)
    lowest = min(item.at[1] for item in column if isinstance(item, Label)) - PAGE_MARGIN_MM / 2
    low[1] = min(low[1], lowest)
    return Drawing(title, low, high, (*items, *column))


def _column(
    at: Floats, items: DrawingItems, name: str, what: str, paragraphs: Sequence[str], table: Sequence[str]
) -> list[Polyline | Circle | Label]:
    column: DrawingItems = [
        Label(TEXT, at.copy(), name, font_size_within(name, 7.0, COLUMN_MM - PAGE_MARGIN_MM), bold=True)
    ]
    at = at - [0.0, 9.0]
    column.append(Label(TEXT, at.copy(), what, 4.5))
    at = at - [0.0, 12.0]
    column += _ruler(at)
    at = at - [0.0, 16.0]
    for layer in dict.fromkeys(item.layer for item in items):
        if layer.meaning:
            column += _legend(layer, at)
            at = at - [0.0, 6.0]
    at = at - [0.0, 5.0]
    for paragraph in paragraphs:
        for line in textwrap.wrap(paragraph, _COLUMN_LETTERS) or [""]:
            column.append(Label(TEXT, at.copy(), line, 3.6))
            at = at - [0.0, 5.2]
        at = at - [0.0, 2.2]
    for line in table:
        column.append(Label(TEXT, at.copy(), line, 3.0, fixed_pitch=True))
        at = at - [0.0, 4.2]
    return column


def _ruler(at: Floats) -> DrawingItems:
    ends = offset_points(at, (0.0, 0.0), (_RULER_MM, 0.0))
    pen = DrawingLayer("ruler", TEXT.colour, 0.3)
    ticks = [Polyline(pen, offset_points(end, (0.0, -2.0), (0.0, 2.0))) for end in ends]
    words = Label(TEXT, offset_points(at, (0.0, -6.5)), "100 mm: measure it. Print at 100 %.", 3.6)
    return [Polyline(pen, ends), *ticks, words]


def _legend(meant: DrawingLayer, at: Floats) -> DrawingItems:
    # on a layer of its own: a laser that cuts the layer "cut" must not cut the legend
    layer = replace(meant, name=f"legend-{meant.name}", meaning="")
    if layer.filled:
        box = offset_points(at, (0.0, 0.0), (12.0, 0.0), (12.0, 2.4), (0.0, 2.4))
        sample = Polyline(layer, box, closed=True)
    else:
        sample = Polyline(layer, offset_points(at, (0.0, 1.2), (12.0, 1.2)))
    return [sample, Label(TEXT, offset_points(at, (15.0, 0.0)), meant.meaning, 3.6)]
