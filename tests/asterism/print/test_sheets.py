"""The sheets are to scale: measured on the rendered PDF and SVG, and in the DXF."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pypdfium2
import pytest
import resvg_py
import shapely
from PIL import Image

from asterism.equilibrium.arrays import Floats
from asterism.print import sheets
from asterism.print.drawing import Drawing, Label, Polyline
from asterism.print.formats.dxf import write_dxf
from asterism.print.formats.pdf import write_pdf
from asterism.print.formats.svg import write_svg
from asterism.print.job import Job
from tests.asterism.print.jobs import design, job, needle_sheet, texts

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
