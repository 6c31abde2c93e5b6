"""The page about a design, read back by another program and measured on its picture."""

from __future__ import annotations

from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pypdfium2
import pytest
from PIL import Image

from asterism import Design, load_design, load_law, preview, report, write_results
from asterism.draw.render import FABRIC_SIDE, PINS, PLASTIC_SIDE
from asterism.exact.simulation import exact_shape
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.print.job import prepare
from asterism.print.printer import load_plastic, load_printer
from asterism.reports.design_report import LAYOUT_AT, LAYOUT_MM, design_facts
from asterism.reports.html import png
from tests.asterism.commands import Cli

DESIGN = """
name = "small roof"
[stars]
length_mm = 8.0
thickness_mm = 0.4
[border]
rectangle_mm = [104.0, 70.0]
[[pins]]
where = "corners"
scale = 0.7
[mesh]
edge_mm = 4.0
"""


@pytest.fixture
def design(tmp_path: Path) -> Path:
    (tmp_path / "d.toml").write_text(DESIGN)
    return tmp_path / "d.toml"


def page(path: Path) -> tuple[str, np.ndarray]:
    """Text of the only page, and its picture (rows, columns, 3) with 10 pixels a mm."""
    document = pypdfium2.PdfDocument(path)
    assert len(document) == 1
    size = np.array(document[0].get_size()) * 25.4 / 72
    np.testing.assert_allclose(size, [210, 297], atol=0.1)
    image = document[0].render(scale=10 * 25.4 / 72).to_pil().convert("RGB")
    return document[0].get_textpage().get_text_range(), np.asarray(image).astype(int)


@pytest.mark.slow
def test_parameters_picture_layout_needles_and_material(design: Path, cli: Cli) -> None:
    done = cli(["report", str(design)]).done
    assert "layout 1:1; shape: by the preview" in done.out
    text, image = page(design.with_name("d-report.pdf"))
    said = (
        "small roof", "stretch 1.35, 0.8 mm thick", "E1/E2 3200, paper", "length 8 mm", "thickness 0.4, width 1.2 mm",
        "sheet 104.0 x 70.0 mm", "by the preview", "mm, give or take ", "not of the print", "mm over its needles",
        "g, ", "Layout 1:1", "Needles: 4", "1: printed (-52.0, -35.0), stands at (-36.4, -24.5, 0.0)",
    )  # fmt: skip
    assert [words for words in said if words not in text] == []
    # the colour of the sheet in the layout: as wide and high as the sheet itself
    rows, columns = np.nonzero(
        (np.abs(image - [0xF3, 0xF1, 0xEA]) < 3).all(axis=2) & (np.arange(len(image)) > 1200)[:, None]
    )
    assert np.ptp(columns) / 10 == pytest.approx(104, abs=0.5)
    assert np.ptp(rows) / 10 == pytest.approx(70, abs=0.5)
    # something is drawn in the place of the picture
    assert (image[300:1200, 150:1950].min(axis=2) < 200).mean() > 0.03


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_results_of_the_design_are_used_and_others_refused(design: Path, tmp_path: Path, cli: Cli) -> None:
    """Also of sheets larger than the printer, with as many doubts as there is room for."""
    wide = DESIGN.replace("[104.0, 70.0]", "[240.0, 40.0]")
    design.write_text(wide)
    plan = load_design(design)
    warnings = ["it passes through itself (12 pairs of triangles)", "1 of 19 stars of the exact shape is not up"]
    shape = preview(plan, load_law(None))
    summary = {
        "design": plan.to_dict(),
        "height_mm": 12.34,
        "extent_mm": [90.0, 60.0, 12.3],
        "is_minimum": False,
        "mesh_error_percent": 1.7,
        "warnings": [*warnings, *(f"warning {k}: " + "word " * 30 for k in range(5))],
    }
    write_results(replace(shape, summary=summary), tmp_path / "d")
    assert "by the exact model" in cli(["report", str(design), "-o", str(tmp_path / "r.pdf")]).done.out
    text, _ = page(tmp_path / "r.pdf")
    assert "height 12.34 mm" in text and "Not an equilibrium" in text and "mesh error about 1.7 %" in text
    assert "estimated error" not in text and "LARGER than the Ultimaker 2+ can print" in text
    # what the commands warn of is on the page too
    assert "passes through itself (12 pairs of triangles)" in text
    assert "1 of 19 stars of the exact shape is not" in text
    assert "and more: see the summary" in text and "warning 4" not in text

    # they may be from another start, or mesh
    design.write_text(wide + "[solver]\nseed = 3\n")
    assert "by the exact model" in cli(["report", str(design), "-o", str(tmp_path / "r.pdf")]).done.out

    design.write_text(wide.replace("8.0", "7.0"))
    refusal = cli(["report", str(design), "--results", str(tmp_path / "d")]).refusal
    assert "--results" in refusal and "of this design" in refusal


@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.slow
def test_sheets_that_hang_and_sizes_that_are_rounded_are_on_the_page(design: Path, cli: Cli) -> None:
    middle = "points_mm = [[-10, 0], [10, 0], [0, 12]]\nscale = 0.76\n"
    design.write_text(DESIGN.split("[[pins]]")[0].replace("0.4", "0.38") + "[[pins]]\n" + middle)
    assert cli(["report", str(design)]).done
    text, _ = page(design.with_name("d-report.pdf"))
    low = preview(load_design(design)).positions[:, 2].min()
    assert f"hangs {-low:.1f} mm below its base" in text and low < -0.5
    assert "thickness 0.4 mm after rounding" in text and "as drawn, before rounding" in text
    # a design that is what the printer makes has a page without such lines
    assert cli(["export", str(design), "-o", str(design.with_name("out"))]).done
    rounded = design.with_name("out") / "rounded.toml"
    assert cli(["report", str(rounded), "-o", str(rounded.with_name("r.pdf"))]).done
    text, _ = page(rounded.with_name("r.pdf"))
    assert "thickness 0.4, width" in text and "in place of" not in text and "as drawn" not in text


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_what_decides_the_shape_is_on_the_page(design: Path, tmp_path: Path, cli: Cli) -> None:
    """Weight and sides of stars too; and a needle in the middle keeps its dot beside its number."""
    middle = "[[pins]]\npoints_mm = [[0, 0]]\nslide = 'z'\n[gravity]\non = true\n[fabric]\nmodulus_mpa = 1.0\n"
    design.write_text(DESIGN.replace("thickness_mm = 0.4", "thickness_mm = 0.4\nbranch = 'down'") + middle)
    shape = preview(load_design(design))
    summary = {"design": load_design(design).to_dict(), "height_mm": 5.0, "is_minimum": True}
    write_results(replace(shape, summary=summary), tmp_path / "d")
    assert cli(["report", str(design)]).done
    text, image = page(design.with_name("d-report.pdf"))
    for words in ("weight along (0, 0, -1)", " down"):
        assert words in text, text
    assert "-0.0" not in text
    x, y = (10 * (LAYOUT_AT + LAYOUT_MM / 2)).astype(int)
    red, green, blue = image[2970 - y - 3 : 2970 - y + 3, x - 3 : x + 3].mean(axis=(0, 1))
    assert red > green + 60 and red > blue + 60


@pytest.mark.slow
def test_without_a_law_there_is_no_picture(design: Path, cli: Cli) -> None:
    sliding = DESIGN.replace("scale = 0.7", 'scale = 0.7\nslide = "z"')
    design.write_text(sliding + '[fabric]\nbending = "none"\n')
    done = cli(["report", str(design)])
    assert done.status == 0 and "no picture" in done.line and "fabric.bending" in done.line
    text, image = page(design.with_name("d-report.pdf"))
    assert "not known: this design has no preview" in text
    # needles along which the sheet slides have no height
    assert "1: printed (-52.0, -35.0), stands at (-36.4, -24.5, slides)" in text
    assert image[300:1200, 150:1950].min() == 255
    # a law is for fabric that bends
    assert "fabric.bending" in cli(["report", str(design), "--law", str(PAPER_LAW)]).refusal


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_a_law_that_is_given_makes_the_preview(design: Path, tmp_path: Path, cli: Cli) -> None:
    """What lies beside the design may be of another law; a given one is not for results."""
    plan = load_design(design)
    shape = preview(plan, load_law(None))
    write_results(replace(shape, summary={**shape.summary, "height_mm": 77.7}), tmp_path / "d")
    words = ["report", str(design), "-o", str(tmp_path / "r.pdf")]
    for given, told in (([], True), (["--law", str(PAPER_LAW)], False)):
        assert cli([*words, *given]).done
        text, _ = page(tmp_path / "r.pdf")
        assert ("height 77.70 mm" in text) == told and "law paper, stretch 1.35, edges of 1.0189 mm" in text
    both = cli([*words, "--law", str(PAPER_LAW), "--results", str(tmp_path / "d")])
    assert "--law: is for a new preview" in both.refusal


CROSS = Design.from_dict(
    {
        "name": "cross",
        "rods": {"draw": [{"line_mm": [(-10, 0), (10, 0)]}, {"line_mm": [(0, -10), (0, 10)], "thickness_mm": 0.5}]},
        "border": {"rectangle_mm": (24.0, 24.0)},
        "mesh": {"edge_mm": 4.0},
    }
)


def test_the_facts_are_those_of_the_rods() -> None:
    job = prepare(CROSS, load_printer("ultimaker2"), load_plastic("tpu95a"))
    facts = design_facts(job, {}, "not known")
    assert "Stars" not in facts
    assert facts["Rods"][:3] == ["4 between nodes, 40 mm in all", "joints: 1", "thickness 0.3 to 0.5, width 1.2 mm"]


@pytest.mark.slow
def test_the_page_shows_the_exact_shape_or_says_why_it_has_no_picture(tmp_path: Path) -> None:
    said: list[str] = []
    assert report(CROSS, tmp_path / "without.pdf", say=said.append).shape is None
    without = "the page has no picture: rods.motif: is missing: lines that do not repeat have no law"
    assert said == [f"{without}; use the exact model: asterism simulate first"]
    write_results(exact_shape(CROSS), tmp_path / "cross")
    written = report(CROSS, tmp_path / "with.pdf", beside=tmp_path / "cross")
    assert written.shape is not None and written.source == "by the exact model"
    words = " ".join(page(tmp_path / "with.pdf")[0].split())
    assert "40 mm in all" in words and "Exact, mesh error" in words


@pytest.mark.slow
def test_colours_of_few_pixels_are_kept() -> None:
    """A cream sheet in all shades, with a corner of its back and a red point where it is held."""
    shade = np.linspace(0.5, 1.0, 400)[:, None] * np.linspace(0.8, 1.0, 600)
    image = np.ones((400, 600, 4))
    image[..., :3] = shade[..., None] * PLASTIC_SIDE
    image[:8, :8, :3] = PINS
    image[-8:, -8:, :3] = FABRIC_SIDE
    image[200:, :50, 3] = 0.0  # white
    found = np.asarray(Image.open(BytesIO(png(image))).convert("RGB"), dtype=float)[::-1] / 255.0
    assert np.abs(found[2:6, 2:6] - PINS).max() < 0.04
    assert np.abs(found[-6:-2, -6:-2] - FABRIC_SIDE).max() < 0.04
    assert (found[210:, :40] == 1.0).all()
    assert np.abs(found - np.where(image[..., 3:] > 0.0, image[..., :3], 1.0)).max() < 0.05
