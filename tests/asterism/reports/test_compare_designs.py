"""Several designs on one page."""

from __future__ import annotations

import base64
import re
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import asterism
from asterism import Design, compare_designs, save_design
from asterism.reports.compare_designs import DesignsComparison
from tests.asterism.commands import Cli
from tests.asterism.verification.printed import design

small = partial(design, name="small")


@pytest.fixture(scope="module")
def compared(tmp_path_factory: pytest.TempPathFactory) -> tuple[DesignsComparison, str]:
    """Three designs: the first, one of thicker stars, and one of a fabric without a law."""
    page = tmp_path_factory.mktemp("compared") / "page.html"
    thick = small(stars={"length_mm": 8.0, "thickness_mm": 0.45})
    wide = small(lattice={"spacing_mm": 60.0}, fabric={"bending": "none"}, pins=[{"where": "corners", "scale": 0.8}])
    result = compare_designs([small(), thick, wide], page, names=["first", "thick", "<wide>"])
    return result, page.read_text()


def row(result: DesignsComparison, label: str) -> Any:
    return next(each for each in result.numbers if each.label.startswith(label))


def test_numbers_are_those_of_the_previews_and_prints(compared: tuple[DesignsComparison, str]) -> None:
    result, _ = compared
    shapes = [asterism.preview(each.job.drawn) for each in result.designs[:2]]
    assert row(result, "height").values == (*(shape.height_mm for shape in shapes), None)
    assert row(result, "contraction").values[:2] == tuple(shape.summary["contraction"] for shape in shapes)
    assert row(result, "print time").values == tuple(each.job.cost.minutes for each in result.designs)
    assert row(result, "stars").values == (7.0, 7.0, 7.0)
    assert row(result, "needles").texts == ("0", "0", "6")


@pytest.mark.slow
def test_drawings_are_counted_in_rods_and_name_the_option_for_exact_shapes(tmp_path: Path) -> None:
    lines = [{"line_mm": [(-20, y), (20, y)]} for y in (-5, 5)]
    drawn = Design.from_dict({"rods": {"draw": lines}, "border": {"rectangle_mm": (42, 20)}})
    result = compare_designs([small(), drawn], tmp_path / "page.html", names=["stars", "lines"])
    assert row(result, "stars").texts == ("7", "-")
    assert row(result, "drawn rods").texts == ("-", "2")
    without = "rods.motif: is missing: lines that do not repeat have no law"
    assert result.designs[1].problem == f"{without}; the exact model may compute it: --exact"


@pytest.mark.slow
def test_prints_with_one_outline_have_a_distance_whatever_stars_they_have(tmp_path: Path) -> None:
    fewer = small(stars={"length_mm": 8.0, "override": [{"site": [0, 1], "remove": True}]})
    result = compare_designs([fewer, small(), fewer], tmp_path / "page.html", names=["a", "b", "c"])
    assert row(result, "stars").values == (6.0, 7.0, 6.0)
    distance, none = (each.distance_mm for each in result.designs[1:])
    assert distance is not None and 0.0 < distance < 5.0 and none == pytest.approx(0.0, abs=1e-9)


def test_differences_and_distances_are_those_from_the_first(compared: tuple[DesignsComparison, str]) -> None:
    height = row(compared[0], "height")
    first, second, third = height.with_differences()
    change = height.values[1] - height.values[0]
    assert first == f"{height.values[0]:.1f}" and third == "-"
    assert second.startswith(f"{height.values[1]:.1f} ({change:+.1f}, ")
    assert row(compared[0], "needles").with_differences() == ["0", "0", "6 (+6)"]
    none, thick, wide = (each.distance_mm for each in compared[0].designs)
    assert none is None and wide is None and 0.01 < thick < 10.0  # a wide one is not printed alike


def test_entries_that_differ_are_listed_once(compared: tuple[DesignsComparison, str]) -> None:
    entries = dict(compared[0].differences)
    assert entries["stars.thickness_mm"] == ["0.3", "0.45", "0.3"]
    assert entries["lattice.spacing_mm"][2] == "60.0" and entries["pins.0.scale"] == ["-", "-", "0.8"]
    assert not {"name", "stars.length_mm", "border.rings"} & set(entries)


def test_a_design_without_a_shape_is_there_with_the_reason(compared: tuple[DesignsComparison, str]) -> None:
    result, page = compared
    assert result.designs[2].shape is None and "bare fabric without bending" in result.designs[2].problem
    assert "bare fabric without bending" in page and "&lt;wide&gt;" in page and "<wide>" not in page
    assert page.count("<img") == 2 * 3


def test_pictures_of_a_row_have_one_scale(compared: tuple[DesignsComparison, str]) -> None:
    """The sheet seen from above is as wide in the picture as along x in space, for both designs."""
    result, page = compared
    data = re.findall(r'src="data:image/png;base64,([^"]+)"', page)[-2:]
    pictures = [np.asarray(Image.open(BytesIO(base64.b64decode(text))).convert("RGB")) for text in data]
    wide = [np.ptp(np.flatnonzero((pixels < 250).any(axis=(0, 2)))) for pixels in pictures]
    extents = [np.ptp(each.shape.positions[:, 0]) for each in result.designs[:2] if each.shape is not None]
    assert wide[0] / extents[0] == pytest.approx(wide[1] / extents[1], rel=0.03)


@pytest.mark.slow
def test_equal_designs_say_so_and_have_different_headings(tmp_path: Path) -> None:
    result = compare_designs([small(), small()], tmp_path / "x.html")
    assert [each.name for each in result.designs] == ["small (1)", "small (2)"]
    assert result.differences == () and "None: the designs are the same." in (tmp_path / "x.html").read_text()
    assert result.designs[1].distance_mm == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
def test_exact_shapes_have_their_mesh_errors(tmp_path: Path) -> None:
    coarse = [small(mesh={"edge_mm": 5.0}), small(mesh={"edge_mm": 5.0}, plastic={"modulus_ratio": 3000.0})]
    result = compare_designs(coarse, tmp_path / "x.html", exact=True)
    assert all(each.shape is not None and not each.shape.is_preview for each in result.designs)
    assert "Shapes by the exact model." in (tmp_path / "x.html").read_text()


def test_the_command_prints_the_numbers(tmp_path: Path, cli: Cli) -> None:
    for name, thickness in (("a", 0.3), ("b", 0.4)):
        save_design(small(stars={"length_mm": 8.0, "thickness_mm": thickness}), tmp_path / f"{name}.toml")
    printed = cli(["compare-designs", str(tmp_path / "a.toml"), str(tmp_path / "b.toml")]).done.out
    assert f"{tmp_path / 'a-b.html'}: 1 entry differs" in printed and "print time, minutes" in printed
