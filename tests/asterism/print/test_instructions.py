"""The instruction says this design's numbers, and stays on its pages."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from asterism.previews.session import preview
from asterism.print import instructions, sheets
from asterism.print.drawing import Circle, Drawing, Label
from asterism.print.job import Job
from asterism.print.needles import needles_in_plastic, needles_near_edge
from asterism.print.rounded import tiny_pieces
from tests.asterism.print.jobs import design, job, needle_sheet, texts


def chapters(one: Job) -> tuple[instructions.Chapter, ...]:
    return instructions.chapters(one, tiny_pieces(one.plan, one.plastic.tiny_arm_mm))


def said(one: Job) -> str:
    """The instruction as one line."""
    return " ".join(instructions.as_text(one, chapters(one)).split())


def width_mm(item: Label) -> float:
    """Of a text in the font of the PDF."""
    family = "DejaVu Sans Mono" if item.fixed_pitch else "DejaVu Sans"
    font = FontProperties(family=family, weight="bold" if item.bold else "normal", size=item.size_mm)
    return float(text_to_path.get_text_width_height_descent(item.text, font, ismath=False)[0])


def check_texts(page: Drawing) -> None:
    for item in page.items:
        if isinstance(item, Label):
            width = width_mm(item)
            left = item.at[0] - (width / 2 if item.end == "middle" else 0.0)
            assert page.low[0] <= left and left + width <= page.high[0] - 3.0, item.text
            assert page.low[1] < item.at[1] < page.high[1] - item.size_mm, item.text


NARROW = {"length_mm": 8.0, "override": [{"at_mm": [0.0, 0.0], "length_mm": 6.0, "width_mm": 0.4}]}
TAPERED = {"length_mm": 8.0, "width_mm": {"profile": "radial", "from": 0.4, "to": 2.4, "over_mm": 30.0}}
KNIT = {"modulus_mpa": [9.0, 4.0], "grain_deg": 30.0}
MAST = {"points_mm": [[0.0, 0.0]], "target_mm": [0.0, 0.0, 25.0]}
ROW = {"points_mm": [[3.0 * k, 0.0] for k in range(-7, 8)], "target_mm": [[2.5 * k, 0, 10 + k] for k in range(-7, 8)]}


@pytest.mark.parametrize(
    ("sections", "options", "words"),
    [
        ({}, {"fabric_mm": 0.5}, "135.0 mm wide and 130.0 mm deep|z offset 4.50 mm|lines 0.4 mm wide|[0, 0]|Skirt"),
        ({}, {"fabric_mm": 0.5}, "G1 Z14.50|x = 111.50, y = 111.5|8 needles"),
        # what is to be seen in the slicer's preview
        ({}, {}, "the first one too: 3 lines across 1.2 mm, without a gap|along the inner edge of the printed line"),
        ({"stars": NARROW}, {}, "1 line across 0.4 mm, 3 lines across 1.2 mm, without"),
        ({"stars": TAPERED | {"vary_along_arms": True}}, {}, "1 line across 0.4 mm to 6 lines across 2.4 mm, without"),
        ({}, {"printer": {"homes": "onto"}, "border": False}, "BEFORE the frame is on it|the cut line of layout.pdf"),
        ({}, {"printer": {"homes": "away"}}, "homes z away from the nozzle: the frame may be on it before"),
        ({"fabric": {"stretch": 2.8}, "border": {"rings": 0}, "pins": []}, {}, "Draw a square of 60 mm|no pins"),
        # three corners are held, three slide, and no shape says where to
        (
            {"pins": [{"corners": [0, 2, 4]}, {"corners": [1, 3, 5], "slide": "plane"}]},
            {},
            "into the hole of that number: 3 needles. 3 more go through the sheet where it slides",
        ),
        (
            {"pins": [MAST, {"where": "corners", "scale": 0.8, "step": 1}]},
            {},
            "at these heights over the base: 25.0 mm at needle 1; on the base at the others.|"
            "in the design's order: first needle 1, then needles 2 to 7.",
        ),
        ({"pins": [ROW]}, {}, "heights over the base that are written beside their holes"),
        ({"fabric": KNIT}, {}, "the arrow runs the direction of the fabric that has 9 MPa; across it, it has 4 MPa."),
    ],
)
def test_the_text_is_of_this_design_and_this_printer(
    sections: dict[str, Any], options: dict[str, Any], words: str
) -> None:
    text = said(job(design(**sections), **options))
    assert [each for each in words.split("|") if each not in text] == []


def test_what_does_not_apply_is_not_said() -> None:
    text = said(job())
    assert [word for word in ("in the design's order", "at these heights", "BEFORE", "grain") if word in text] == []
    assert sheets.needle_sheet(job(design(border={"rings": 0}, pins=[]))) is None


def test_a_height_with_released_fabric_is_told_wherever_it_stands() -> None:
    for one, told in ((job(), True), (job(fabric_mm=0.5), False)):
        remark, *_ = one.start_code.splitlines()
        assert (remark.startswith(";") and "0.80 mm of fabric, released" in remark) == told
        assert one.start_code.endswith(one.printer.start_snippet(one.z_offset_mm))
        column = texts(sheets.layout_sheet(one))
        assert f"{one.z_offset_mm:.2f} mm above the bed" in column
        assert ("with the released fabric" in column) == told
        assert ("thinner when stretched" in said(one)) == told


@pytest.mark.parametrize("sections", [{}, {"name": "W" * 100}, {"fabric": KNIT}], ids=["small", "named", "knit"])
def test_texts_stay_on_their_pages(sections: dict[str, Any]) -> None:
    one = job(design(**sections))
    pages = instructions.as_pages(one, chapters(one))
    assert len(pages) == 2
    many = needle_sheet(job(needle_spacing_mm=4.0))
    for page in (*pages, sheets.layout_sheet(one), sheets.stretch_sheet(one), needle_sheet(one), many):
        check_texts(page)
    assert all(tuple(page.size_mm) == (210.0, 297.0) for page in pages)


def test_needles_along_which_the_sheet_slides_get_a_hole() -> None:
    """The design says where they stand, and no shape how high the sheet is there."""
    pins = [{"corners": [0, 2, 4], "scale": 0.8, "offset_mm": [0, 0, 5]}, {"corners": [1, 3, 5], "slide": "z"}]
    one = job(design(pins=pins))
    text = said(one)
    assert "into the hole of that number: 6 needles." in text and "no holes for them" not in text
    assert "slides up and down along needles 4 to 6: leave it free there" in text
    assert "at these heights over the base: 5.0 mm at needles 1 to 3." in text and "nan" not in text
    template = needle_sheet(one)
    words = texts(template)
    assert "it finds its own" in words and "computed shape" not in words and "nan" not in words
    # a hole and its cross, the middle's cross, and the number beside it
    assert sum(isinstance(item, Circle) for item in template.items) == 6
    # the height of the base comes from a needle that has one
    glance = preview(design(fabric={}, stars={"length_mm": 8.0}, pins=pins))
    last = replace(job(design(pins=pins[::-1])), glance=glance)
    assert last.hangs_mm == pytest.approx(replace(one, glance=glance).hangs_mm, abs=1e-6)


def test_a_sheet_whose_height_nothing_holds_stands_on_its_lowest_needle() -> None:
    """All pins slide along z: the shape's own height is by chance."""
    pins = [{"corners": [0, 1, 2, 3, 4, 5], "slide": "z", "scale": 0.8}]
    sliding = design(fabric={}, stars={"length_mm": 8.0}, pins=pins)
    found = preview(sliding)
    lifted = replace(found, positions=found.positions - np.array([0.0, 0.0, 14.5]))
    needles = [job(sliding, shape=one).needles for one in (found, lifted)]
    heights = [[needle.place[2] for needle in some if needle.place is not None] for some in needles]
    assert len(heights[0]) == 6 and min(heights[0]) == 0.0
    np.testing.assert_allclose(*heights, atol=1e-9)


def test_needles_that_stand_on_the_cut_line_or_on_an_arm_are_told() -> None:
    """The first on the centre of a star, the second beside its arms, the third at a corner."""
    pins = [{"points_mm": [[0.0, 17.32], [5.0, 14.44]], "scale": 0.8}, {"corners": [0], "scale": 0.8}]
    made = job(design(pins=pins))
    assert needles_in_plastic(made.plan, made.needles) == [1] and needles_near_edge(made.plan, made.needles) == [3]
    assert "The plastic is in the way of needle 1: drill" in said(made)
    assert "Leave a tab of fabric outside the line, 5 mm or more, at needle 3, on the line" in said(made)
    inside = job(design(pins=[{"points_mm": [[5.0, 14.44], [-5.0, 14.44]], "scale": 0.8}]))
    assert not needles_in_plastic(inside.plan, inside.needles) and not needles_near_edge(inside.plan, inside.needles)
