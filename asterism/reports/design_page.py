"""The A4 page about a design as PDF: picture, facts, layout at a round scale, needles."""

from __future__ import annotations

import textwrap
import warnings
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import shapely
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline
from matplotlib.transforms import Affine2D, Transform
from PIL import Image
from shapely.geometry.base import BaseGeometry

from asterism.draw.colours import INK, PALE
from asterism.draw.fonts import families, printable
from asterism.draw.picture import draw_shape
from asterism.equilibrium.arrays import Floats
from asterism.print.drawing import A4_MM
from asterism.print.job import Job
from asterism.reports.facts import Facts
from asterism.shape.shape import Shape

# width and height of the page
PAGE_MM = np.array(A4_MM)
# empty border of the page
DESIGN_PAGE_MARGIN_MM = 15.0
# colours of needles and warnings, and of the sheet
RED = "#c8553d"
SHEET = "#f3f1ea"
# size of the area for the layout, and its lower left corner on the page
LAYOUT_MM = np.array([112.0, 122.0])
LAYOUT_AT = np.array([83.0, 42.0])
# baselines of the first and of the last line of the facts; their distances, below a line and below a paragraph
FACTS_MM = (170.0, 40.0)
LINE_MM, HEAD_MM = 4.2, 6.4
# the page lists the places of at most this many needles
MAX_LISTED_NEEDLES = 12
# longest line of the warnings, in characters
WARNING_WIDTH = 145
# largest number of lines of the warnings
MAX_WARNING_LINES = 3
# scales 1:n of the layout
SCALES = (1, 1.5, 2, 2.5, 3, 4, 5, 10, 20, 50)
# points per mm
_POINTS = 72 / 25.4


def write_design_page(path: Path, job: Job, facts: Facts, lines: Sequence[str], shape: Shape | None) -> float:
    """Write the page as PDF.

    Parameters
    ----------
    job : the design on the printer's bed.
    facts : from `asterism.reports.facts.design_facts`.
    lines : warnings about the shape.
    shape : shape of the picture; the page has no picture if it is None.

    Returns
    -------
    n of the layout's scale 1:n.
    """
    figure = Figure(figsize=tuple(PAGE_MM / 25.4), dpi=72.0, facecolor="white")
    FigureCanvasAgg(figure)
    to_page = Affine2D().scale(_POINTS)
    name = job.design.name
    _text(figure, to_page, DESIGN_PAGE_MARGIN_MM, 276.0, name, 7.0 * min(1.0, 40 / max(len(name), 1)), weight="bold")
    if shape is not None:
        _picture(figure, shape)
    _warnings(figure, to_page, lines)
    _facts(figure, to_page, facts)
    parts = _layout(figure, to_page, job)
    _needles(figure, to_page, job)
    settings: dict[Any, Any] = {"pdf.fonttype": 42, "path.simplify": False}
    with warnings.catch_warnings(), matplotlib.rc_context(settings):
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        page = BytesIO()
        figure.savefig(page, format="pdf", dpi=300, metadata={"Title": name, "CreationDate": None})
    # not by matplotlib, whose error on a full disk is not an OSError
    path.write_bytes(page.getvalue())
    return parts


def _picture(figure: Figure, shape: Shape) -> None:
    stream = BytesIO()
    draw_shape(shape, "", stream)
    with Image.open(stream) as image:
        # without the caption, which the page repeats as text
        pixels = np.asarray(image.convert("RGB"))[140:]
    height, width = pixels.shape[:2]
    size = np.array([PAGE_MM[0] - 2 * DESIGN_PAGE_MARGIN_MM, 0.0])
    size[1] = size[0] * height / width
    low = np.array([DESIGN_PAGE_MARGIN_MM, 270.0 - size[1]])
    axes = figure.add_axes((*(low / PAGE_MM), *(size / PAGE_MM)))
    axes.imshow(pixels, interpolation="none")
    axes.axis("off")


def _warnings(figure: Figure, to_page: Transform, texts: Sequence[str]) -> None:
    """Write the warnings between the picture and the facts, as many as fit."""
    lines = [line for text in texts for line in textwrap.wrap(text, WARNING_WIDTH)]
    if len(lines) > MAX_WARNING_LINES:
        lines = [*lines[: MAX_WARNING_LINES - 1], "... and more: see the summary of the results"]
    for k, line in enumerate(lines):
        _text(figure, to_page, DESIGN_PAGE_MARGIN_MM, 181.5 - 3.2 * k, line, 2.3, color=RED)


def _facts(figure: Figure, to_page: Transform, facts: Facts) -> None:
    top, bottom = FACTS_MM
    needed = sum(LINE_MM * len(lines) for lines in facts.values()) + HEAD_MM * (len(facts) - 1)
    squeezed = min(1.0, (top - bottom) / needed)
    y = top
    for head, lines in facts.items():
        _text(figure, to_page, DESIGN_PAGE_MARGIN_MM, y, head, 3.3 * squeezed, weight="bold")
        for line in lines:
            y -= LINE_MM * squeezed
            _text(figure, to_page, DESIGN_PAGE_MARGIN_MM, y, line, 2.7 * squeezed)
        y -= HEAD_MM * squeezed


def _layout(figure: Figure, to_page: Transform, job: Job) -> float:
    """Draw the printed layout, seen from the plastic side, with its needles; returns n of its scale 1:n."""
    border = job.plan.outline
    low, high = border.min(axis=0), border.max(axis=0)
    parts = next((n for n in SCALES if ((high - low) / n <= LAYOUT_MM).all()), SCALES[-1])
    middle = LAYOUT_AT + LAYOUT_MM / 2
    to_drawing = Affine2D().translate(*-(low + high) / 2).scale(1 / parts).translate(*middle) + to_page
    sheet = shapely.Polygon(border, job.plan.holes)
    _draw(figure, to_drawing, sheet, facecolor=SHEET, edgecolor=PALE, linewidth=0.6)
    for arm in job.arms:
        _draw(figure, to_drawing, shapely.Polygon(arm.corners(job.plan.centres[arm.star])), facecolor=INK, linewidth=0)
    for rod in job.rods:
        _draw(figure, to_drawing, rod.region, facecolor=INK, linewidth=0)
    for needle in job.needles[:200]:
        spot = shapely.Point(needle.printed).buffer(1.0 * parts)
        _draw(figure, to_drawing, spot, facecolor=RED, linewidth=0)
        if len(job.needles) <= MAX_LISTED_NEEDLES:
            # the number stands towards the middle, so that it stays within the drawing
            inwards = (low + high) / 2 - needle.printed
            far = float(np.linalg.norm(inwards))
            at = needle.printed + 4.0 * parts * (inwards / far if far > 4.0 * parts else np.array([0.0, 1.0]))
            x, y = (at - (low + high) / 2) / parts + middle
            # with a background, since it may lie on an arm
            style = {"color": RED, "weight": "bold", "bbox": {"facecolor": SHEET, "edgecolor": "none", "pad": 0.6}}
            _text(figure, to_page, x, y - 1.0, str(needle.number), 2.8, ha="center", **style)
    head = f"Layout 1:{parts:g}, on the stretched fabric, plastic side"
    _text(figure, to_page, LAYOUT_AT[0], LAYOUT_AT[1] + LAYOUT_MM[1] + 5.0, head, 3.3, weight="bold")
    return float(parts)


def _needles(figure: Figure, to_page: Transform, job: Job) -> None:
    needles = job.needles
    if not needles:
        _text(figure, to_page, DESIGN_PAGE_MARGIN_MM, 33.0, "No needles: the sheet is free.", 2.7, color=PALE)
        return
    _text(figure, to_page, DESIGN_PAGE_MARGIN_MM, 35.0, f"Needles: {len(needles)}", 3.3, weight="bold")
    if len(needles) > MAX_LISTED_NEEDLES:
        text = "Red dots in the layout. asterism export writes their places (needles.csv) and a drilling template."
        _text(figure, to_page, DESIGN_PAGE_MARGIN_MM, 30.5, text, 2.7)
        return
    for i, needle in enumerate(needles):
        column, row = divmod(i, 4)
        printed = _numbers(needle.printed)
        place = "slides" if needle.place is None else _numbers(needle.place)
        text = f"{needle.number}: printed ({printed}), stands at ({place})"
        _text(figure, to_page, DESIGN_PAGE_MARGIN_MM + 62.0 * column, 30.5 - 4.2 * row, text, 2.3)


def _numbers(place: Floats) -> str:
    """Coordinates in mm, without negative zeros; an open coordinate is `slides`."""
    return ", ".join("slides" if np.isnan(value) else f"{value:.1f}" for value in np.round(place, 1) + 0.0)


def _draw(figure: Figure, transform: Transform, region: BaseGeometry, **style: Any) -> None:
    for polygon in shapely.orient_polygons(shapely.get_parts(region)):
        rings = [polygon.exterior, *polygon.interiors]  # holes run the other way round
        outline = Outline.make_compound_path(*(Outline(np.asarray(ring.coords), closed=True) for ring in rings))
        figure.add_artist(PathPatch(outline, transform=transform, **style))


def _text(
    figure: Figure, to_page: Transform, x: float | Floats, y: float | Floats, text: str, size_mm: float, **style: Any
) -> None:
    settings: dict[str, Any] = {"color": INK, "family": families(), "parse_math": False} | style
    figure.text(float(x), float(y), printable(text), transform=to_page, fontsize=size_mm * _POINTS, **settings)
