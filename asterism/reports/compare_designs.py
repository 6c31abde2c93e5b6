"""The public function behind `asterism compare-designs`: several designs on one page."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from asterism.draw.picture import fitting_scale, small_png, view_image
from asterism.draw.render import View
from asterism.equilibrium.errors import Error
from asterism.homogenize.law.law import Law
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import preview
from asterism.print.job import Job, prepare
from asterism.print.printer import PlasticProfile, Printer
from asterism.print.profiles import load_plastic, load_printer
from asterism.process.listeners import Say, ignore_line
from asterism.reports.html import figures, html_page, html_table, warnings_box
from asterism.results.files import OutputError, check_writable, write_file
from asterism.results.words import box_in_words
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape


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


MAX_COMPARED_DESIGNS = 12


@dataclass(frozen=True)
class ComparedDesign:
    """One of several designs.

    Attributes
    ----------
    name : its heading.
    job : the design on the printer's bed.
    shape : its shape; None if it has none.
    problem : why it has no shape; empty if it has one.
    distance_mm : rms distance of the surface from that of the first design at the same printed points, after the free
        motions; None if the sheets are printed differently, and for the first design.
    """

    name: str
    job: Job
    shape: Shape | None
    problem: str = ""
    distance_mm: float | None = None

    @property
    def summary(self) -> Mapping[str, Any]:
        """Summary of the shape; empty without one."""
        return {} if self.shape is None else self.shape.summary


@dataclass(frozen=True)
class ComparedNumber:
    """One row: a number of each design.

    Attributes
    ----------
    label : with the unit.
    values : numbers; None where a design has none.
    texts : the same in words.
    digits : of the numbers after the point.
    """

    label: str
    values: tuple[float | None, ...]
    texts: tuple[str, ...]
    digits: int = 0

    def with_differences(self) -> list[str]:
        """The texts, with the difference from the first design where these digits show one."""
        first = self.values[0]
        cells = [self.texts[0]]
        for value, text in zip(self.values[1:], self.texts[1:], strict=True):
            change = 0.0 if value is None or first is None else round(value - first, self.digits)
            if change and first:
                text += f" ({change:+.{self.digits}f}, {100.0 * change / first:+.0f} %)"
            elif change:
                text += f" ({change:+.{self.digits}f})"
            cells.append(text)
        return cells


def compare_designs(
    designs: Sequence[Design],
    path: str | Path,
    *,
    names: Sequence[str] | None = None,
    exact: bool = False,
    printer: str | Printer = "ultimaker2",
    plastic: str | PlasticProfile = "tpu95a",
    law: Law[Any] | None = None,
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
    machine = load_printer(printer)
    profile = load_plastic(plastic)
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
    numbers, differences = tuple(_numbers(compared)), tuple(_differing_entries(compared))
    write_file(path, _page(compared, numbers, differences))
    return DesignsComparison(tuple(compared), numbers, differences)


def _shape_of(design: Design, exact: bool, law: Law[Any] | None, say: Say) -> tuple[Shape | None, str]:
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
    # mm, outlines that differ by less are the same print
    if np.abs(one.outline - two.outline).max() > 1e-6 or len(one.holes) + len(two.holes) > 0:
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


def _numbers(designs: Sequence[ComparedDesign]) -> list[ComparedNumber]:
    """The rows: size, print, accuracy; a row without any number is left out."""

    def of(key: str) -> Callable[[ComparedDesign], float | None]:
        return lambda each: each.summary.get(key)

    rows = [
        _row(designs, "height, mm", of("height_mm"), 1),
        _sizes(designs, "finished size, mm", lambda each: each.summary.get("extent_mm")),
        _sizes(designs, "printed size, mm", lambda each: _printed(each.job)),
        _row(designs, "rise over the needles, mm", of("above_needles_mm"), 1),
        _row(designs, "depth below the needles, mm", of("below_needles_mm"), 1),
        _row(designs, "contraction", of("contraction"), 4),
        _row(designs, "estimated error of the surface, % of the diameter", of("expected_rms_percent"), 1),
        _row(designs, "estimated error of the height, mm", lambda each: _height_error(each.summary), 1),
        _row(designs, "mesh error, % of the diameter", of("mesh_error_percent"), 1),
        _row(designs, "distance from the first surface, rms, mm", lambda each: each.distance_mm, 2),
        _row(designs, "stars", lambda each: float(len(each.job.plan.centres)) or None, 0),
        _row(designs, "drawn rods", lambda each: float(len(each.job.plan.drawn_rods)) or None, 0),
        _row(designs, "needles", lambda each: float(len(each.job.needles)), 0),
        _row(designs, "print time, minutes", lambda each: each.job.cost.minutes, 0),
        _row(designs, "plastic, g", lambda each: each.job.cost.mass_g, 1),
        _row(designs, "filament, m", lambda each: each.job.cost.filament_m, 2),
    ]
    return [row for row in rows if any(text != "-" for text in row.texts)]


def _differing_entries(designs: Sequence[ComparedDesign]) -> list[tuple[str, list[str]]]:
    """Paths of the entries in which the designs differ, names aside, and the entry of each design."""
    tables = [dict(_entries(each.job.drawn.to_dict())) for each in designs]
    paths = dict.fromkeys(path for table in tables for path in table if path != "name")
    rows = [(path, [table.get(path, "-") for table in tables]) for path in paths]
    return [(path, texts) for path, texts in rows if len(set(texts)) > 1]


def _row(
    designs: Sequence[ComparedDesign], label: str, of: Callable[[ComparedDesign], float | None], digits: int
) -> ComparedNumber:
    values = tuple(map(of, designs))
    texts = tuple("-" if value is None else f"{value:.{digits}f}" for value in values)
    return ComparedNumber(label, values, texts, digits)


def _sizes(
    designs: Sequence[ComparedDesign], label: str, of: Callable[[ComparedDesign], Sequence[float] | None]
) -> ComparedNumber:
    """A row of boxes, whose differences are not numbers."""
    texts = tuple("-" if (sizes := of(each)) is None else box_in_words(sizes).removesuffix(" mm") for each in designs)
    return ComparedNumber(label, (None,) * len(designs), texts)


def _printed(job: Job) -> list[float]:
    low, high = job.plan.outline.min(axis=0), job.plan.outline.max(axis=0)
    return [float(side) for side in high - low]


def _height_error(summary: Mapping[str, Any]) -> float | None:
    percent = summary.get("expected_height_percent")
    return None if percent is None else percent / 100.0 * summary["height_mm"]


def _entries(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    """Dotted paths and texts of all entries of a table; lists of numbers are one entry."""
    if isinstance(value, Mapping) and value:
        for key, inner in value.items():
            yield from _entries(inner, f"{path}.{key}".lstrip("."))
    elif isinstance(value, list) and value and isinstance(value[0], Mapping):
        for number, inner in enumerate(value):
            yield from _entries(inner, f"{path}.{number}")
    else:
        text = json.dumps(value, ensure_ascii=False)
        # longer entries are shortened
        yield path, text if len(text) <= 100 else f"{text[:100]} ... ({len(text)} characters)"


# size of a picture
CARD_PX = (640, 420)


def _page(
    designs: Sequence[ComparedDesign], numbers: Sequence[ComparedNumber], differences: Sequence[tuple[str, list[str]]]
) -> str:
    """The page as text."""
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
    titles: dict[View, str] = {"oblique": "In space", "front": "From the front", "above": "From above"}
    for view, title in titles.items():
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
