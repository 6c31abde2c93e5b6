"""The test print: where its strips lie, and the files that go with it."""

from __future__ import annotations

import shutil
import zipfile
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pypdfium2
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from asterism import StripFitSettings, StripPrintSettings, new_strips
from asterism.measure.new_strips import BED_MARGIN_MM, STRIP_GAP_MM, lay_out_strips, layer_heights
from asterism.measure.strip_table import read_strips
from asterism.pattern.design.errors import DesignError
from asterism.print.printer import load_printer
from asterism.process.settings import THICKNESSES_MM
from asterism.results.csv_table import TableError
from tests.asterism.commands import Cli

BED = (223.0, 223.0)


def test_four_times_ten_strips_mixed_over_the_bed() -> None:
    strips = lay_out_strips(BED, StripPrintSettings())
    assert Counter(s.thickness_mm for s in strips) == dict.fromkeys(THICKNESSES_MM, 10)
    for h in THICKNESSES_MM:
        middle = np.mean([s.centre_mm for s in strips if s.thickness_mm == h], axis=0)
        assert np.abs(middle).max() < 15


@given(
    count=st.integers(1, 12),
    length=st.floats(20, 105),
    kinds=st.integers(1, 5),
    bed=st.tuples(st.floats(120, 400), st.floats(120, 400)),
    both=st.booleans(),
)
def test_strips_keep_apart_and_on_the_bed(
    count: int, length: float, kinds: int, bed: tuple[float, float], both: bool
) -> None:
    thicknesses = tuple(0.3 + 0.05 * k for k in range(kinds))
    try:
        settings = StripPrintSettings(thicknesses_mm=thicknesses, count=count, length_mm=length, both_directions=both)
        found = lay_out_strips(bed, settings)
    except DesignError as error:
        assert error.field == "--count"
        return
    kinds_on_bed = Counter((s.thickness_mm, s.direction) for s in found)
    directions = ("along", "across") if both else (None,)
    assert kinds_on_bed == {(h, direction): count for h in thicknesses for direction in directions}
    for s in found:
        assert s.size_mm == ((4.0, length) if s.direction == "across" else (length, 4.0))
    centres, halves = np.array([s.centre_mm for s in found]), np.array([s.size_mm for s in found]) / 2
    assert (np.abs(centres) + halves <= np.array(bed) / 2 - BED_MARGIN_MM + 1e-9).all()
    gaps = np.abs(centres[:, None] - centres) - halves[:, None] - halves
    assert ((gaps >= STRIP_GAP_MM - 1e-9).any(axis=-1) | np.eye(len(centres), dtype=bool)).all()


@pytest.mark.parametrize(
    ("thicknesses", "expected"),
    [
        ((0.3, 0.35, 0.4, 0.45), (0.3, 0.05)),
        ((0.2, 0.4, 0.8), (0.2, 0.2)),
        ((0.3,), (0.3, 0.3)),
        ((0.6, 0.75), (0.15, 0.15)),
        ((5.0,), (0.25, 0.25)),
    ],
)
def test_layers_make_every_thickness(thicknesses: tuple[float, ...], expected: tuple[float, float]) -> None:
    first, others = layer_heights(thicknesses, 0.4)
    assert (first, others) == expected
    for h in thicknesses:
        assert (h - first) / others == pytest.approx(round((h - first) / others), abs=1e-9)


@pytest.mark.parametrize("thicknesses", [(0.3, 0.37, 0.4512), (0.02,), (0.61, 0.9)])
def test_thicknesses_without_layers_are_refused(thicknesses: tuple[float, ...]) -> None:
    with pytest.raises(DesignError, match=r"of 0.04 to 0.3 mm \(nozzle 0.4 mm\)"):
        layer_heights(thicknesses, 0.4)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("print") / "strips"
    new_strips(folder)
    return folder


@pytest.mark.slow
def test_stl_holds_forty_closed_boxes_in_mm(folder: Path) -> None:
    mesh = trimesh.load_mesh(folder / "strips.stl")
    assert mesh.is_watertight
    bodies = mesh.split()
    assert len(bodies) == 40
    sizes = np.array([body.extents for body in bodies])
    np.testing.assert_allclose(sizes[:, :2], [[60.0, 4.0]] * 40, atol=0.01)
    np.testing.assert_allclose(np.sort(sizes[:, 2]), np.repeat(THICKNESSES_MM, 10), atol=1e-6)
    assert mesh.volume == pytest.approx(sum(60 * 4 * h * 10 for h in THICKNESSES_MM), rel=1e-5)
    assert mesh.bounds[0, 2] == 0


def test_the_sheet_says_what_to_do_and_has_every_strip(folder: Path) -> None:
    document = pypdfium2.PdfDocument(folder / "strips.pdf")
    assert [tuple(np.round(np.array(page.get_size()) / 72 * 25.4, 1)) for page in document] == [(210.0, 297.0)] * 2
    first, second = (page.get_textpage().get_text_range() for page in document)
    assert "13.5 cm" in first and "first layer of 0.3 mm and others of 0.05 mm" in first and "1:2" in first
    for strip in lay_out_strips(BED, StripPrintSettings()):
        assert f"{strip.number}: {strip.thickness_mm:g}" in first
    words = second.split()
    assert all(str(number) in words for number in range(1, 41)) and "peeled" in words


@pytest.mark.slow
def test_the_nozzle_starts_on_the_fabric(folder: Path, tmp_path: Path, cli: Cli) -> None:
    """4 mm of plate and 0.8 of fabric, or what the options say; in the start code, on the page and in the terminal."""
    assert (folder / "start.gcode").read_text() == load_printer("ultimaker2").start_snippet(4.8, released_mm=0.8)
    page = pypdfium2.PdfDocument(folder / "strips.pdf")[0].get_textpage().get_text_range()
    assert "start.gcode" in page and "4.80 mm above the bed" in page and "homes z" in page
    words = ["strips", "new", "-o", str(tmp_path / "a"), "--plate", "3", "--fabric", "0.5", "--printer", "prusa-mk4"]
    printed = cli(words).done.out
    assert "z offset 3.50 mm (plate and stretched fabric)" in printed
    assert "stars are sliced in other layers (first 0.2 mm, then 0.2 mm): export them with" in printed
    assert "--first-layer 0.3 --layer 0.05" in printed
    assert (tmp_path / "a" / "start.gcode").read_text() == load_printer("prusa-mk4").start_snippet(3.5)
    page = pypdfium2.PdfDocument(tmp_path / "a" / "strips.pdf")[0].get_textpage().get_text_range()
    assert "BEFORE the frame" in page


def test_the_table_waits_to_be_filled_in(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(TableError, match="no strip has been measured"):
        read_strips(folder / "strips.csv", StripFitSettings())
    rows = (folder / "strips.csv").read_text().splitlines()
    assert len(rows) == 41
    rows[1] = rows[1].replace(",,,,", ",53.4,11.7,,")
    filled = tmp_path / "strips.csv"
    filled.write_text("\n".join(rows))
    (reading,) = read_strips(filled, StripFitSettings())
    assert (reading.strip, reading.thickness_mm, reading.stretch, reading.peeled) == ("1", 0.3, 1.35, False)


def test_the_slicer_gets_the_strips_and_their_layers(folder: Path) -> None:
    """As in print.3mf of an export: a profile with other layers or fewer walls does not change them."""
    with zipfile.ZipFile(folder / "strips.3mf") as package:
        config = ElementTree.fromstring(package.read("Metadata/Slic3r_PE_model.config"))
        model = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    names = [each.get("name") for each in model.iter() if each.tag.endswith("}object")]
    assert len(config) == len(names) == 40 and names[0] == "strip 1, 0.3 mm" and model.get("unit") == "millimeter"
    for strip in config:
        settings = {entry.get("key"): entry.get("value") for entry in strip.iter("metadata")}
        assert float(settings["layer_height"]) == 0.05
        assert settings["extrusion_width"] == "0.4" and settings["fill_density"] == "100%"


def test_a_table_with_measurements_is_kept(folder: Path, tmp_path: Path, cli: Cli) -> None:
    table = shutil.copytree(folder, tmp_path / "a") / "strips.csv"
    filled = table.read_text().replace(",,,,", ",53.4,11.7,,", 1)
    table.write_text(filled)
    assert "filled in" in cli(["strips", "new", "-o", str(tmp_path / "a")]).line
    assert table.read_text() == filled
