"""`asterism report`: a design on one A4 page as PDF, with picture, facts, layout at a round scale and needles."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from matplotlib.figure import Figure
from PIL import Image

from asterism.draw.picture import draw_shape
from asterism.draw.style import PALE, RED
from asterism.equilibrium.arrays import Floats
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import ResidualCurvature
from asterism.pattern.design.stars import ROD_SIZES
from asterism.pattern.layout.layout import Layout
from asterism.print.drawing import A4_MM, NEEDLES, STARS, TEXT, Circle, Drawing, DrawingLayer, Label, Polyline
from asterism.print.formats.pdf import write_pdf
from asterism.print.job import Job, prepare
from asterism.print.printer import PlasticProfile, Printer, load_plastic, load_printer
from asterism.print.sheets import areas
from asterism.process.progress import Say, ignore_line
from asterism.results.files import check_file, staged
from asterism.results.record import Record
from asterism.results.words import VISIBLE_SAG_MM, shape_in_words
from asterism.shape.shape import Shape
from asterism.shape.vtu import SHAPE_FILE, read_shape


@dataclass(frozen=True)
class DesignReport:
    """A written report.

    Attributes
    ----------
    job : the design on the printer's bed.
    shape : the shape in the picture; None if no preview is available.
    source : origin of the shape, or the reason for its absence.
    scale : n of the layout's scale 1:n.
    """

    job: Job
    shape: Shape | None
    source: str
    scale: float


def report(
    design: Design,
    path: str | Path,
    *,
    results: str | Path | Shape | None = None,
    beside: str | Path | None = None,
    printer: str | Printer = "ultimaker2",
    plastic: str | PlasticProfile = "tpu95a",
    law: Law[Any] | None = None,
    say: Say | None = None,
) -> DesignReport:
    """Write one A4 page about a design as PDF: parameters, picture, layout, needles, accuracy and material.

    Parameters
    ----------
    path : file of the page; it ends with `.pdf`.
    results : a shape of this design, the directory of its results, or its shape.vtu; a new preview by default.
    beside : directory whose results are used if they belong to this design; ignored otherwise.
    printer, plastic : a profile, its name, or its file.
    law : law of a new preview; that of the paper's material by default.
    say : called with a line if no picture is available, or if the first run compiles loops.

    Raises
    ------
    DesignError
        The results belong to another design, or a profile is wrong.
    LawError
        A law and results are given together.
    OutputError
        The page cannot be written.
    """
    if law is not None and results is not None:
        raise LawError("--law: is for a new preview, not with --results")
    path = Path(path)
    check_file(path, ".pdf")
    machine = load_printer(printer)
    profile = load_plastic(plastic)
    # before the preview: this finds most mistakes
    prepare(design, machine, profile, any_size=True)
    shape, source = _shape_of(design, results, beside, say or ignore_line, law)
    job = prepare(design, machine, profile, shape=shape, any_size=True)
    summary: Mapping[str, Any] = shape.summary if shape is not None else {}
    facts = design_facts(job, summary, source)
    with staged(path.parent) as folder:
        scale = _write_design_page(folder / path.name, job, facts, summary.get("warnings", []), shape)
    return DesignReport(job, shape, source, scale)


def _shape_of(
    design: Design, results: str | Path | Shape | None, beside: str | Path | None, say: Say, law: Law[Any] | None
) -> tuple[Shape | None, str]:
    """A shape of the design and its origin; None and the reason if there is no preview."""
    from asterism.homogenize.law.plan import without_law
    from asterism.previews.session import preview
    from asterism.process.compiling import announce_compiling

    if results is not None:
        shape = results if isinstance(results, Shape) else read_shape(results)
        if not _is_of(shape, design):
            raise DesignError("--results", "must be of this design; compute them again", str(results))
        return shape, shape.made_by
    if beside is not None and Path(beside, SHAPE_FILE).is_file():
        with suppress(DesignError):  # unreadable results beside the design are ignored
            shape = read_shape(beside)
            if _is_of(shape, design) and not (law is not None and shape.is_preview):
                return shape, shape.made_by
    if (refused := without_law(design)) is not None:
        say(f"the page has no picture: {refused} first")
        return None, "not known: this design has no preview"
    try:
        with announce_compiling(say):
            shape = preview(design, law)
    except LawError as error:
        give = "--law or --results" if isinstance(error, ForeignLaw) else "--results"
        say(f"the page has no picture: {error}; give {give}")
        return None, "not known: no law of this material and lattice"
    return shape, shape.made_by


def _is_of(shape: Shape, design: Design) -> bool:
    """Whether a shape belongs to this design; name, mesh and solver may differ."""
    made_from = shape.summary.get("design")
    try:
        other = None if made_from is None else Design.from_dict(made_from)
    except DesignError:
        return False
    aside = {name: getattr(design, name) for name in ("name", "mesh", "solver")}
    return other is not None and other.model_copy(update=aside) == design


Facts = dict[str, list[str]]


# width and height of the page
PAGE_MM = np.array(A4_MM)
# empty border of the page
_MARGIN_MM = 15.0
NOTES = DrawingLayer("notes", PALE)
# size of the area for the layout, and its lower left corner on the page
LAYOUT_MM = np.array([112.0, 122.0])
LAYOUT_AT = np.array([83.0, 42.0])
# the page lists the places of at most this many needles
MAX_LISTED_NEEDLES = 12


def _write_design_page(path: Path, job: Job, facts: Facts, lines: Sequence[str], shape: Shape | None) -> float:
    """Write the page as PDF, with these facts and warnings; returns n of the layout's scale 1:n."""
    name, page = job.design.name, BytesIO()
    title = _text(_MARGIN_MM, 276.0, name, 7.0 * min(1.0, 40 / max(len(name), 1)), bold=True)
    items, parts = _layout(job)
    items = [title, *_warnings(lines), *_facts(facts), *items, *_needles(job)]
    drawing = Drawing(name, np.zeros(2), PAGE_MM, tuple(items))
    write_pdf(page, [drawing], None if shape is None else partial(_picture, shape=shape))
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
    size = np.array([PAGE_MM[0] - 2 * _MARGIN_MM, 0.0])
    size[1] = size[0] * height / width
    low = np.array([_MARGIN_MM, 270.0 - size[1]])
    axes = figure.add_axes((*(low / PAGE_MM), *(size / PAGE_MM)))
    axes.imshow(pixels, interpolation="none")
    axes.axis("off")


def _text(x: float, y: float, text: str, size_mm: float, layer: DrawingLayer = TEXT, bold: bool = False) -> Label:
    return Label(layer, np.array([x, y]), text, size_mm, bold=bold)


def _warnings(texts: Sequence[str]) -> list[Label]:
    """The warnings between the picture and the facts, as many as fit."""
    # longest line of the warnings, in characters
    lines = [line for text in texts for line in textwrap.wrap(text, 145)]
    if len(lines) > 3:
        lines = [*lines[:2], "... and more: see the summary of the results"]
    pen = DrawingLayer("doubts", RED)
    return [_text(_MARGIN_MM, 181.5 - 3.2 * k, line, 2.3, pen) for k, line in enumerate(lines)]


def _facts(facts: Facts) -> Iterator[Label]:
    # baselines of the first and of the last line of the facts; their distances, below a line and below a paragraph
    top, bottom = (170.0, 40.0)
    below_line, below_paragraph = (4.2, 6.4)
    needed = sum(below_line * len(lines) for lines in facts.values()) + below_paragraph * (len(facts) - 1)
    squeezed = min(1.0, (top - bottom) / needed)
    y = top
    for head, lines in facts.items():
        yield _text(_MARGIN_MM, y, head, 3.3 * squeezed, bold=True)
        for line in lines:
            y -= below_line * squeezed
            yield _text(_MARGIN_MM, y, line, 2.7 * squeezed)
        y -= below_paragraph * squeezed


def _layout(job: Job) -> tuple[list[Polyline | Circle | Label], float]:
    """The printed layout, seen from the plastic side, with its needles; n of its scale 1:n."""
    border = job.plan.outline
    low, high = border.min(axis=0), border.max(axis=0)
    scales = (1, 1.5, 2, 2.5, 3, 4, 5, 10, 20, 50)
    parts = next((n for n in scales if ((high - low) / n <= LAYOUT_MM).all()), scales[-1])

    def on_page(places: Floats) -> Floats:
        return (np.asarray(places) - (low + high) / 2) / parts + LAYOUT_AT + LAYOUT_MM / 2

    sheet, below = DrawingLayer("sheet", "#f3f1ea", filled=True), DrawingLayer("below", PALE, filled=True)
    dots = replace(NEEDLES, colour=RED, filled=True)
    holes = tuple(map(on_page, job.plan.holes))
    items: list[Polyline | Circle | Label] = [Polyline(sheet, on_page(border), closed=True, holes=holes)]
    items += [Polyline(NOTES, ring, closed=True) for ring in (on_page(border), *holes)]
    for piece in (*job.arms, *job.rods):
        items += areas(shapely.transform(piece.region, on_page), STARS if piece.side > 0 else below)
    for needle in job.needles[:200]:
        items.append(Circle(dots, on_page(needle.printed), 1.0))
        if len(job.needles) <= MAX_LISTED_NEEDLES:
            # the number stands towards the middle, so that it stays within the drawing
            inwards = (low + high) / 2 - needle.printed
            far = float(np.linalg.norm(inwards))
            at = needle.printed + 4.0 * parts * (inwards / far if far > 4.0 * parts else np.array([0.0, 1.0]))
            items.append(Label(dots, on_page(at) - [0.0, 1.0], str(needle.number), 2.8, "middle", bold=True))
    head = f"Layout 1:{parts:g}, on the stretched fabric, " + ("plastic below grey" if job.below else "plastic side")
    items.append(_text(LAYOUT_AT[0], LAYOUT_AT[1] + LAYOUT_MM[1] + 5.0, head, 3.3, bold=True))
    return items, float(parts)


def _needles(job: Job) -> Iterator[Label]:
    needles = job.needles
    if not needles:
        yield _text(_MARGIN_MM, 33.0, "No needles: the sheet is free.", 2.7, NOTES)
        return
    yield _text(_MARGIN_MM, 35.0, f"Needles: {len(needles)}", 3.3, bold=True)
    if len(needles) > MAX_LISTED_NEEDLES:
        text = "Red dots in the layout. asterism export writes their places (needles.csv) and a drilling template."
        yield _text(_MARGIN_MM, 30.5, text, 2.7)
        return
    for i, needle in enumerate(needles):
        column, row = divmod(i, 4)
        printed = _numbers(needle.printed)
        place = "slides" if needle.place is None else _numbers(needle.place)
        text = f"{needle.number}: printed ({printed}), stands at ({place})"
        yield _text(_MARGIN_MM + 62.0 * column, 30.5 - 4.2 * row, text, 2.3)


def _numbers(place: Floats) -> str:
    """Coordinates in mm, without negative zeros; an open coordinate is `slides`."""
    return ", ".join("slides" if np.isnan(value) else f"{value:.1f}" for value in np.round(place, 1) + 0.0)


def design_facts(job: Job, summary: Mapping[str, Any], source: str) -> Facts:
    """Lines on parameters, shape (with its origin), accuracy and material, as far as they are available."""
    plastic = job.design.plastic
    kept = plastic.kappa_bar_per_mm
    bar = "by thickness" if isinstance(kept, ResidualCurvature) else f"{kept:g} /mm"
    if accuracy := _rows(summary, "expected_rms_percent", "mesh_error_percent", "law"):
        accuracy += ["Errors of the computation, not of the print,", "whose distance was not measured."]
    facts = {
        "Fabric": _fabric(job.design),
        "Plastic": [f"E1/E2 {plastic.modulus_ratio:g}, {plastic.rest_curvature}", f"kappa_bar {bar}"],
        "Stars": _stars(job.drawn_plan, job.design) if job.arms else [],
        "Rods": _rods(job.drawn_plan),
        "Shape": [
            source,
            *_as_drawn(job, summary),
            *_rows(summary, "height_mm", "extent_mm", "above_needles_mm"),
            *([shape_in_words(summary)] if "is_minimum" in summary else []),
            *_hanging(job),
        ],
        "Computation": accuracy,
        "Print": _print(job),
    }
    return {head: lines for head, lines in facts.items() if lines}


def _fabric(design: Design) -> list[str]:
    x, y = design.fabric.stretch_xy
    stretch = f"{x:g}" if x == y else f"{x:g} along x, {y:g} along y"
    lines = [f"stretch {stretch}, {design.fabric.thickness_mm:g} mm thick", f"bending: {design.fabric.bending}"]
    # of a fabric without a grain only the weight depends on the modulus
    if design.fabric.is_orthotropic or design.gravity.on:
        lines.append(f"E {design.fabric.modulus_text}")
    if design.gravity.on:
        x, y, z = design.gravity.direction
        lines.append(f"weight along ({x:g}, {y:g}, {z:g})")
    return lines


def _stars(plan: Layout, design: Design) -> list[str]:
    return [
        f"{len(plan.centres)}, {design.lattice.arms} arms, {design.lattice.spacing_mm:.4g} mm apart",
        f"length {_range(plan.arm_length)} mm",
        _sections(plan.arm_sections),
        *_sides(plan),
        _size(plan),
    ]


def _rods(plan: Layout) -> list[str]:
    """The drawn rods; empty without any."""
    rods = plan.drawn_rods
    if not rods:
        return []
    below = sum(rod.length for rod in rods if rod.side < 0)
    return [
        f"{len(rods)} between nodes, {sum(rod.length for rod in rods):.0f} mm in all",
        *([f"{below:.0f} mm below the fabric"] if below else []),
        f"joints: {len(plan.graph.joints)}",
        _sections(np.concatenate([rod.sections for rod in rods])),
        _size(plan),
    ]


def _sections(sections: Floats) -> str:
    """Ranges of the sizes of sections (..., K)."""
    return ", ".join(f"{size.name} {_range(sections[..., k])}" for k, size in enumerate(ROD_SIZES)) + " mm"


def _size(plan: Layout) -> str:
    width, height = np.ptp(plan.outline, axis=0)
    return f"sheet {width:.1f} x {height:.1f} mm, stretched"


def _sides(plan: Layout) -> list[str]:
    """The number of stars below the fabric, and of those that start down or flat."""
    below = int((plan.star_side < 0).sum())
    down, free = (int((plan.star_branch == side).sum()) for side in (-1, 0))
    parts = [f"{count} {how}" for count, how in ((down, "down"), (free, "flat")) if count]
    return [*([f"{below} below the fabric"] if below else []), *(["started " + ", ".join(parts)] if parts else [])]


def _as_drawn(job: Job, summary: Mapping[str, Any]) -> list[str]:
    """A line if the shape belongs to the design as drawn, and the printer rounds its sizes."""
    if not job.is_rounded or "design" not in summary:
        return []
    shown = Design.from_dict(summary["design"])
    if (shown.stars, shown.rods) == (job.design.stars, job.design.rods):
        return []
    return ["as drawn, before rounding (see Print)"]


def _rows(summary: Mapping[str, Any], *names: str) -> list[str]:
    """The rows of the summary's table on the terminal, broken to the width of the column."""
    if not isinstance(summary, Record):
        return []
    rows = summary.table([name for name in names if name in summary.rows])
    texts = [f"{label} {text}" for label, text in rows.items()]
    return [line for text in texts for line in textwrap.wrap(text, 46)]


def _hanging(job: Job) -> list[str]:
    if job.hangs_mm is None or job.hangs_mm <= VISIBLE_SAG_MM:
        return []
    doubt = job.hangs_doubt_mm
    below = f"hangs {job.hangs_mm:.1f} mm below its base"
    return [below] if doubt is None else [f"{below},", f"give or take {doubt:.1f} mm"]


def _print(job: Job) -> list[str]:
    cost = job.cost
    rounded = [
        f"{name} {', '.join(f'{value:g}' for value in size.values_mm[:4])} mm after rounding"
        for name, size in job.size_changes.items()
        if size.stars_changed or size.rods_changed
    ]
    return [
        *([f"LARGER than the {job.printer.name} can print in its frame"] if job.too_large else []),
        f"{job.printer.name}, {job.plastic.name}",
        *rounded,
        f"{cost.mass_g:.1f} g, {cost.filament_m:.2f} m of filament",
        f"about {cost.minutes:.0f} minutes",
        f"nozzle starts {job.z_offset_mm:g} mm above the bed" + ("" if job.fabric_given else ", on released fabric"),
    ]


def _range(values: np.ndarray) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:.3g}" if high - low < 0.005 * high else f"{low:.3g} to {high:.3g}"
