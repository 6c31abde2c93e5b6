"""The 1:1 sheets: layout, stretch check, and the template for drilling the base."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.planar import dense_outline
from asterism.print.drawing import (
    CUT,
    NEEDLES,
    RODS,
    STARS,
    TEXT,
    Circle,
    Drawing,
    DrawingLayer,
    Label,
    Polyline,
    cross_mark,
    font_size_within,
    rectangle,
)
from asterism.print.job import Job
from asterism.print.needles import HOLE_DIAMETER_MM
from asterism.results.words import fixed_point

MARKS = DrawingLayer("alignment", "#0a7d32", 0.2, meaning="alignment marks")
# margin around the drawing and the column
PAGE_MARGIN_MM = 18.5
# width of the column of text, with its margin
COLUMN_MM = 123.0

DrawingItems = list[Polyline | Circle | Label]


def layout_sheet(job: Job) -> Drawing:
    """The layout on the printer: frame, printable area, pattern, cut lines, needles, marks, check squares."""
    frame, bed = job.printer.frame.size_mm, job.printer.bed_mm
    items: DrawingItems = []
    below = DrawingLayer("below", "#7c93ab", filled=True, meaning="plastic below the fabric")
    for steps, layer in ((job.above, STARS if job.arms else RODS), (job.below, below)):
        items += areas(steps[0].region, layer) if steps else []
    if job.border is not None:
        guide = DrawingLayer("printed-border", "#8a8a94", filled=True, meaning="printed line to cut along")
        items += areas(job.border.region, guide)
    items += [Polyline(CUT, job.placement.points(line), closed=True) for line in job.cut]
    opening = DrawingLayer("frame-opening", "#6b6b6b", 0.2, meaning="inside of the frame")
    reached = DrawingLayer("printable-area", "#2f6fc1", 0.25, (4.0, 2.0), meaning="what the nozzle reaches")
    items.append(rectangle(DrawingLayer("frame", "#6b6b6b", 0.5, meaning="frame"), frame))
    items += [rectangle(opening, job.printer.frame.opening_mm), rectangle(reached, bed)]
    items += _marks(frame, bed)
    items += [*check_squares(job), *grain_arrow(job, is_stretched=True)]
    for needle in job.needles:
        items += _needle(job.placement.points(needle.printed), str(needle.number))
    field = np.max([frame, bed, job.check_after_mm], axis=0)
    items.append(Label(TEXT, np.array([-frame[0] / 4, -field[1] / 2 - 8.0]), "front of the printer", 4.0, "middle"))
    x, y = job.clamped_stretch
    sizes = ", ".join(f"{height:g}" for height in sorted({step.height_mm for step in job.pattern}))
    paragraphs = [
        "Seen from above, the plastic on top, as it lies on the printer.",
        f"{job.printer.name}: frame {frame[0]:g} x {frame[1]:g} mm, nozzle within {bed[0]:g} x {bed[1]:g} mm.",
        f"{_counted(job)}, {sizes} mm thick, of {job.plastic.name}.",
        f"Fabric stretched by {x:g}" + (f" along x and {y:g} along y." if x != y else "."),
        f"Start the nozzle {job.z_offset_mm:.2f} mm above the bed.",
    ]
    if job.design.fabric.is_orthotropic:
        paragraphs.insert(-1, grain_in_words(job))
    if job.below:
        paragraphs[0] = "Seen from above. Plastic below is printed with the frame turned over, left to right."
    if not job.fabric_given:
        paragraphs[-1] += " That is with the released fabric: stretched it is thinner, measure it."
    if job.placement.turn_deg:
        paragraphs.append(f"Turned by {job.placement.turn_deg:g} deg from the design.")
    if job.plan.rim:
        paragraphs.append("Cut along the outer edge of the printed rim.")
    elif job.border is None:
        paragraphs.append("No printed border: mark the cut line by hand.")
    return _sheet(job, "layout", field, np.zeros(2), items, "Layout 1:1", paragraphs)


def _counted(job: Job) -> str:
    """The number of stars, and the length of the drawn rods."""
    count = len(job.plan.centres)
    stars = f"{count} star{'s' if count > 1 else ''}"
    if not job.rods:
        return stars
    lines = f"{sum(rod.length for rod in job.plan.drawn_rods):.0f} mm of drawn lines"
    return f"{stars} and {lines}" if job.arms else lines


def stretch_sheet(job: Job) -> Drawing:
    """The check square on the released fabric, and its size after stretching."""
    before, (x, y) = job.check_before_mm, job.check_after_mm
    items = [*check_squares(job), *cross_mark(MARKS, np.zeros(2), 5.0), *grain_arrow(job, is_stretched=False)]
    # within the square, or below both squares if the words are wider
    # width of the words in a check square
    at = before / 2 - 7.0 if before > 50.0 else -y / 2 - 7.0
    items.append(Label(TEXT, np.array([0.0, at]), f"before: {before:g} x {before:g} mm", 4.0, "middle"))
    items.append(Label(TEXT, np.array([0.0, y / 2 + 3.0]), f"after: {x:.1f} x {y:.1f} mm", 4.0, "middle"))
    field = np.maximum(job.printer.frame.size_mm, [x + 20.0, y + 20.0])
    lies = "its sides along the threads that will lie along the frame"
    if job.design.fabric.is_orthotropic:
        lies = "with the grain along the arrow"
    longer = 1.0 + 0.01 * job.settings.fabric_set_percent
    measured = f"stretch that you measured, over {longer:g}," if longer > 1.0 else "stretch that you measured"
    paragraphs = [
        f"1. Lay the relaxed fabric on this page and draw the dashed square on it, {lies}.",
        f"2. Stretch and clamp the fabric. The square must now be {x:.1f} mm wide (left to right) and {y:.1f} mm deep.",
        f"3. A millimetre off is a stretch that is off by {1 / before:.2g}. If you cannot do better, write the "
        f"{measured} into fabric.stretch of the design, as [x, y], and look at its shape again.",
    ]
    return _sheet(job, "stretch check", field, np.zeros(2), items, "Stretch check 1:1", paragraphs)


def grain_arrow(job: Job, is_stretched: bool) -> DrawingItems:
    """An arrow along the grain of the stretched or released fabric as it lies on the printer; none without a grain."""
    fabric = job.design.fabric
    if not fabric.is_orthotropic:
        return []
    along = fabric.axes[:, 0] * (fabric.stretch_xy if is_stretched else 1.0)
    ends = job.placement.points(np.array([np.zeros(2), along / np.linalg.norm(along)]))
    along = ends[1] - ends[0]
    across = np.array([-along[1], along[0]])
    tip = 30.0 * along
    head = [tip - 6.0 * along + side * 2.4 * across for side in (1.0, -1.0)]
    pen = DrawingLayer("grain", "#8a4b08", 0.5, meaning="along the grain of the fabric")
    return [Polyline(pen, np.array([-tip, tip, head[0], head[1], tip]))]


def grain_in_words(job: Job) -> str:
    """How the grain lies, in one sentence for a fabric that has one."""
    fabric, unit = job.design.fabric, "MPa"
    along, across = fabric.moduli
    if along == across and isinstance(fabric.bending_stiffness_n_mm, tuple):
        (along, across), unit = fabric.bending_stiffness_n_mm, "N mm of bending stiffness"
    if along == across:
        return "Along the arrow runs the grain of the fabric."
    ahead = f"Along the arrow runs the direction of the fabric that has {along:g} {unit}"
    return f"{ahead}; across it, it has {across:g} {unit}."


def check_squares(job: Job) -> DrawingItems:
    """The check square in the middle of the frame, before and after stretching."""
    dashes, words = (1.5, 1.5), ("square drawn on the relaxed fabric", "the same square on the stretched fabric")
    before = DrawingLayer("check-before-stretching", "#d98200", 0.25, dashes, meaning=words[0])
    after = DrawingLayer("check-after-stretching", "#d98200", 0.3, meaning=words[1])
    return [rectangle(before, (job.check_before_mm, job.check_before_mm)), rectangle(after, job.check_after_mm)]


def needle_sheet(job: Job) -> Drawing | None:
    """The template for drilling the base; None if the place of no needle is known."""
    known = [(needle, needle.place) for needle in job.needles if needle.place is not None]
    if not known:
        return None
    items: DrawingItems = []
    points = np.array([place[:2] for _, place in known])
    if job.shape is not None:
        outline = job.shape.at_edges(dense_outline(job.plan.outline))[:, :2]
        meaning = "edge of the sheet in space, seen from above"
        items.append(Polyline(DrawingLayer("outline", CUT.colour, 0.2, (3.0, 1.5), meaning=meaning), outline, True))
        points = np.concatenate([points, outline])
    low, high = np.minimum(points.min(axis=0), 0.0), np.maximum(points.max(axis=0), 0.0)
    items += cross_mark(MARKS, np.zeros(2), 8.0)
    items.append(Label(TEXT, _clear_of(points), "origin", 3.0, "middle"))
    table = [" no       x        y        z  mm"]
    for needle, (x, y, z) in known:
        items += _needle(np.array([x, y]), str(needle.number) + (f"  z {z:.1f}" if needle.is_raised else ""))
        marks = [f"  slides: {needle.slides}"] * bool(needle.slides) + [f"  step {needle.step}"] * bool(needle.step)
        table.append(
            f"{needle.number:3d} "
            + " ".join(f"{'-' if np.isnan(c) else fixed_point(c, 2):>8}" for c in (x, y, z))
            + "".join(marks)
        )
    # rows of the table of needles
    if len(table) > 40:
        table = ["All needles are in needles.csv."]
    paragraphs = [
        f"Glue this page on the base, drill {HOLE_DIAMETER_MM:g} mm holes at the circles, set the needles upright.",
        "The numbers are those of the layout: push every needle through the sheet at its place there.",
        "z is the height of the sheet above the base; beside a hole without one it is 0"
        + (", or the sheet slides." if any(needle.height_mm is None for needle, _ in known) else "."),
    ]
    if any(needle.step for needle, _ in known):
        paragraphs.append("Steps are set one after the other, needles without one first.")
    if any(needle.height_mm is None for needle, _ in known):
        paragraphs.append("Where the sheet slides along z, its height is not known without a shape: it finds its own.")
    if any(needle.slides and needle.height_mm is not None for needle, _ in known):
        paragraphs.append("Where the sheet slides (along z, or in the plane) the place is that of its computed shape.")
    field = np.maximum(job.printer.frame.size_mm, high - low + 40.0)
    return _sheet(job, "needles", field, (low + high) / 2, items, "Drilling template 1:1", paragraphs, table)


def middle_lines(job: Job) -> Drawing:
    """The rods of the printed design in printed coordinates, as wide lines: a layer for each name, width and face.

    A rod whose width varies has its mean width. The page is the box around the cut lines.
    """
    rods = job.plan.drawn_rods
    widths: dict[str, set[float]] = {}
    # characters that names of layers cannot have in DXF
    names = (re.sub(r'[<>/\\":;?*=`|,\x00-\x1f]', "_", rod.name) + " below" * (rod.side < 0) for rod in rods)
    keys = [(name, round(float(rod.width.mean()), 3)) for name, rod in zip(names, rods, strict=True)]
    for name, width in keys:
        widths.setdefault(name, set()).add(width)
    layers = {
        (name, width): DrawingLayer(
            name if len(widths[name]) == 1 else f"{name} {width:g}", RODS.colour, width, is_printed_width=True
        )
        for name, width in dict.fromkeys(keys)
    }
    items = []
    for rod, key in zip(rods, keys, strict=True):
        closed = rod.start == rod.end
        items.append(Polyline(layers[key], rod.points[:-1] if closed else rod.points, closed=closed))
    everything = np.concatenate(job.cut)
    return Drawing(f"{job.design.name}: middle lines", everything.min(axis=0), everything.max(axis=0), tuple(items))


def _clear_of(needles: Floats) -> Floats:
    """Place of a word beside the origin, as far as possible from needles (n, 2) and their labels."""
    places = np.array([[0.0, 9.5], [0.0, -12.5], [-14.0, -1.0], [14.0, -1.0]])
    marks = np.concatenate([needles + np.array(along) for along in ([0.0, 0.0], [6.0, 3.0], [12.0, 3.0])])
    distance = np.linalg.norm(places[:, None] - marks, axis=2).min(axis=1)
    return np.asarray(places[np.minimum(distance, 20.0).argmax()])


def areas(region: BaseGeometry, layer: DrawingLayer) -> DrawingItems:
    """The polygons of a region with their holes."""
    lines: DrawingItems = []
    for polygon in shapely.get_parts(region):
        rings = [np.asarray(ring.coords)[:-1] for ring in (polygon.exterior, *polygon.interiors)]
        lines.append(Polyline(layer, rings[0], closed=True, holes=tuple(rings[1:])))
    return lines


def _marks(frame: tuple[float, float], bed: tuple[float, float]) -> DrawingItems:
    """Crosses in the middle and at the corners of the bed, and ticks in the middle of the frame's sides."""
    items: DrawingItems = [*cross_mark(MARKS, np.zeros(2), 5.0)]
    for corner in np.asarray(bed) / 2 * [[-1, -1], [1, -1], [1, 1], [-1, 1]]:
        items += cross_mark(MARKS, corner, 3.0)
    for outwards in np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]]):
        side = outwards * frame / 2
        items.append(Polyline(MARKS, np.array([side - 6.0 * outwards, side + 6.0 * outwards])))
    return items


def _needle(at: Floats, label: str) -> DrawingItems:
    return [
        Circle(NEEDLES, at, HOLE_DIAMETER_MM / 2),
        *cross_mark(NEEDLES, at, 2.5),
        Label(NEEDLES, at + 1.6, label, 3.2),
    ]


def _sheet(
    job: Job,
    kind: str,
    field_mm: Floats,
    centre: Floats,
    items: DrawingItems,
    what: str,
    paragraphs: Sequence[str],
    table: Sequence[str] = (),
) -> Drawing:
    """A page around a field (2,) mm about `centre`, with a column: name, `what`, ruler, legend, paragraphs, table."""
    name, half = job.design.name, field_mm / 2
    low, high = centre - half - PAGE_MARGIN_MM, centre + half + PAGE_MARGIN_MM + [COLUMN_MM, 0.0]
    at = np.array([high[0] - COLUMN_MM, high[1] - PAGE_MARGIN_MM - 6.0])
    size = font_size_within(name, 7.0, COLUMN_MM - PAGE_MARGIN_MM)
    column: DrawingItems = [Label(TEXT, at, name, size, bold=True), Label(TEXT, at - [0.0, 9.0], what, 4.5)]
    column += _ruler(at - [0.0, 21.0])
    at = at - [0.0, 37.0]
    for layer in dict.fromkeys(item.layer for item in items):
        if layer.meaning:
            column += _legend(layer, at)
            at = at - [0.0, 6.0]
    at = at - [0.0, 5.0]
    for paragraph in paragraphs:
        # characters in a line of the column
        for line in textwrap.wrap(paragraph, 48) or [""]:
            column.append(Label(TEXT, at, line, 3.6))
            at = at - [0.0, 5.2]
        at = at - [0.0, 2.2]
    for line in table:
        column.append(Label(TEXT, at, line, 3.0, fixed_pitch=True))
        at = at - [0.0, 4.2]
    lowest = min(item.at[1] for item in column if isinstance(item, Label)) - PAGE_MARGIN_MM / 2
    low[1] = min(low[1], lowest)
    return Drawing(f"{name}: {kind}", low, high, (*items, *column))


def _ruler(at: Floats) -> DrawingItems:
    # length of the ruler that shows whether the page is printed at 100 %
    ends = at + np.array([[0.0, 0.0], [100.0, 0.0]])
    pen = DrawingLayer("ruler", TEXT.colour, 0.3)
    ticks = [Polyline(pen, end + np.array([[0.0, -2.0], [0.0, 2.0]])) for end in ends]
    words = Label(TEXT, at - [0.0, 6.5], "100 mm: measure it. Print at 100 %.", 3.6)
    return [Polyline(pen, ends), *ticks, words]


def _legend(meant: DrawingLayer, at: Floats) -> DrawingItems:
    # on a layer of its own: a laser that cuts the layer "cut" must not cut the legend
    layer = replace(meant, name=f"legend-{meant.name}", meaning="")
    if layer.filled:
        box = at + np.array([[0.0, 0.0], [12.0, 0.0], [12.0, 2.4], [0.0, 2.4]])
        sample = Polyline(layer, box, closed=True)
    else:
        sample = Polyline(layer, at + np.array([[0.0, 1.2], [12.0, 1.2]]))
    return [sample, Label(TEXT, at + np.array([15.0, 0.0]), meant.meaning, 3.6)]
