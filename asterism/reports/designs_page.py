"""The page of several designs, in one HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from asterism.draw.picture import small_png
from asterism.draw.view_picture import View, fitting_scale, view_image
from asterism.reports.compared_numbers import ComparedDesign, ComparedNumber
from asterism.reports.html import figures, html_page, html_table, warnings_box

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
