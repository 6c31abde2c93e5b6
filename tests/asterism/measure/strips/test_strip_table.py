"""Tables of strips: what is read, and one line with row and column for everything else."""

from __future__ import annotations

from pathlib import Path

import pytest

from asterism.measure.strips import arc
from asterism.measure.strips.settings import StripFitSettings
from asterism.measure.strips.strip_table import STRIP_COLUMNS, Reading, read_strips
from asterism.results.csv_cells import TableError

HEAD = "strip,thickness_mm,length_mm,stretch,fabric_thickness_mm,box_width_mm,box_height_mm"
PEELED = ",peeled_box_width_mm,peeled_box_height_mm"
GOOD = "1,0.3,60,1.35,0.8,53.4,11.7"


def read(tmp_path: Path, text: str | bytes, **options: object) -> list[Reading]:
    file = tmp_path / "strips.csv"
    file.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_strips(file, StripFitSettings(**options))  # type: ignore[arg-type]


def test_a_strip_with_and_without_its_fabric(tmp_path: Path) -> None:
    with_fabric, peeled = read(tmp_path, f"{HEAD}{PEELED}\n{GOOD},59.5,1.4\n2,0.3,60,1.35,0.8,,,,\n")
    assert (with_fabric.peeled, peeled.peeled) == (False, True)
    assert with_fabric.curvature_per_mm == pytest.approx(8 * 11.7 / (53.4**2 + 4 * 11.7**2))
    assert peeled.curvature_per_mm == pytest.approx(8 * 1.4 / (59.5**2 + 4 * 1.4**2))
    assert with_fabric.name == "strip 1 with fabric" and with_fabric.left_out is None


@pytest.mark.parametrize(("separator", "end"), [(",", "\n"), (";", "\r\n"), ("\t", "\n"), (",", ",,\n")])
def test_separators_orders_and_remarks(separator: str, end: str, tmp_path: Path) -> None:
    names = ["length_mm", "box_height_mm", "strip", "box_width_mm", "stretch", "thickness_mm", "fabric_thickness_mm"]
    cells = ["60", " 11.7", "A", "53.4", "1.35", "0.30", "0.8"]
    rows = ["\ufeff" + separator.join(names), separator * 6, "# a remark, with a comma", separator.join(cells)]
    (found,) = read(tmp_path, end.join(rows) + end)
    assert (found.strip, found.row, found.thickness_mm) == ("A", 4, 0.3)


def test_beyond_half_a_circle_and_rolled_over_itself(tmp_path: Path) -> None:
    width, height = (float(side) for side in arc.box(0.08, 60.0))
    assert height > width / 2
    table = f"{HEAD}\n1,0.2,60,1.35,0.8,{width:.2f},{height:.2f}\n2,0.2,60,1.35,0.8,15.0,15.1\n"
    beyond, rolled = read(tmp_path, table)
    assert beyond.curvature_per_mm == pytest.approx(0.08, rel=1e-3)
    assert rolled.curvature_per_mm == pytest.approx(2 / 15) and rolled.left_out is None


def test_a_circle_may_be_read_a_little_higher_than_wide(tmp_path: Path) -> None:
    (found,) = read(tmp_path, f"{HEAD}\n1,0.2,60,1.35,0.8,19.0,19.5\n")
    assert found.curvature_per_mm == pytest.approx(2 / 19) and found.left_out is None
    with pytest.raises(TableError, match="at most the width"):
        read(tmp_path, f"{HEAD}\n1,0.2,60,1.35,0.8,19.0,20.6\n")


@pytest.mark.parametrize("cells", ["60,0", "60,flat", ",Flat", "59.9,0.0"])
def test_flat_strips(cells: str, tmp_path: Path) -> None:
    (found,) = read(tmp_path, f"{HEAD}\n1,0.45,60,1.35,0.8,{cells}\n")
    assert found.curvature_per_mm is None and found.left_out is None


def test_curvatures_in_place_of_boxes(tmp_path: Path) -> None:
    head = "strip,thickness_mm,length_mm,curvature_per_mm,peeled_curvature_per_mm"
    found = read(tmp_path, f"{head}\n1,0.3,60,0.0276,-0.001\n2,0.4,60,0,\n", stretch=1.35, fabric_thickness_mm=0.8)
    assert [r.curvature_per_mm for r in found] == [0.0276, -0.001, None]
    assert {(r.stretch, r.fabric_thickness_mm) for r in found} == {(1.35, 0.8)}


def test_boxes_around_the_whole_strip(tmp_path: Path) -> None:
    """A box drawn around fabric and plastic is higher by their thickness: half as much again for a flat arc."""
    width, height = (float(side) for side in arc.box(0.005, 60.0))
    text = f"{HEAD}{PEELED}\n1,0.3,60,1.35,0.8,{width:.3f},{height + 1.1:.3f},{width:.3f},{height + 0.3:.3f}\n"
    for reading in read(tmp_path, text, outside=True):
        assert reading.curvature_per_mm == pytest.approx(0.005, rel=0.02)
    assert read(tmp_path, text)[0].curvature_per_mm == pytest.approx(0.0074, rel=0.02)


def test_a_box_that_does_not_fit_its_strip(tmp_path: Path) -> None:
    (found,) = read(tmp_path, f"{HEAD}\n1,0.3,60,1.35,0.8,40,5\n")
    assert found.left_out == "its box holds an arc of 41.6 mm, the strip has 60"


@pytest.mark.parametrize(
    ("text", "place", "problem"),
    [
        ("", "strips.csv", "is empty"),
        (f"{HEAD}\n", "strips.csv", "no strips"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,,\n", "strips.csv", "no strip has been measured"),
        ("strip,h1,length_mm\n1,0.3,60\n", "row 1", "'h1'"),
        ("strip,thickness_mm\n1,0.3\n", "row 1", "length_mm is missing"),
        (f"{HEAD},strip\n{GOOD},1\n", "row 1, column strip", "twice"),
        (f"{HEAD}\n{GOOD}\n2,0.3,60,1.35,0.8,-53.4,11.7\n", "row 3, column box_width_mm", "from 0.1 to 2000"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,nan,11.7\n", "row 2, column box_width_mm", "finite"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,53.4,\n", "row 2, column box_height_mm", "empty"),
        (f"{HEAD}\n1,0.3,60,,0.8,53.4,11.7\n", "row 2, column stretch", "--stretch"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,about 53,11.7\n", "row 2, column box_width_mm", "not a number"),
        (f'{HEAD}\n1,0.3,60,1.35,0.8,"53,4",11.7\n', "row 2, column box_width_mm", "decimals with a point"),
        (f"{HEAD}\n1;0,3;60\n".replace(",thick", ";thick"), "row 1", "is known"),
        (HEAD.replace(",", ";") + "\n1;0,3;60;1.35;0.8;53.4;11.7\n", "row 2, column thickness_mm", "with a point"),
        (f"{HEAD}\n{GOOD}\n1,0.35,60,1.35,0.8,55,8\n", "row 3, column strip", "row 2"),
        (f"{HEAD}\n,0.3,60,1.35,0.8,53.4,11.7\n", "row 2, column strip", "name"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,2.10,0.46\n", "row 2, column box_width_mm", "inches"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,5.34,1.17\n", "row 2, column box_width_mm", "centimetres"),
        (f"{HEAD}\n1,0.3,2.36,1.35,0.8,2.1,0.46\n", "row 2, column length_mm", "inches"),
        (f"{HEAD}\n1,0.3,60,1.35,0.8,11.7,53.4\n", "row 2, column box_height_mm", "at most the width"),
        (f"{HEAD},curvature_per_mm\n{GOOD},0.03\n", "row 2, column curvature_per_mm", "not both"),
        (f"{HEAD},curvature_per_mm\n1,0.3,60,1.35,0.8,,,-0.03\n", "row 2, column curvature_per_mm", "from 0 to 1"),
        (f"{HEAD},direction\n{GOOD},left\n", "row 2, column direction", "along or across"),
        (f"{HEAD},direction\n{GOOD},along\n2{GOOD[1:]},\n", "row 3, column direction", "other strips have one"),
        (b"strip,thickness_mm,length_mm\n\xff\xfe,1,1\n", "row 2", "UTF-8"),
        ("strip,thickness_mm,length_mm\n1\0,1,1\n", "strips.csv", "not text"),
    ],
)
def test_mistakes_name_row_and_column(text: str | bytes, place: str, problem: str, tmp_path: Path) -> None:
    with pytest.raises(TableError) as caught:
        read(tmp_path, text)
    line = str(caught.value)
    assert "\n" not in line and "strips.csv" in line
    where, _, what = line.removeprefix(str(tmp_path)).partition(": ")
    assert place in where and problem in what, line


@pytest.mark.parametrize(
    ("boxes", "step"),
    [
        (["53,12", "54,11", "53,flat"], 0.0),  # too few to tell
        (["53,12", "54,11", "53,10", "55,12"], 1.0),
        (["53.5,12", "54,11", "53,10", "55,12"], 0.5),
        (["53.257,11.7", "54.1,11.83", "53.2,11.6"], 0.0),
    ],
)
def test_the_marks_to_which_boxes_were_read(boxes: list[str], step: float, tmp_path: Path) -> None:
    rows = [f"{number},0.3,60,1.35,0.8,{box}" for number, box in enumerate(boxes)]
    found = read(tmp_path, "\n".join([HEAD, *rows]))
    assert {reading.step_mm for reading in found if reading.curvature_per_mm is not None} == {step}
    assert all(reading.step_mm == 0.0 for reading in found if reading.curvature_per_mm is None)


@pytest.mark.parametrize("beside", ["ca. 60", "nan", ""])
def test_what_stands_beside_a_flat_strip_is_not_read(beside: str, tmp_path: Path) -> None:
    rows = [*[f"{k},0.3,60,1.35,0.8,53.{k},11.{k}" for k in range(4)], f"9,0.3,60,1.35,0.8,{beside},flat"]
    found = read(tmp_path, "\n".join([HEAD, *rows]))
    assert found[-1].curvature_per_mm is None and [reading.step_mm for reading in found] == [0.1] * 4 + [0.0]


def test_curvatures_were_not_read_with_the_ruler_of_boxes(tmp_path: Path) -> None:
    rows = [f"{k},0.3,60,1.35,0.8,53.{k},11.{k}," for k in range(4)]
    found = read(tmp_path, "\n".join([f"{HEAD},curvature_per_mm", *rows, "9,0.3,60,1.35,0.8,,,0.0161803"]))
    assert [reading.step_mm for reading in found] == [0.1] * 4 + [0.0]


def test_files_that_are_not_there(tmp_path: Path) -> None:
    for path in (tmp_path / "none.csv", tmp_path):
        with pytest.raises(TableError, match="cannot be read"):
            read_strips(path, StripFitSettings())


def test_the_documentation_names_every_column() -> None:
    text = (Path(__file__).parents[4] / "docs" / "how-to" / "strips.md").read_text(encoding="utf-8")
    assert [name for name in STRIP_COLUMNS if f"`{name}`" not in text] == []
