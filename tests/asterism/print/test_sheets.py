"""Sheets are to scale, as rendered in PDF and SVG, and in DXF; the instruction says the numbers of this design."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pypdfium2
import pytest
import resvg_py
import shapely
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from PIL import Image

from asterism.equilibrium.arrays import Floats
from asterism.previews.session import preview
from asterism.print import instructions, sheets
from asterism.print.drawing import Circle, Drawing, Label, Polyline
from asterism.print.formats.drawings import write_dxf, write_svg
from asterism.print.formats.pdf import write_pdf
from asterism.print.job import Job
from asterism.print.needles import needles_in_plastic, needles_near_edge
from asterism.print.rounding import tiny_pieces
from tests.asterism.print.jobs import design, job

ezdxf = pytest.importorskip("ezdxf")
SAME_MM = 0.01
INCH_MM = 25.4


def pdf_band(
    path: Path, page: int, low_mm: tuple[float, float], high_mm: tuple[float, float], pixels_per_mm: float
) -> tuple[Floats, tuple[float, float]]:
    """Part of a page between two corners in mm from its lower left, and its true pixels per mm along x and y.

    (rows, columns, 3), row 0 the uppermost. The renderer stretches a page to whole pixels.
    """
    sheet = pypdfium2.PdfDocument(path)[page]
    width, height = sheet.get_size()
    points = 72 / INCH_MM
    crop = (low_mm[0] * points, low_mm[1] * points, width - high_mm[0] * points, height - high_mm[1] * points)
    image = sheet.render(scale=pixels_per_mm / points, crop=crop).to_pil().convert("RGB")
    true = tuple(math.ceil(side * pixels_per_mm / points) / side * points for side in (width, height))
    return np.asarray(image, dtype=float), (true[0], true[1])


def svg_pixels(path: Path, pixels_per_mm: float) -> Floats:
    """(rows, columns, 3) a whole SVG at its own size."""
    data = bytes(resvg_py.svg_to_bytes(svg_path=str(path), dpi=round(pixels_per_mm * INCH_MM), background="white"))
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), dtype=float)


def lines_mm(band: Floats, pixels_per_mm: float) -> Floats:
    """Middles of the orange lines that cross all rows of a band, in mm from its left: the sides of check squares."""
    red, green, blue = np.moveaxis(band, -1, 0)
    profile = np.clip(np.minimum(green - blue, red - green + 60), 0.0, None).mean(axis=0)
    on = profile > 0.02 * profile.max()
    line = np.cumsum(on & ~np.r_[False, on[:-1]]) * on
    columns = np.arange(len(profile)) + 0.5
    middles = np.bincount(line, profile * columns)[1:] / np.bincount(line, profile)[1:]
    return np.asarray(middles / pixels_per_mm)


def check_squares(places: Floats, stretch: float) -> None:
    """10 cm before stretching, 10 cm times the stretch after."""
    assert len(places) == 4
    assert places[2] - places[1] == pytest.approx(100.0, abs=SAME_MM)
    assert places[3] - places[0] == pytest.approx(100.0 * stretch, abs=SAME_MM)


def needle_sheet(of: Job) -> Drawing:
    """The page for the base of a print with needles."""
    page = sheets.needle_sheet(of)
    assert page is not None
    return page


def texts(page: Drawing) -> str:
    """All that is written on a page."""
    return " ".join(item.text for item in page.items if isinstance(item, Label))


@pytest.fixture(scope="module")
def one() -> Job:
    # seven letters beyond Latin 1, so that fonts matter; 1.35 along x and 1.3 along y
    return job(design(name="Kuppel Ω <&> ß"))


@pytest.fixture(scope="module")
def folder(one: Job, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sheets")
    template = needle_sheet(one)
    pages = [sheets.layout_sheet(one), sheets.stretch_sheet(one), template]
    write_pdf(path / "layout.pdf", pages)
    write_svg(path / "layout.svg", pages[0])
    write_dxf(path / "layout.dxf", pages[0])
    write_dxf(path / "needles.dxf", template)
    return path


def middle(drawing: Drawing) -> tuple[float, float]:
    """The middle of the frame, from the lower left of the page."""
    return float(-drawing.low[0]), float(-drawing.low[1])


@pytest.mark.slow
@pytest.mark.parametrize("page", [0, 1])
def test_the_check_square_on_the_rendered_pdf(one: Job, folder: Path, page: int) -> None:
    x, y = middle(sheets.layout_sheet(one))
    # bands of a few dashes beside the middle; the alignment marks are elsewhere
    across, (scale_x, _) = pdf_band(folder / "layout.pdf", page, (x - 90, y + 20), (x + 90, y + 32), 24.0)
    upwards, (_, scale_y) = pdf_band(folder / "layout.pdf", page, (x + 20, y - 90), (x + 32, y + 90), 24.0)
    for band, scale, stretch in ((across, scale_x, 1.35), (np.swapaxes(upwards, 0, 1), scale_y, 1.3)):
        places = lines_mm(band, scale)
        check_squares(places, stretch)
        # about the middle of the frame, but for the whole pixels at which the band begins
        assert places.mean() == pytest.approx(90.0, abs=2 / scale)


def test_pages_are_a3_with_the_papers_frame_and_everything_on_them(one: Job, folder: Path) -> None:
    sizes = [page.get_size() for page in pypdfium2.PdfDocument(folder / "layout.pdf")]
    np.testing.assert_allclose(np.array(sizes) * INCH_MM / 72, [(420.0, 297.0)] * 3, rtol=0.0, atol=SAME_MM)
    for drawing in (sheets.layout_sheet(one), sheets.stretch_sheet(one), needle_sheet(one)):
        check_page(drawing)


@pytest.mark.slow
def test_the_check_square_on_the_rendered_svg(one: Job, folder: Path) -> None:
    root = ElementTree.parse(folder / "layout.svg").getroot()
    assert (root.get("width"), root.get("height"), root.get("viewBox")) == ("420mm", "297mm", "0 0 420 297")
    groups = {group.get("id") for group in root.iter("{http://www.w3.org/2000/svg}g")}
    assert {"cut", "stars", "frame", "check-after-stretching", "needles"} <= groups
    # any name survives
    assert one.design.name in [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")]
    scale = 254 / 25.4
    image = svg_pixels(folder / "layout.svg", scale)
    assert image.shape[:2] == (2970, 4200)  # 297 x 420 mm at ten pixels a millimetre
    x, y = middle(sheets.layout_sheet(one))
    rows = slice(int((297 - y - 32) * scale), int((297 - y - 20) * scale))
    check_squares(lines_mm(image[rows, int((x - 90) * scale) : int((x + 90) * scale)], scale), 1.35)


def test_dxf_is_sound_and_in_millimetres(one: Job, folder: Path) -> None:
    """Without $INSUNITS = 4 a laser cutter may take the numbers for inches."""
    for name in ("layout.dxf", "needles.dxf"):
        document = ezdxf.readfile(folder / name)
        audit = document.audit()
        assert not audit.errors and not audit.fixes
        assert document.header["$INSUNITS"] == 4 and document.header["$MEASUREMENT"] == 1
        assert all(entity.dxf.layer in document.layers for entity in document.modelspace())
    # no dates: the same drawing is the same file
    write_dxf(folder / "again.dxf", sheets.layout_sheet(one))
    assert (folder / "again.dxf").read_bytes() == (folder / "layout.dxf").read_bytes()
    assert b"CreationDate" not in (folder / "layout.pdf").read_bytes()
    # seen on black and on white
    layers = ezdxf.readfile(folder / "layout.dxf").layers
    for name in ("stars", "text"):
        assert layers.get(name).color == 7 and layers.get(name).rgb is None
    assert layers.get("cut").rgb == (0xD0, 0x1C, 0x1C)
    # other drawings of this process keep their dates
    assert not ezdxf.options.write_fixed_meta_data_for_testing


def test_dxf_has_the_right_sizes_on_the_right_layers(one: Job, folder: Path) -> None:
    space = ezdxf.readfile(folder / "layout.dxf").modelspace()

    def outlines(layer: str) -> list[np.ndarray]:
        found = [line for line in space.query("LWPOLYLINE") if line.dxf.layer == layer and line.closed]
        return [np.array([point[:2] for point in line.get_points()]) for line in found]

    sizes = {
        "frame": (260.0, 260.0),
        "frame-opening": (230.0, 230.0),
        "printable-area": (223.0, 223.0),
        "check-before-stretching": (100.0, 100.0),
        "check-after-stretching": (135.0, 130.0),
    }
    for layer, size in sizes.items():
        (outline,) = outlines(layer)
        assert np.ptp(outline, axis=0) == pytest.approx(size, abs=SAME_MM)
        assert outline.mean(axis=0) == pytest.approx((0.0, 0.0), abs=SAME_MM)
    (cut,) = outlines("cut")
    assert cut == pytest.approx(one.plan.outline, abs=SAME_MM)
    stars = sum(shapely.Polygon(outline).area for outline in outlines("stars"))
    assert stars == pytest.approx(one.pattern[0].region.area, rel=1e-6)
    needles = [circle.dxf.center for circle in space.query("CIRCLE") if circle.dxf.layer == "needles"]
    assert np.array(needles)[:, :2] == pytest.approx(np.array([n.printed for n in one.needles]), abs=SAME_MM)

    space = ezdxf.readfile(folder / "needles.dxf").modelspace()
    holes = np.array([circle.dxf.center for circle in space.query("CIRCLE")])[:, :2]
    # two edges of the hexagon, held at 0.8 of their printed place
    assert holes == pytest.approx(0.8 * np.array([n.printed for n in one.needles]), abs=SAME_MM)


@pytest.mark.parametrize(
    ("stretch", "printer", "side"),
    [
        (1.35, {}, 100.0),
        (2.8, {}, 60.0),
        (1.35, {"bed_mm": [300.0, 280.0]}, 100.0),
        ([1.2, 1.8], {"frame": {"size_mm": [130.0, 140.0]}}, 40.0),
        (1.35, {"frame": {"size_mm": [130.0, 40.0], "bar_mm": 5.0}}, 10.0),
    ],
)
def test_large_beds_and_small_frames(stretch: Any, printer: dict[str, Any], side: float) -> None:
    """The page shows all of them, and the stretched square is within the frame."""
    stars = {"length_mm": 5.0, "thickness_mm": 0.2}
    made = job(design(fabric={"stretch": stretch}, stars=stars, border={"rings": 0}, pins=[]), printer)
    assert made.check_before_mm == side
    assert (np.array(made.check_after_mm) <= 0.8 * np.array(made.printer.frame.opening_mm)).all()
    layout, check = sheets.layout_sheet(made), sheets.stretch_sheet(made)
    check_page(layout)
    check_page(check)
    words = texts(check)
    x, y = made.check_after_mm
    assert f"before: {side:g} x {side:g} mm" in words and f"after: {x:.1f} x {y:.1f} mm" in words
    front = next(item for item in layout.items if isinstance(item, Label) and item.text == "front of the printer")
    assert front.at[1] < -max(made.printer.bed_mm[1], made.printer.frame.size_mm[1]) / 2


def test_a_fabric_that_stays_longer_is_stretched_further() -> None:
    made = job(design(fabric={"stretch": [1.3, 1.2]}), fabric_set_percent=4.0)
    assert np.allclose(made.check_after_mm, made.check_before_mm * 1.04 * np.array([1.3, 1.2]))
    assert "stretch that you measured, over 1.04, into fabric.stretch" in texts(sheets.stretch_sheet(made))
    assert "stretched by 1.352 along x and 1.248 along y" in texts(sheets.layout_sheet(made))


def check_page(drawing: Drawing) -> None:
    for item in drawing.items:
        points = item.points if isinstance(item, Polyline) else getattr(item, "at", getattr(item, "centre", None))
        assert (points >= drawing.low).all() and (points <= drawing.high).all()


@pytest.mark.parametrize("place", [[0.0, 0.0], [2.0, 2.2], [-8.0, -2.0]])
def test_the_origin_is_not_written_over_a_needle(place: list[float]) -> None:
    """Nor over its number and height, which stand to its right."""
    mast = {"points_mm": [place], "target_mm": [*place, 25.0]}
    template = needle_sheet(job(design(pins=[mast, {"where": "corners", "scale": 0.8, "step": 1}])))
    word = next(item for item in template.items if isinstance(item, Label) and item.text == "origin")
    label = next(item for item in template.items if isinstance(item, Label) and item.text == "1  z 25.0")
    apart = np.abs(word.at - label.at)
    assert apart[1] > 4.0 or word.at[0] + 6.0 < label.at[0] or word.at[0] - 6.0 > label.at[0] + 16.0
    assert "Steps are set one after the other" in texts(template)


@pytest.mark.parametrize(
    ("stretch", "turn", "stretched_deg", "released_deg"), [(1.35, 90.0, 120.0, 120.0), ([1.5, 1.2], 0.0, 24.79, 30.0)]
)
def test_an_arrow_shows_the_grain(stretch: Any, turn: float, stretched_deg: float, released_deg: float) -> None:
    """As the fabric lies on the printer, stretched on the layout and relaxed on the stretch check."""
    knit = {"modulus_mpa": [9.0, 4.0], "grain_deg": 30.0, "stretch": stretch}
    one = job(design(fabric=knit), turn_deg=turn)
    for page, angle in ((sheets.layout_sheet(one), stretched_deg), (sheets.stretch_sheet(one), released_deg)):
        arrow = next(item for item in page.items if isinstance(item, Polyline) and item.layer.name == "grain")
        along = arrow.points[1] - arrow.points[0]
        assert np.degrees(np.arctan2(along[1], along[0])) == pytest.approx(angle, abs=0.01)
        assert "grain" in texts(page)
    assert not [item for item in sheets.layout_sheet(job()).items if item.layer.name == "grain"]


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
STEPS = [MAST, {"where": "corners", "scale": 0.8, "step": 1}]
SLIDING = [{"corners": [0, 2, 4]}, {"corners": [1, 3, 5], "slide": "plane"}]
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
        ({"pins": SLIDING}, {}, "that number: 3 needles. 3 more go through the sheet where it slides"),
        ({"pins": STEPS}, {}, "at these heights over the base: 25.0 mm at needle 1; on the base at the others."),
        ({"pins": STEPS}, {}, "in the design's order: first needle 1, then needles 2 to 7."),
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
