"""PDF at 1:1: one page for each drawing, of its size."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO

import matplotlib
import numpy as np
from matplotlib import patches
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.path import Path as Outline
from matplotlib.patheffects import Stroke
from matplotlib.transforms import Affine2D, Transform

from asterism.draw.fonts import families, printable
from asterism.equilibrium.arrays import Floats
from asterism.print.drawing import NEEDLES, Circle, Drawing, Label, Polyline
from asterism.print.formats.registry import export_format

_MM_PER_INCH = 25.4
_POINTS_PER_MM = 72 / _MM_PER_INCH


@export_format("PDF", ".pdf", "pages")
def write_pdf(
    path: Path | IO[bytes], drawings: Sequence[Drawing], picture: Callable[[Figure], None] | None = None
) -> None:
    """Write drawings as pages, without a date; `picture` adds to each. Characters that the font lacks become boxes."""
    with (
        warnings.catch_warnings(),
        matplotlib.rc_context({"pdf.fonttype": 42, "path.simplify": False}),
        PdfPages(path, metadata={"Title": drawings[0].title, "CreationDate": None}) as pages,
    ):
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        for drawing in drawings:
            page = _page(drawing)
            if picture is not None:
                picture(page)
            pages.savefig(page)


def _page(drawing: Drawing) -> Figure:
    width, height = (float(side) for side in drawing.size_mm / _MM_PER_INCH)
    # PDF and the coordinates of the figure have 72 units an inch
    figure = Figure(figsize=(width, height), dpi=72.0)
    FigureCanvasAgg(figure)
    to_page = Affine2D().translate(*-drawing.low).scale(_POINTS_PER_MM)
    for item in drawing.items:
        if isinstance(item, Label):
            _write_text(figure, item, to_page)
        else:
            figure.add_artist(_shape(item, to_page))
    return figure


def _shape(item: Polyline | Circle, to_page: Transform) -> patches.Patch | Line2D:
    layer = item.layer
    drawn: patches.Patch | Line2D
    if isinstance(item, Polyline) and not item.closed:
        drawn = Line2D(*item.points.T, color=layer.colour, transform=to_page, solid_capstyle="butt")
    else:
        face, edge = (layer.colour, "none") if layer.filled else ("none", layer.colour)
        drawn = patches.PathPatch(_outline(item), facecolor=face, edgecolor=edge, transform=to_page, joinstyle="miter")
    drawn.set_linewidth(layer.width_mm * _POINTS_PER_MM)
    if layer.dash_mm:
        # matplotlib counts dashes in line widths
        drawn.set_linestyle((0, [length / layer.width_mm for length in layer.dash_mm]))
    return drawn


def _outline(item: Polyline | Circle) -> Outline:
    if isinstance(item, Circle):
        return Outline.circle((float(item.centre[0]), float(item.centre[1])), item.radius_mm)
    # a hole must run in the other direction
    rings = [_ring(item.points, 1), *(_ring(hole, -1) for hole in item.holes)]
    return Outline.make_compound_path(*rings)


def _ring(points: Floats, turn: int) -> Outline:
    """A closed line that runs counterclockwise (1) or clockwise (-1)."""
    x, y = points.T
    area = x @ np.roll(y, -1) - y @ np.roll(x, -1)
    ordered = points if area * turn > 0 else points[::-1]
    return Outline(np.concatenate([ordered, ordered[:1]]), closed=True)


def _write_text(figure: Figure, item: Label, to_page: Transform) -> None:
    # a number may stand on an arm: first a white line around it, then the text, so that a search finds it
    # width of the white line around a number
    halo = [Stroke(linewidth=1.0 * _POINTS_PER_MM, foreground="white")]
    for effects in [halo, None] if item.layer.name == NEEDLES.name else [None]:
        figure.text(
            float(item.at[0]),
            float(item.at[1]),
            printable(item.text),
            transform=to_page,
            fontsize=item.size_mm * _POINTS_PER_MM,
            family=["DejaVu Sans Mono", *families()] if item.fixed_pitch else families(),
            weight="bold" if item.bold else "normal",
            color=item.layer.colour,
            ha="left" if item.end == "left" else "center",
            va="baseline",
            parse_math=False,
            path_effects=effects,
        )
