"""`asterism export` as a user meets it: files, folders, refusals."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from asterism.pattern.design.design import save_design
from asterism.pattern.layout.build import load_design
from tests.asterism.commands import Cli
from tests.asterism.print.jobs import ALWAYS, PINNED, Run, design, mistake


@pytest.mark.slow
def test_all_files_and_what_they_say(file: Path, tmp_path: Path, as_it_is: Run) -> None:
    result = as_it_is("export", "d.toml", "--plate", "3", "--fabric", "0.55")
    assert result.status == 0, result.err
    folder = tmp_path / "d-print"
    assert {path.name for path in folder.iterdir()} == ALWAYS | PINNED
    said = json.loads((folder / "export.json").read_text())
    assert set(said["files"]) == ALWAYS | PINNED
    assert said["z_offset_mm"] == pytest.approx(3.55)
    assert said["check_square_mm"] == {"before": [100.0, 100.0], "after": pytest.approx([135.0, 135.0])}
    assert "Z13.55" in (folder / "start.gcode").read_text()
    for text in (result.out, (folder / "instructions.txt").read_text()):
        assert "3.55 mm" in text and "135.0" in text
    assert said["tiny_stars"] == [{"at_mm": [0.0, 0.0], "arm_mm": 2.0}] and "tiny pieces" in result.out
    rows = (folder / "needles.csv").read_text().splitlines()
    assert rows[0].startswith("number,printed_x_mm") and len(rows) == said["needles"] + 1
    # the rounded design prints what it says: exporting it again changes nothing
    assert load_design(folder / "rounded.toml").stars.rounding is not None
    again = as_it_is("export", "d-print/rounded.toml", "-o", "again")
    assert again.status == 0
    assert (tmp_path / "again" / "stars.stl").read_bytes() == (folder / "stars.stl").read_bytes()


def test_a_smaller_check_square_is_told_everywhere(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(fabric={"stretch": 2.8}, border={"rings": 0}, pins=[]), file)
    result = run("export", "d.toml", "-o", "out")
    assert "60 mm before stretching, 168.0 x 168.0 mm after" in result.out
    said = json.loads((tmp_path / "out" / "export.json").read_text())["check_square_mm"]
    assert said == {"before": [60.0, 60.0], "after": pytest.approx([168.0, 168.0])}
    assert "Draw a square of 60 mm" in (tmp_path / "out" / "instructions.txt").read_text()


@pytest.mark.slow
def test_the_fabric_is_to_be_measured_stretched(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(fabric={}, stars={"length_mm": 8.0}, border={"rings": 0}, pins=[]), file)
    assert "released fabric; measure it stretched: --fabric" in run("export", "d.toml", "-o", "out").out
    assert (tmp_path / "out" / "start.gcode").read_text().startswith("; for 0.80 mm of fabric, released")
    assert "(plate and stretched fabric)" in run("export", "d.toml", "-o", "out", "--fabric", "0.4").out
    assert "released" not in (tmp_path / "out" / "start.gcode").read_text()


def test_the_design_is_not_written_over(file: Path, tmp_path: Path, run: Run) -> None:
    rounded = file.rename(tmp_path / "rounded.toml")
    before = rounded.read_bytes()
    assert "is where rounded.toml is and stays" in mistake(run("export", "rounded.toml", "-o", "."))
    table = tmp_path / "summary.json"
    table.write_text(json.dumps(design(fabric={}, mesh={"edge_mm": 6.0}).to_dict()))
    for name in ("preview", "simulate", "verify"):
        assert "is where summary.json is and stays" in mistake(run(name, "summary.json", "-o", "."))
    assert rounded.read_bytes() == before and sorted(tmp_path.iterdir()) == [rounded, table]
    (tmp_path / "link.json").symlink_to(table)
    assert "is where link.json is and stays" in mistake(run("preview", "link.json", "-o", "."))


@pytest.mark.slow
def test_a_plastic_with_an_empty_line_of_advice(file: Path, tmp_path: Path, run: Run) -> None:
    (tmp_path / "p.toml").write_text('name = "x"\ndensity_kg_m3 = 1220\nadvice = ["", "dry it"]\n')
    assert run("export", "d.toml", "--plastic", "p.toml").status == 0


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (["--printer", "ulti"], "--printer = 'ulti': must be a file"),
        (["--printer", "mine.toml"], "mine.toml: cannot be read"),
        (["--plastic", "wood"], "--plastic = 'wood': must be a file"),
        (["--layer", "0"], "--layer = 0.0: must be at least 0.01"),
        (["--layer", "1.9"], "--layer = 1.9: must be at most the nozzle's 0.4 mm"),
        (["--first-layer", "0.5"], "--first-layer = 0.5: must be at most the nozzle's 0.4 mm"),
        (["--first-layer", "9"], "--first-layer = 9.0: must be at most 2"),
        (["--plate", "-1"], "--plate = -1.0: must be at least 0"),
        (["--fabric", "nan"], "--fabric = nan: must be from 0.01 to 50"),
        (["--fabric", "0"], "--fabric = 0.0: must be from 0.01 to 50"),
        (["--needle-spacing", "0"], "--needle-spacing = 0.0: must be from 1 to 1000"),
        (["--fabric-set", "-1"], "--fabric-set = -1.0: must be from 0 to 50"),
        (["--shape", "nowhere"], "nowhere: is not there"),
        (["--shape", "x", "--simulate"], "--shape: must be the only one"),
        (["--preview", "--simulate"], "--preview: must be the only one"),
    ],
)
def test_a_mistake_is_one_line_and_leaves_nothing(
    options: list[str], line: str, file: Path, tmp_path: Path, run: Run
) -> None:
    assert line in mistake(run("export", "d.toml", "-o", "out", *options))
    assert [path.name for path in tmp_path.iterdir()] == ["d.toml"]


def test_a_fabric_of_two_stretches_is_not_turned(tmp_path: Path, run: Run) -> None:
    save_design(design(), tmp_path / "d.toml")
    assert "--turn = 30.0: must be 0 on a fabric" in mistake(run("export", "d.toml", "-o", "out", "--turn", "30"))
    assert [path.name for path in tmp_path.iterdir()] == ["d.toml"]


def test_designs_larger_than_the_bed_are_one_line(tmp_path: Path, run: Run) -> None:
    save_design(design(border={"rings": 7}, pins=[]), tmp_path / "d.toml")
    assert "must be within the 223.0 x 223.0 mm" in mistake(run("export", "d.toml"))
    assert [path.name for path in tmp_path.iterdir()] == ["d.toml"]


@pytest.mark.slow
def test_files_of_an_earlier_export_do_not_stay_behind(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(fabric={}, border={"rings": 0}), file)
    assert run("export", "d.toml", "-o", "out").status == 0
    (tmp_path / "out" / "summary.json").write_text("mine")
    save_design(design(fabric={}, border={"rings": 0}, pins=[]), file)
    assert run("export", "d.toml", "-o", "out", "--no-border").status == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == (ALWAYS - {"border.stl"}) | {"summary.json"}


@pytest.mark.slow
def test_an_export_that_fails_leaves_the_earlier_one(file: Path, tmp_path: Path, run: Run) -> None:
    assert run("export", "d.toml", "-o", "out").status == 0
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    (tmp_path / "out" / "print.3mf").unlink()
    (tmp_path / "out" / "print.3mf").mkdir()
    mistake(run("export", "d.toml", "-o", "out", "--plate", "9"))
    (tmp_path / "out" / "print.3mf").rmdir()
    after = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    del before["print.3mf"]
    assert after == before


@pytest.mark.slow
def test_files_that_are_no_exports_stay(file: Path, tmp_path: Path, run: Run) -> None:
    """A folder without an export holds somebody's own; one with an export loses what the new one does not write."""
    (tmp_path / "d-print").mkdir()
    own = {name: tmp_path / "d-print" / name for name in ("shape.stl", "shape.obj")}
    for path in own.values():
        path.write_text("mine")
    assert run("export", "d.toml").status == 0
    assert all(path.read_text() == "mine" for path in own.values())
    save_design(design(fabric={}, border={"rings": 0}, pins=[]), file)
    assert run("export", "d.toml").status == 0 and not (tmp_path / "d-print" / "needles.csv").exists()


@pytest.mark.slow
def test_another_plastic_than_the_designs_is_named(tmp_path: Path, cli: Cli) -> None:
    """The design has the stiffness of the paper's plastic."""
    (tmp_path / "d.toml").write_text("[stars]\nlength_mm = 10.0\n[border]\nrings = 0\n")
    words = ["export", str(tmp_path / "d.toml"), "--plastic"]
    said = "asterism: PLA is printed, but plastic.modulus_ratio = 3200 of the design is that of TPU 95A: measure strips"
    assert said in cli([*words, "pla"]).err
    assert "is printed" not in cli([*words, "tpu95a"]).err
    (tmp_path / "m.toml").write_text("[plastic]\nmodulus_ratio = 20000.0\n")
    measured = cli([*words, "pla", "--material", str(tmp_path / "m.toml")])
    assert measured.status == 0 and "is printed" not in measured.err


@pytest.mark.slow
def test_without_the_package_for_dxf_all_else_is_written(
    file: Path, tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run("export", "d.toml", "-o", "out").status == 0  # its drawings in DXF do not stay beside the next export
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    result = run("export", "d.toml", "-o", "out")
    assert result.status == 0
    assert 'no DXF is written: needs ezdxf: pip install "asterism-fabric[cad]"' in result.err
    drawings = {name for name in ALWAYS | PINNED if name.endswith(".dxf")}
    assert drawings and {path.name for path in (tmp_path / "out").iterdir()} == (ALWAYS | PINNED) - drawings
