"""`asterism export` as a user meets it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import matplotlib
import pytest

import asterism
from asterism.print.shape_change import shape_change
from homogenize.law.law_file import PAPER_LAW
from pattern.design.design import save_design
from pattern.layout.build import layout
from pattern.layout.load_design import load_design
from tests.asterism.commands import Outcome, command
from tests.asterism.print.jobs import design

Run = Callable[..., Outcome]


@pytest.fixture
def as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """The command line in the test's folder, within this process: starting one anew takes seconds."""
    monkeypatch.chdir(tmp_path)
    return lambda *words: command(list(words), capsys, monkeypatch)


@pytest.fixture
def run(as_it_is: Run, monkeypatch: pytest.MonkeyPatch) -> Run:
    """The same with letters as drawings in PDF: to take from a font what is used is most of the time of an export."""
    settings = matplotlib.rc_context
    monkeypatch.setattr(matplotlib, "rc_context", lambda given: settings({**given, "pdf.fonttype": 3}))
    return as_it_is


def mistake(ended: Outcome) -> str:
    """The one line of a refused command."""
    assert ended.status == 2, ended.err
    return ended.line


ALWAYS = {
    "border.stl",
    "export.json",
    "instructions.pdf",
    "instructions.txt",
    "layout.dxf",
    "layout.pdf",
    "layout.svg",
    "print.3mf",
    "rounded.toml",
    "stars.lua",
    "stars.scad",
    "stars.stl",
    "start.gcode",
}
PINNED = {"needles.csv", "needles.dxf", "needles.svg"}
SHAPE = {"shape.obj", "shape.stl", "shape.glb", "shape.vtu", "rods.vtu"}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    save_design(design(mesh={"edge_mm": 6.0}), tmp_path / "d.toml")
    return tmp_path / "d.toml"


def test_all_files_and_what_they_say(file: Path, tmp_path: Path, as_it_is: Run) -> None:
    result = as_it_is("export", "d.toml", "--plate", "3", "--fabric", "0.55")
    assert result.status == 0, result.err
    folder = tmp_path / "d-print"
    assert {path.name for path in folder.iterdir()} == ALWAYS | PINNED
    said = json.loads((folder / "export.json").read_text())
    assert set(said["files"]) == ALWAYS | PINNED
    assert said["z_offset_mm"] == pytest.approx(3.55)
    assert said["check_square_mm"] == {"before": [100.0, 100.0], "after": pytest.approx([135.0, 130.0])}
    assert "Z13.55" in (folder / "start.gcode").read_text()
    for text in (result.out, (folder / "instructions.txt").read_text()):
        assert "3.55 mm" in text and "135.0" in text and "130.0" in text
    assert said["tiny_stars"] == [{"at_mm": [0.0, 0.0], "arm_mm": 2.0}] and "tiny pieces" in result.out
    rows = (folder / "needles.csv").read_text().splitlines()
    assert rows[0].startswith("number,printed_x_mm") and len(rows) == said["needles"] + 1
    # the rounded design prints what it says: exporting it again changes nothing
    assert load_design(folder / "rounded.toml").stars.rounding is not None
    again = as_it_is("export", "d-print/rounded.toml", "-o", "again")
    assert again.status == 0
    assert (tmp_path / "again" / "stars.stl").read_bytes() == (folder / "stars.stl").read_bytes()


@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.slow
def test_simulated_shape_and_change_of_shape(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(border={"rings": 1}, mesh={"edge_mm": 6.0}), file)
    result = run("export", "d.toml", "-o", "out", "--simulate", "--no-border")
    assert result.status == 0, result.err
    assert {path.name for path in (tmp_path / "out").iterdir()} == (ALWAYS - {"border.stl"}) | PINNED | SHAPE
    said = json.loads((tmp_path / "out" / "export.json").read_text())
    before, after = said["shape_change"]["height_mm"]
    assert said["shape_change"]["star_distance_mm"] > 0 and said["shape_change"]["model"] == "exact"
    # the same two shapes by hand
    plan = load_design(file)
    rounded = load_design(tmp_path / "out" / "rounded.toml")
    drawn, printed = asterism.simulate(plan), asterism.simulate(rounded)
    assert (before, after) == pytest.approx((drawn.height_mm, printed.height_mm), rel=1e-4)
    mine = shape_change(drawn, printed, rounded, layout(rounded), "exact")
    assert said["shape_change"]["star_distance_mm"] == pytest.approx(mine["star_distance_mm"], rel=1e-3)
    # and from the files of an earlier simulation
    asterism.write_results(printed, tmp_path / "results")
    result = run("export", "d.toml", "-o", "third", "--shape", "results")
    assert result.status == 0, result.err
    assert {path.name for path in (tmp_path / "third").iterdir()} == ALWAYS | PINNED | SHAPE
    # which it may join
    assert run("export", "d.toml", "-o", "results", "--shape", "results").status == 0
    assert SHAPE | {"summary.json"} <= {path.name for path in (tmp_path / "results").iterdir()}


@pytest.mark.slow
def test_a_sheet_that_hangs_below_its_needles_is_told(file: Path, tmp_path: Path, run: Run) -> None:
    """Free edges hang down around needles in the middle."""
    middle = {"points_mm": [[-8.0, 0.0], [8.0, 0.0], [0.0, 12.0]], "scale": 0.76}
    save_design(design(fabric={}, stars={"length_mm": 8.0}, border={"rings": 2}, pins=[middle]), file)
    result = run("export", "d.toml", "-o", "out", "--preview")
    assert result.status == 0, result.err
    said = json.loads((tmp_path / "out" / "export.json").read_text())
    low = asterism.preview(load_design(tmp_path / "out" / "rounded.toml")).positions[:, 2].min()
    assert said["hangs_below_base_mm"] == pytest.approx(-low, rel=1e-6) and low < -0.5
    doubt = said["hangs_doubt_mm"]
    assert doubt > 0.0
    told = f"hangs {-low:.1f} mm below the base, give or take {doubt:.1f} mm"
    assert told in " ".join((tmp_path / "out" / "instructions.txt").read_text().split())
    assert f"{-low:.1f} mm below the base" in result.out
    # without the shape's files too
    result = run("export", "d.toml", "-o", "plain")
    assert result.status == 0 and f"{-low:.1f} mm below the base" in result.out
    assert json.loads((tmp_path / "plain" / "export.json").read_text())["hangs_below_base_mm"] == pytest.approx(-low)
    assert not SHAPE & {path.name for path in (tmp_path / "plain").iterdir()}
    # nothing is known where there is no law
    save_design(design(fabric={"stretch": 1.5}, stars={"length_mm": 8.0}, border={"rings": 2}, pins=[middle]), file)
    result = run("export", "d.toml", "-o", "unknown")
    assert result.status == 0 and "not known: the fabric has no law" in result.out
    told = " ".join((tmp_path / "unknown" / "instructions.txt").read_text().split())
    assert "not known; asterism export --simulate says it" in told
    assert json.loads((tmp_path / "unknown" / "export.json").read_text())["hangs_below_base_mm"] is None


def test_a_smaller_check_square_is_told_everywhere(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(fabric={"stretch": 2.8}, border={"rings": 0}, pins=[]), file)
    result = run("export", "d.toml", "-o", "out")
    assert "60 mm before stretching, 168.0 x 168.0 mm after" in result.out
    said = json.loads((tmp_path / "out" / "export.json").read_text())["check_square_mm"]
    assert said == {"before": [60.0, 60.0], "after": pytest.approx([168.0, 168.0])}
    assert "Draw a square of 60 mm" in (tmp_path / "out" / "instructions.txt").read_text()


def test_what_a_law_does_not_know_is_no_change_of_shape(file: Path, tmp_path: Path, run: Run) -> None:
    """At the law's end thicker stars are as thin as its thinnest, before and after rounding."""
    save_design(design(fabric={}, stars={"length_mm": 8.0, "thickness_mm": 0.15}, border={"rings": 1}, pins=[]), file)
    result = run("export", "d.toml", "-o", "out", "--first-layer", "0.1", "--layer", "0.1")
    assert result.status == 0, result.err
    assert "not reliable: 7 of the stars are outside" in result.out and "--simulate" in result.out


def test_the_fabric_is_to_be_measured_stretched(file: Path, tmp_path: Path, run: Run) -> None:
    assert "released fabric; measure it stretched: --fabric" in run("export", "d.toml", "-o", "out").out
    assert (tmp_path / "out" / "start.gcode").read_text().startswith("; for 0.80 mm of fabric, released")
    assert "(plate and stretched fabric)" in run("export", "d.toml", "-o", "out", "--fabric", "0.4").out
    assert "released" not in (tmp_path / "out" / "start.gcode").read_text()


def test_the_preview_says_what_rounding_does(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(fabric={}, border={"rings": 1}, pins=[]), file)
    result = run("export", "d.toml", "-o", "out")
    assert result.status == 0, result.err
    assert "(preview; --simulate is exact)" in result.out
    said = json.loads((tmp_path / "out" / "export.json").read_text())["shape_change"]
    assert said["model"] == "preview" and said["star_distance_mm"] > 0
    assert not SHAPE & {path.name for path in (tmp_path / "out").iterdir()}
    result = run("export", "d.toml", "-o", "seen", "--preview", "--layer", "0.1")
    assert result.status == 0, result.err
    assert {path.name for path in (tmp_path / "seen").iterdir()} >= SHAPE
    # a print without a shape has no other one's beside it
    assert run("export", "d.toml", "-o", "seen", "--no-border").status == 0
    assert not (SHAPE | {"shape.vtu", "rods.vtu"}) & {path.name for path in (tmp_path / "seen").iterdir()}


@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.parametrize("doubt", [{"is_minimum": False}, {"converged": False}])
def test_a_given_shape_that_may_not_stay_is_told(doubt: dict[str, bool], file: Path, tmp_path: Path, run: Run) -> None:
    """As one that was computed on the way is."""
    save_design(design(fabric={}, stars={"length_mm": 8.0, "width_mm": 1.2}, border={"rings": 1}, pins=[]), file)
    asterism.write_results(asterism.preview(load_design(file)), tmp_path / "results")
    told = "not certified as a minimum"
    result = run("export", "d.toml", "-o", "sure", "--shape", "results")
    assert result.status == 0 and told not in result.err
    assert told not in (tmp_path / "sure" / "instructions.txt").read_text()
    assert json.loads((tmp_path / "sure" / "export.json").read_text())["shape"]["is_certain"] is True
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    doubtful = summary | doubt | {"warnings": ["it passes\nthrough itself"]}
    (tmp_path / "results" / "summary.json").write_text(json.dumps(doubtful))
    result = run("export", "d.toml", "-o", "out", "--shape", "results")
    assert result.status == 0, result.err
    lines = result.err.splitlines()
    assert result.out.startswith(f"  not reliable         the given shape is {told}") and told not in result.err
    strict = run("export", "d.toml", "-o", "out", "--shape", "results", "--strict")
    assert strict.status == 1 and told in strict.out and (tmp_path / "out" / "export.json").exists()
    assert "asterism: the given shape: it passes through itself" in lines
    said = json.loads((tmp_path / "out" / "export.json").read_text())
    assert said["shape"] == {"is_certain": False, "warnings": ["it passes through itself"]}
    assert told in " ".join((tmp_path / "out" / "instructions.txt").read_text().split())
    # a shape without a summary says nothing of itself
    (tmp_path / "results" / "summary.json").unlink()
    result = run("export", "d.toml", "-o", "bare", "--shape", "results")
    assert result.status == 0 and told not in result.err
    said = json.loads((tmp_path / "bare" / "export.json").read_text())
    assert said["shape"] == {"is_certain": None, "warnings": []}


def test_the_shape_of_results_is_not_replaced_beside_its_summary(file: Path, tmp_path: Path, run: Run) -> None:
    (tmp_path / "results").mkdir()
    for name in ("summary.json", "shape.vtu", "rods.vtu", "shape.obj"):
        (tmp_path / "results" / name).write_text("mine")
    for words in (["--preview"], ["--simulate"], ["--shape", "others"]):
        assert "--output = 'results': holds other results" in mistake(run("export", "d.toml", "-o", "results", *words))
    assert run("export", "d.toml", "-o", "results").status == 0
    for name in ("summary.json", "shape.vtu", "rods.vtu", "shape.obj"):
        assert (tmp_path / "results" / name).read_text() == "mine"


def test_where_the_preview_knows_no_law_the_print_is_exported_all_the_same(file: Path, run: Run) -> None:
    """The law is for equal stretches; this fabric has two."""
    result = run("export", "d.toml", "-o", "out")
    assert result.status == 0, result.err
    assert "not computed (" in result.out
    for words in (["--preview"], ["--law", str(PAPER_LAW)]):
        assert "equal stretch in x and y" in mistake(run("export", "d.toml", "-o", "other", *words))


def test_the_preview_takes_a_law(file: Path, run: Run) -> None:
    save_design(design(fabric={}, border={"rings": 1}, pins=[]), file)
    result = run("export", "d.toml", "-o", "out", "--preview", "--law", str(PAPER_LAW))
    assert result.status == 0, result.err
    assert "none.npz" in mistake(run("export", "d.toml", "-o", "other", "--preview", "--law", "none.npz"))


def test_the_design_is_not_written_over(file: Path, tmp_path: Path, run: Run) -> None:
    rounded = file.rename(tmp_path / "rounded.toml")
    before = rounded.read_bytes()
    assert "is where rounded.toml is and stays" in mistake(run("export", "rounded.toml", "-o", "."))
    table = tmp_path / "summary.json"
    table.write_text(json.dumps(design(mesh={"edge_mm": 6.0}).to_dict()))
    for name in ("preview", "simulate", "verify"):
        assert "is where summary.json is and stays" in mistake(run(name, "summary.json", "-o", "."))
    assert rounded.read_bytes() == before and sorted(tmp_path.iterdir()) == [rounded, table]
    (tmp_path / "link.json").symlink_to(table)
    assert "is where link.json is and stays" in mistake(run("preview", "link.json", "-o", "."))


def test_a_plastic_with_an_empty_line_of_advice(file: Path, tmp_path: Path, run: Run) -> None:
    (tmp_path / "p.toml").write_text('name = "x"\ndensity_kg_m3 = 1220\nadvice = ["", "dry it"]\n')
    assert run("export", "d.toml", "--plastic", "p.toml").status == 0


def test_printers_are_listed(tmp_path: Path, run: Run) -> None:
    result = run("printers")
    assert result.status == 0
    assert "ultimaker2" in result.out and "tpu95a" in result.out and "ASTERISM_PROFILES" in result.out


def test_a_broken_file_of_ones_own_does_not_hide_the_others(
    tmp_path: Path, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ASTERISM_PROFILES", str(tmp_path))
    for kind in ("printers", "plastics"):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / "broken.toml").write_text('name = "x"\nwrong = 1\n')
    result = run("printers")
    assert result.status == 2
    assert all(name in result.out for name in ("ender-3", "ultimaker2", "tpu95a", "ASTERISM_PROFILES"))
    assert "  broken" not in result.out
    lines = result.err.splitlines()
    assert len(lines) == 2
    for kind, line in zip(("printers", "plastics"), lines, strict=True):
        assert line.startswith(f"asterism: {tmp_path / kind / 'broken.toml'}: wrong = 1: unknown key")


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
        (["--turn", "30"], "--turn = 30.0: must be 0 on a fabric"),
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


def test_designs_larger_than_the_bed_are_one_line(tmp_path: Path, run: Run) -> None:
    save_design(design(border={"rings": 7}, pins=[]), tmp_path / "d.toml")
    assert "must be within the 223.0 x 223.0 mm" in mistake(run("export", "d.toml"))
    assert [path.name for path in tmp_path.iterdir()] == ["d.toml"]


def test_files_of_an_earlier_export_do_not_stay_behind(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(border={"rings": 0}), file)
    assert run("export", "d.toml", "-o", "out").status == 0
    (tmp_path / "out" / "summary.json").write_text("mine")
    save_design(design(border={"rings": 0}, pins=[]), file)
    assert run("export", "d.toml", "-o", "out", "--no-border").status == 0
    assert {path.name for path in (tmp_path / "out").iterdir()} == (ALWAYS - {"border.stl"}) | {"summary.json"}


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


def test_files_that_are_no_exports_stay(file: Path, tmp_path: Path, run: Run) -> None:
    """A folder without an export holds somebody's own; one with an export loses what the new one does not write."""
    (tmp_path / "d-print").mkdir()
    own = {name: tmp_path / "d-print" / name for name in ("shape.stl", "shape.obj")}
    for path in own.values():
        path.write_text("mine")
    assert run("export", "d.toml").status == 0
    assert all(path.read_text() == "mine" for path in own.values())
    save_design(design(pins=[]), file)
    assert run("export", "d.toml").status == 0 and not (tmp_path / "d-print" / "needles.csv").exists()


@pytest.mark.slow
def test_another_plastic_than_the_designs_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The design has the stiffness of the paper's plastic."""
    (tmp_path / "d.toml").write_text("[stars]\nlength_mm = 10.0\n[border]\nrings = 0\n")
    words = ["export", str(tmp_path / "d.toml"), "--plastic"]
    said = "asterism: PLA is printed, but plastic.modulus_ratio = 3200 of the design is that of TPU 95A: measure strips"
    assert said in command([*words, "pla"], capsys, monkeypatch).err
    assert "is printed" not in command([*words, "tpu95a"], capsys, monkeypatch).err
    (tmp_path / "m.toml").write_text("[plastic]\nmodulus_ratio = 20000.0\n")
    measured = command([*words, "pla", "--material", str(tmp_path / "m.toml")], capsys, monkeypatch)
    assert measured.status == 0 and "is printed" not in measured.err
