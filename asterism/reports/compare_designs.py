"""The public function behind `asterism compare-designs`: several designs on one page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path

import numpy as np

from asterism.draw.picture import small_png
from asterism.draw.view_picture import View, fitting_scale, view_image
from asterism.equilibrium.errors import Error
from asterism.homogenize.law.any_law import AnyLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.run import preview
from asterism.print.job import prepare
from asterism.print.plastic_profile import PlasticProfile
from asterism.print.printer import Printer
from asterism.print.profiles import load_plastic, load_printer
from asterism.process.listeners import Say, ignore_line
from asterism.reports.compared_numbers import ComparedDesign, ComparedNumber, compared_numbers, differing_entries
from asterism.reports.html import figures, html_page, html_table, warnings_box
from asterism.results.files import OutputError, check_writable, write_file
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape

# size of a picture
CARD_PX = (640, 420)
VIEW_TITLES: dict[View, str] = {
    "oblique": "In space",
    "front": "From the front",
    "above": "From above",
}


def designs_page(
    designs: Sequence[ComparedDesign],
    numbers: Sequence[ComparedNumber],
    differences: Sequence[tuple[str, list[str]]],
) -> str:
    """The page as text.

    Parameters
    ----------
    numbers, differences : from `asterism.reports.compared_numbers`.
    """
    names = [each.name for each in designs]
    title = " · ".join(names)
    first = designs[0]
    by = next((each.shape.made_by for each in designs if each.shape is not None), "not known")
    lead = (
        f"Shapes {by}. Print times for the {first.job.printer.name} with {first.job.plastic.name}. "
        f"Differences in brackets are those from {names[0]}."
    )
    parts = [
        f"<h1>{escape(title)}</h1>",
        f'<p class="lead">{escape(lead)}</p>',
        *_pictures(designs),
        "<h2>Numbers</h2>",
        html_table(["", *names], [[row.label, *row.with_differences()] for row in numbers]),
        "<h2>Entries that differ</h2>",
        html_table(["", *names], [[path, *texts] for path, texts in differences], numbers=False)
        if differences
        else "<p>None: the designs are the same.</p>",
        *_warnings(designs),
    ]
    return html_page(title, parts)


def _pictures(designs: Sequence[ComparedDesign]) -> list[str]:
    """A row of pictures for each view, all of a row at one scale."""
    drawn = [(each.name, each.shape) for each in designs if each.shape is not None]
    if not drawn:
        return []
    shapes = [shape for _, shape in drawn]
    parts = []
    for view, title in VIEW_TITLES.items():
        scale = fitting_scale(shapes, view, CARD_PX, plain=True)
        images = [
            (small_png(view_image(shape, view, CARD_PX, scale, plain=True)), f"{name}, height {shape.height_mm:.1f} mm")
            for name, shape in drawn
        ]
        width = CARD_PX[0] / scale
        parts += [f"<h2>{title}</h2>", figures(images), f'<p class="small">Each picture is {width:.0f} mm wide.</p>']
    return parts


def _warnings(designs: Sequence[ComparedDesign]) -> list[str]:
    parts = []
    for each in designs:
        size = [each.job.too_large] if each.job.too_large else []
        lines = [*([each.problem] if each.problem else []), *size, *each.summary.get("warnings", [])]
        if each.shape is not None and not each.shape.summary["is_minimum"]:
            lines.insert(0, "the shape is not certified as an equilibrium")
        parts.append(warnings_box(each.name, lines))
    return ["<h2>Warnings</h2>", *parts] if any(parts) else []


MAX_COMPARED_DESIGNS = 12
# mm, outlines that differ by less are the same print
SAME_OUTLINE_MM = 1e-6


@dataclass(frozen=True)
class DesignsComparison:
    """Several designs beside each other.

    Attributes
    ----------
    designs : the designs with their jobs and shapes.
    numbers : rows of numbers.
    differences : entries in which the designs differ: the path, and a text for each design.
    """

    designs: tuple[ComparedDesign, ...]
    numbers: tuple[ComparedNumber, ...]
    differences: tuple[tuple[str, list[str]], ...]


def compare_designs(
    designs: Sequence[Design],
    path: str | Path,
    *,
    names: Sequence[str] | None = None,
    exact: bool = False,
    printer: str | Printer = "ultimaker2",
    plastic: str | PlasticProfile = "tpu95a",
    law: AnyLaw | None = None,
    say: Say | None = None,
) -> DesignsComparison:
    """Write one page with several designs: pictures at one scale, sizes, print times, estimated errors, differences.

    A design without a preview has no picture, and the page says why.

    Parameters
    ----------
    designs : 2 to 12 designs. Differences are those from the first one.
    path : file of the page; it ends with `.html`.
    names : headings; the names of the designs by default.
    exact : compute exact shapes, not previews.
    printer, plastic : a profile, its name, or its file, for print times and masses.
    law : law of the previews; by default the one that each design names, or else that of the paper's material.
    say : called with a line of text at the beginning of each stage.

    Raises
    ------
    DesignError
        There are too few or too many designs, a profile is wrong, or rounded arms overlap.
    OutputError
        The page cannot be written.
    """
    if not 2 <= len(designs) <= MAX_COMPARED_DESIGNS:
        raise DesignError("", f"must be 2 to {MAX_COMPARED_DESIGNS} designs", len(designs))
    for design in designs:
        check_type(design, Design, "load_design reads one from a file")
    path = Path(path)
    if path.suffix.lower() != ".html":
        raise OutputError(f"--output: {str(path)!r} must end with .html")
    check_writable(path.parent, path.name)
    machine = load_printer(printer) if isinstance(printer, str) else printer
    profile = load_plastic(plastic) if isinstance(plastic, str) else plastic
    headings = _headings(names or [design.name for design in designs])
    announce = say or ignore_line
    compared: list[ComparedDesign] = []
    for heading, design in zip(headings, designs, strict=True):
        try:
            job = prepare(design, machine, profile, any_size=True)
        except DesignError as error:
            raise error.within(heading) from None
        announce(heading)
        shape, problem = _shape_of(design, exact, law, announce)
        one = ComparedDesign(heading, job, shape, problem)
        compared.append(replace(one, distance_mm=_distance(compared[0], one) if compared else None))
    numbers = tuple(compared_numbers(compared))
    differences = tuple(differing_entries(compared))
    write_file(path, designs_page(compared, numbers, differences))
    return DesignsComparison(tuple(compared), numbers, differences)


def _shape_of(design: Design, exact: bool, law: AnyLaw | None, say: Say) -> tuple[Shape | None, str]:
    """The shape, or None and the reason."""
    if exact:
        from asterism.verification.both_starts import simulate  # its imports take seconds

        try:
            return simulate(design, say=say, law=law), ""
        except Error as error:
            return None, str(error)
    try:
        return preview(design, law, say=say), ""
    except Error as error:
        reason = str(error).partition("; use the exact model")[0]  # here an option computes exact shapes
        return None, f"{reason}; the exact model may compute it: --exact"


def _distance(first: ComparedDesign, other: ComparedDesign) -> float | None:
    """rms distance (mm) of two shapes of the same print; None for others."""
    one, two = first.job.drawn_plan, other.job.drawn_plan
    if first.shape is None or other.shape is None or one.outline.shape != two.outline.shape:
        return None
    if np.abs(one.outline - two.outline).max() > SAME_OUTLINE_MM or len(one.holes) + len(two.holes) > 0:
        return None
    # the stars of the two may differ in number: each print is turned by its own symmetries
    own, firsts = symmetries(other.job.drawn, two), symmetries(first.job.drawn, one)
    pull = first.job.drawn.gravity.pull
    comparisons = [compare_shapes(first.shape, other.shape, one, own, pull)]
    if len(firsts) > len(own):
        comparisons.append(compare_shapes(other.shape, first.shape, two, firsts, pull))
    return min(0.01 * each.rms_percent * each.diameter_mm for each in comparisons)


def _headings(names: Sequence[str]) -> list[str]:
    """The names, with a number where one is there again."""
    return [
        name if names.count(name) == 1 else f"{name} ({list(names[: number + 1]).count(name)})"
        for number, name in enumerate(names)
    ]
