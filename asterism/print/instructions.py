"""The instructions for the print of a design, step by step, as pages and as text."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asterism.print.drawing import A4_MM, TEXT, Circle, Drawing, Label, Polyline, font_size_within
from asterism.print.formats.threemf import WALLS, wider_mm
from asterism.print.job import Job
from asterism.print.needles import Needle, needles_near_edge
from asterism.print.printer import Printer
from asterism.print.sheets import grain_in_words
from asterism.print.solid import Solid
from asterism.results.records.export import TinyStarRecord
from asterism.results.words import VISIBLE_SAG_MM, needle_names, sag_in_words

# margin of a page of instructions
_MARGIN_MM = 18.0
# largest number of tiny stars, and of heights of needles, in the instructions
_MAX_LISTED_PLACES = 12


@dataclass(frozen=True)
class Chapter:
    """A chapter of the instructions: heading, paragraphs, and lines of code below them."""

    title: str
    paragraphs: Sequence[str]
    code: Sequence[str] = ()


def chapters(job: Job, tiny: list[TinyStarRecord]) -> tuple[Chapter, ...]:
    """The chapters for a job; `tiny` from `tiny_pieces`."""
    return (_stretch(job), _mount(job), _offset(job), _slice(job, tiny), _print(job), _finish(job))


def _stretch(job: Job) -> Chapter:
    x, y = job.check_after_mm
    lines = [
        f"Draw a square of {job.check_before_mm:g} mm on the relaxed fabric, near the middle (page 2 of layout.pdf). "
        f"Clamp the fabric in its frame: the square must now be {x:.1f} mm wide and {y:.1f} mm deep."
    ]
    if job.design.fabric.is_orthotropic:
        lines.append(f"The fabric has a grain, which decides the shape: see the arrow there. {grain_in_words(job)}")
    return Chapter("1. Stretch the fabric", lines)


def _mount(job: Job) -> Chapter:
    width, depth = job.printer.frame.size_mm
    return Chapter(
        "2. Put the frame on the bed",
        (
            f"Fix the frame of {width:g} x {depth:g} mm with its plate on the bed, its middle over the bed's middle: "
            "page 1 of layout.pdf shows frame, printable area and alignment marks.",
            homing_advice(job.printer),
            "Check that the head and its fans pass over the frame's bars, or keep away from them.",
        ),
    )


def homing_advice(printer: Printer) -> str:
    """How to home the printer with the frame on the bed."""
    if printer.homes == "onto":
        return (
            f"The {printer.name} moves its nozzle down to find the bed: home it BEFORE the frame is on it, and "
            "take homing and levelling (G28, G29) out of the slicer's start code. The nozzle would hit the frame."
        )
    return f"The {printer.name} homes z away from the nozzle: the frame may be on it before."


def _offset(job: Job) -> Chapter:
    plate = job.printer.frame.plate_mm
    fabric = "stretched fabric" if job.fabric_given else "fabric as the design has it, which is thinner when stretched,"
    return Chapter(
        f"3. Start on the fabric: z offset {job.z_offset_mm:.2f} mm",
        (
            f"Plate {plate:.2f} mm + {fabric} {job.fabric_mm:.2f} mm = {job.z_offset_mm:.2f} mm. Measure both "
            "as they lie on the bed; if they differ, export again with --plate and --fabric. A nozzle too high does "
            "not bind the plastic to the fabric, a nozzle too low tears it.",
            f"The {job.printed_word} stand at z = 0 in the files. Leave the slicer's own z offset at 0, whose sign and "
            "meaning differ from slicer to slicer, and add start.gcode to the end of the printer's start code, which "
            "keeps temperatures and homing. Take its purge line out, which would meet the frame.",
        ),
        job.start_code.splitlines(),
    )


def _slice(job: Job, tiny: list[TinyStarRecord]) -> Chapter:
    r = job.rounding
    lines = [
        f"Load {' or '.join(f'{name}.3mf' for name in job.prints)}, or the STL files if your slicer prefers them, in "
        f"millimetres, at 100 %. Scaling in the slicer would thicken the {'arms' if job.arms else 'rods'}: change the "
        "design instead. Do not turn it.",
        *(_box(name, solids) for name, solids in job.prints.items()),
        f"First layer {r.first_layer_mm:g} mm, other layers {r.layer_mm:g} mm, all lines {r.line_mm:g} mm wide. Skirt, "
        f"brim, raft and supports off. First layer slow ({job.printer.speed.first_layer_mm_s:g} mm/s).",
        f"Cura 5 or newer: Wall Line Count {WALLS}, Infill Density 100 %, Print Thin Walls on, Horizontal Expansion 0, "
        "Initial Layer Horizontal Expansion 0.",
        "PrusaSlicer 2.5 or newer: the objects of print.3mf bring these settings; after STL files set them. Perimeter "
        f"generator Arachne, Perimeters {WALLS}, Fill density 100 %, Elephant foot compensation 0, XY Size "
        f"Compensation {wider_mm(r):g} mm, single perimeters on the first and top layers off.",
        f"Bambu Studio, OrcaSlicer: the same by other names. Wall generator Arachne, Wall loops {WALLS}, Sparse infill "
        f"density 100 %, Elephant foot compensation 0, X-Y contour compensation {wider_mm(r):g} mm, Only one wall off.",
        f"Look at each layer in the preview, the first one too: {_lines_across(job)}, without a gap in the middle, and "
        "nothing missing. Otherwise the print is weaker than the design.",
    ]
    if job.plastic.nozzle_c is not None:
        bed = "" if job.plastic.bed_c is None else f", bed {job.plastic.bed_c:g} C"
        lines.append(f"{job.plastic.name}: nozzle about {job.plastic.nozzle_c:g} C{bed}; see the spool.")
    lines += job.plastic.advice
    if tiny:
        places = "; ".join(f"[{x:g}, {y:g}]" for x, y in (star.at_mm for star in tiny[:_MAX_LISTED_PLACES]))
        more = f"; and {len(tiny) - _MAX_LISTED_PLACES} more" if len(tiny) > _MAX_LISTED_PLACES else ""
        lines.append(
            f"Tiny {job.printed_word} may jump off the fabric. Watch those at {places}{more} (mm from the design's "
            "origin), or lengthen or remove them."
        )
    return Chapter("4. Slice", lines)


def _box(name: str, solids: Sequence[Solid]) -> str:
    """Where a print belongs on the bed."""
    low = np.min([solid.box[0] for solid in solids], axis=0)
    high = np.max([solid.box[1] for solid in solids], axis=0)
    x, y, _ = (low + high) / 2
    return (
        f"{name}.3mf belongs with the middle of its box at x = {x:.2f}, y = {y:.2f} mm and is "
        f"{high[0] - low[0]:.2f} x {high[1] - low[1]:.2f} x {high[2]:.2f} mm large. If the slicer moved it, type "
        "that in."
    )


def _lines_across(job: Job) -> str:
    """How many lines lie side by side in arms and rods, by their widths."""
    widths = {width for piece in (*job.arms, *job.rods) for width in piece.width.tolist()}
    at = {max(round(width / job.rounding.line_mm), 1): width for width in sorted(widths)}
    each = [f"{lines} line{'s' * (lines > 1)} across {width:.3g} mm" for lines, width in sorted(at.items())]
    # largest number of widths of arms in the instructions
    return ", ".join(each) if len(each) <= 4 else f"{each[0]} to {each[-1]}"


def _print(job: Job) -> Chapter:
    cost, sides = job.cost, []
    if job.below:
        turned = "with the frame upside down: turn it over sideways, so that left and right are exchanged"
        sides.append(f"The plastic below the fabric is printed {turned}. Its files are mirrored for that.")
    if job.above and job.below:
        high = job.below[-1].height_mm
        sides.append(
            "First print print-below.3mf like this. Let it cool, turn the frame back, and align it again. Now the "
            f"fabric lies on the plastic below. Put a sheet of card {high:g} mm thick under the fabric, cut out around "
            f"that plastic, start {high:g} mm higher than start.gcode says, and print print.3mf on top."
        )
    if job.below:
        sides.append("The fabric must lie on the plate both ways: use a plate that fits into the frame's opening.")
    takes = f"About {cost.minutes:.0f} minutes, {cost.filament_m:.2f} m or {cost.mass_g:.2f} g of {job.plastic.name}."
    return Chapter("5. Print", [*sides, f"{takes} Stay with the first layer: it must wet the fabric everywhere."])


def _finish(job: Job) -> Chapter:
    line = "along the inner edge of the printed line" if job.border is not None else "along the cut line of layout.pdf"
    line = "along the outer edge of the printed rim" if job.plan.rim else line
    holes = f" Cut out the {len(job.plan.holes)} holes first, along the cut lines." if job.plan.holes else ""
    lines = [f"Let the plastic cool, open the frame, cut the fabric {line}.{holes}"]
    if edge := needles_near_edge(job.plan, job.needles):
        lines.append(f"Leave a tab of fabric outside the line, 5 mm or more, at {needle_names(edge)}, on the line.")
    if arms := job.needles_in_plastic:
        lines.append(f"The plastic is in the way of {needle_names(arms)}: drill a hole through it there first.")
    known = [needle for needle in job.needles if needle.place is not None]
    if known:
        lines.append(
            "Drill the base with the template (last page of layout.pdf). Push every needle through the sheet at its "
            f"number in the layout, and set it into the hole of that number: {len(known)} needles."
        )
        if heights := _heights(known):
            lines.append(heights)
        if job.hangs_mm is not None and job.hangs_mm > VISIBLE_SAG_MM:
            lines.append(
                f"The sheet hangs {sag_in_words(job.hangs_mm, job.hangs_doubt_mm)}: set all needles so much higher, on "
                "posts, or cut the base out under it."
            )
        if len(known) < len(job.needles):
            sliding = len(job.needles) - len(known)
            lines.append(f"{sliding} more go through the sheet where it slides; the template has no holes for them.")
        if rising := [needle.number for needle in known if needle.height_mm is None]:
            lines.append(
                f"The sheet slides up and down along {needle_names(rising)}: leave it free there, at its own height."
            )
        if job.hangs_mm is None:
            lines.append("Whether the sheet hangs below the base is not known; asterism export --simulate says it.")
    elif job.needles:
        lines.append(f"Needles go through the sheet at the {len(job.needles)} places of the layout, where it slides.")
    else:
        lines.append("The design has no pins: the sheet takes its shape by itself.")
    if len(steps := sorted({needle.step for needle in job.needles})) > 1:
        turns = [needle_names([needle.number for needle in job.needles if needle.step == step]) for step in steps]
        lines.append(f"Set them in the design's order: first {', then '.join(turns)}.")
    if job.is_certain is False:
        lines.append("The shape is not certified as a minimum: the sheet may take another form. See export.json.")
    return Chapter("6. Release, cut, pin", lines)


def _heights(needles: Sequence[Needle]) -> str:
    """A sentence with the heights of raised needles; empty if all hold the sheet on the base."""
    at: dict[str, list[int]] = {}
    for needle in needles:
        if needle.is_raised:
            at.setdefault(f"{needle.height_mm:.1f}", []).append(needle.number)
    if not at:
        return ""
    if len(at) > _MAX_LISTED_PLACES:
        return "They hold the sheet at heights over the base that are written beside their holes, and in needles.csv."
    each = "; ".join(f"{height} mm at {needle_names(numbers)}" for height, numbers in at.items())
    known = [needle for needle in needles if needle.height_mm is not None]
    rest = "" if all(needle.is_raised for needle in known) else "; on the base at the others"
    return f"They hold the sheet at these heights over the base: {each}{rest}."


def as_text(job: Job, parts: tuple[Chapter, ...]) -> str:
    """The instructions as plain text."""
    blocks = [f"{job.design.name}: how to print it on the {job.printer.name}"]
    for part in parts:
        wrapped = "\n\n".join(textwrap.fill(paragraph, 88) for paragraph in part.paragraphs)
        code = "".join(f"\n    {line}" for line in part.code)
        blocks.append(f"{part.title}\n\n{wrapped}" + (f"\n{code}" if code else ""))
    return "\n\n\n".join(blocks) + "\n"


def as_pages(job: Job, parts: tuple[Chapter, ...]) -> list[Drawing]:
    """The instructions as A4 pages."""
    name, top, bottom = job.design.name, A4_MM[1] - _MARGIN_MM, _MARGIN_MM
    size = font_size_within(name, 6.5, A4_MM[0] - 2 * _MARGIN_MM)
    items: list[Polyline | Circle | Label] = [
        Label(TEXT, np.array([_MARGIN_MM, top - 6.0]), name, size, bold=True),
        Label(TEXT, np.array([_MARGIN_MM, top - 14.0]), f"How to print it on the {job.printer.name}", 4.2),
    ]
    pages = [items]
    y = top - 24.0
    for part in parts:
        lines = [(part.title, True, False, 6.4)]
        for paragraph in part.paragraphs:
            # characters in a line of the instructions
            wrapped = textwrap.wrap(paragraph, 98) or [""]
            lines += [(line, False, False, 4.5) for line in wrapped[:-1]] + [(wrapped[-1], False, False, 5.9)]
        lines += [(line, False, True, 4.3) for line in part.code]
        # a chapter stays on one page
        if y - sum(step for *_, step in lines) < bottom:
            items, y = [], top - 6.0
            pages.append(items)
        for line, bold, code, step in lines:
            at = np.array([_MARGIN_MM + (6.0 if code else 0.0), y])
            items.append(Label(TEXT, at, line, 4.1 if bold else 3.1 if code else 3.35, bold=bold, fixed_pitch=code))
            y -= step
        y -= 2.8
    return [Drawing(f"{name}: instruction", np.zeros(2), np.array(A4_MM), tuple(items)) for items in pages]
