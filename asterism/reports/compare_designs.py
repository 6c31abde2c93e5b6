"""The public function behind `asterism compare-designs`: several designs on one page."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from asterism.draw.picture import fitting_scale, view_image
from asterism.draw.scene import View
from asterism.equilibrium.errors import Error
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, check_type
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import preview
from asterism.print.job import Job, prepare
from asterism.print.printer import PlasticProfile, Printer, load_plastic, load_printer
from asterism.process.progress import Say, ignore_line
from asterism.reports.html import design_rows, figures, html_page, html_table, small_png, warnings_box
from asterism.results.files import check_file, write_file
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
    values : numbers, or sizes of boxes; None where a design has none.
    digits : of the numbers after the point.
    """

    label: str
    values: tuple[float | Sequence[float] | None, ...]
    digits: int = 0

    @property
    def texts(self) -> tuple[str, ...]:
        """The values in words; `-` where a design has none."""
        boxes = (isinstance(value, Sequence) and box_in_words(value).removesuffix(" mm") for value in self.values)
        pairs = zip(self.values, boxes, strict=True)
        return tuple("-" if value is None else box or f"{value:.{self.digits}f}" for value, box in pairs)

    def with_differences(self) -> list[str]:
        """The texts, with the difference from the first design where these digits show one."""
        first, cells = self.values[0], list(self.texts)
        for k, value in enumerate(self.values):
            if not (isinstance(value, float) and isinstance(first, float)):
                continue
            if change := round(value - first, self.digits):
                percent = f", {100.0 * change / first:+.0f} %" if first else ""
                cells[k] += f" ({change:+.{self.digits}f}{percent})"
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
    check_file(path, ".html")
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
        from asterism.verification.simulate import simulate  # its imports take seconds

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

    def row(label: str, digits: int, of: Callable[[ComparedDesign], Any]) -> ComparedNumber:
        return ComparedNumber(label, tuple(map(of, designs)), digits)

    def key(label: str, digits: int, name: str) -> ComparedNumber:
        return row(label, digits, lambda each: each.summary.get(name))

    rows = [
        key("height, mm", 1, "height_mm"),
        key("finished size, mm", 1, "extent_mm"),
        row("printed size, mm", 1, lambda each: np.ptp(each.job.plan.outline, axis=0).tolist()),
        key("rise over the needles, mm", 1, "above_needles_mm"),
        key("depth below the needles, mm", 1, "below_needles_mm"),
        key("contraction", 4, "contraction"),
        key("estimated error of the surface, % of the diameter", 1, "expected_rms_percent"),
        row("estimated error of the height, mm", 1, lambda each: _height_error(each.summary)),
        key("mesh error, % of the diameter", 1, "mesh_error_percent"),
        row("distance from the first surface, rms, mm", 2, lambda each: each.distance_mm),
        row("stars", 0, lambda each: float(len(each.job.plan.centres)) or None),
        row("drawn rods", 0, lambda each: float(len(each.job.plan.drawn_rods)) or None),
        row("needles", 0, lambda each: float(len(each.job.needles))),
        row("print time, minutes", 0, lambda each: each.job.cost.minutes),
        row("plastic, g", 1, lambda each: each.job.cost.mass_g),
        row("filament, m", 2, lambda each: each.job.cost.filament_m),
    ]
    return [row for row in rows if any(value is not None for value in row.values)]


def _differing_entries(designs: Sequence[ComparedDesign]) -> list[tuple[str, list[str]]]:
    """Paths of the entries in which the designs differ, names aside, and the entry of each design."""
    tables = [dict(design_rows(each.job.drawn.to_dict(), longest=100)) for each in designs]
    paths = dict.fromkeys(path for table in tables for path in table if path != "name")
    rows = [(path, [table.get(path, "-") for table in tables]) for path in paths]
    return [(path, texts) for path, texts in rows if len(set(texts)) > 1]


def _height_error(summary: Mapping[str, Any]) -> float | None:
    percent = summary.get("expected_height_percent")
    return None if percent is None else percent / 100.0 * summary["height_mm"]


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
