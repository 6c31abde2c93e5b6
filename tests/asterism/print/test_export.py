"""`asterism export` as a user meets it: files, folders, refusals, and the shape beside the files, computed or given."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import asterism
from asterism import export, load_design, save_design
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.pattern.layout.build import layout
from asterism.print.export import plastic_warning, printed_shape, shape_change
from asterism.print.printer import load_plastic
from tests.asterism.print.jobs import Run, design, job

ALWAYS = {
    "border.stl", "export.json", "instructions.pdf", "instructions.txt", "layout.dxf", "layout.pdf", "layout.svg",
    "print.3mf", "rounded.toml", "stars.lua", "stars.scad", "stars.stl", "start.gcode",
}  # fmt: skip
PINNED = {"needles.csv", "needles.dxf", "needles.svg"}
SHAPE = {"shape.obj", "shape.stl", "shape.glb", "shape.vtu", "rods.vtu"}


def names(folder: str) -> set[str]:
    return {path.name for path in Path(folder).iterdir()}


def numbers(folder: str) -> Any:
    return json.loads((Path(folder) / "export.json").read_text())


def instructions(folder: str) -> str:
    """As one line."""
    return " ".join((Path(folder) / "instructions.txt").read_text().split())


@pytest.mark.slow
def test_all_files_and_what_they_say(file: Path, tmp_path: Path, run: Run) -> None:
    result = run("export", "d.toml", "--plate", "3", "--fabric", "0.55").done
    assert "(plate and stretched fabric)" in result.out
    assert "larger than the bed" not in result.err  # the profile of the printer states its frame
    folder = tmp_path / "d-print"
    said = numbers("d-print")
    assert names("d-print") == set(said["files"]) == ALWAYS | PINNED
    assert said["z_offset_mm"] == pytest.approx(3.55)
    assert said["check_square_mm"] == {"before": [100.0, 100.0], "after": pytest.approx([135.0, 135.0])}
    assert "Z13.55" in (folder / "start.gcode").read_text()
    for text in (result.out, instructions("d-print")):
        assert "3.55 mm" in text and "135.0" in text
    assert said["tiny_stars"] == [{"at_mm": [0.0, 0.0], "arm_mm": 2.0}] and "tiny pieces" in result.out
    rows = (folder / "needles.csv").read_text().splitlines()
    assert rows[0].startswith("number,printed_x_mm") and len(rows) == said["needles"] + 1
    # the rounded design prints what it says: exporting it again changes nothing
    assert load_design(folder / "rounded.toml").stars.rounding is not None
    (tmp_path / "p.toml").write_text('name = "x"\ndensity_kg_m3 = 1220\nadvice = ["", "dry it"]\n')
    again = run("export", "d-print/rounded.toml", "-o", "again", "--plastic", "p.toml").done
    assert "released fabric; measure it stretched: --fabric" in again.out
    assert (tmp_path / "again" / "stars.stl").read_bytes() == (folder / "stars.stl").read_bytes()


def test_the_design_is_not_written_over(file: Path, tmp_path: Path, run: Run) -> None:
    rounded = file.rename(tmp_path / "rounded.toml")
    before = rounded.read_bytes()
    assert "is where rounded.toml is and stays" in run("export", "rounded.toml", "-o", ".").refusal
    table = tmp_path / "summary.json"
    table.write_text(json.dumps(design(fabric={}, mesh={"edge_mm": 6.0}).to_dict()))
    for name in ("preview", "simulate", "verify"):
        assert "is where summary.json is and stays" in run(name, "summary.json", "-o", ".").refusal
    assert rounded.read_bytes() == before and sorted(tmp_path.iterdir()) == [rounded, table]
    (tmp_path / "link.json").symlink_to(table)
    assert "is where link.json is and stays" in run("preview", "link.json", "-o", ".").refusal


@pytest.mark.slow
def test_files_of_an_earlier_export_go_and_those_of_somebody_else_stay(file: Path, tmp_path: Path, run: Run) -> None:
    """A folder without an export holds somebody's own; one with an export loses what the new one does not write."""
    (tmp_path / "out").mkdir()
    own = {name: tmp_path / "out" / name for name in ("shape.stl", "shape.obj", "summary.json")}
    for name in ("shape.stl", "shape.obj"):
        own[name].write_text("mine")
    save_design(design(fabric={}, border={"rings": 0}), file)
    assert run("export", "d.toml", "-o", "out").done
    assert all(own[name].read_text() == "mine" for name in ("shape.stl", "shape.obj"))
    own["summary.json"].write_text("mine")
    for name in ("model.3dm", "print-below.3mf"):
        (tmp_path / "out" / name).write_text("of the earlier export")
    save_design(design(fabric={}, border={"rings": 0}, pins=[]), file)
    assert run("export", "d.toml", "-o", "out", "--no-border").done
    # shape.obj may be that of the other result
    left = {"summary.json", "shape.obj"}
    assert names("out") == (ALWAYS - {"border.stl"}) | left


def test_another_plastic_than_the_designs_is_named() -> None:
    """The design has the stiffness of the paper's plastic."""
    (said,) = plastic_warning(design(), load_plastic("pla"))
    assert said.startswith("PLA is printed, but plastic.modulus_ratio = 3200 of the design is that of TPU 95A: measure")
    assert not list(plastic_warning(design(), load_plastic("tpu95a")))
    assert not list(plastic_warning(design(plastic={"modulus_ratio": 20000.0}), load_plastic("pla")))


@pytest.mark.slow
def test_without_the_package_for_dxf_all_else_is_written(file: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("export", "d.toml", "-o", "out").done  # its drawings in DXF do not stay beside the next export
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    result = run("export", "d.toml", "-o", "out").done
    assert 'no DXF is written: needs ezdxf: pip install "asterism-fabric[cad]"' in result.err
    drawings = {name for name in ALWAYS | PINNED if name.endswith(".dxf")}
    assert drawings and names("out") == (ALWAYS | PINNED) - drawings


@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.slow
def test_simulated_shape_and_change_of_shape(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(fabric={}, border={"rings": 1}, mesh={"edge_mm": 6.0}), file)
    result = run("export", "d.toml", "-o", "out", "--simulate", "--no-border").done
    assert names("out") == (ALWAYS - {"border.stl"}) | PINNED | SHAPE
    said = numbers("out")
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
    result = run("export", "d.toml", "-o", "third", "--shape", "results").done
    assert "not certified" not in result.out + instructions("third")
    assert numbers("third")["shape"]["is_certain"] is True
    assert names("third") == ALWAYS | PINNED | SHAPE
    # which it may join
    assert run("export", "d.toml", "-o", "results", "--shape", "results").done
    assert SHAPE | {"summary.json"} <= names("results")


@pytest.mark.slow
def test_a_sheet_that_hangs_below_its_needles_is_told(file: Path, tmp_path: Path, run: Run) -> None:
    """Free edges hang down around needles in the middle."""
    middle = {"points_mm": [[-8.0, 0.0], [8.0, 0.0], [0.0, 12.0]], "scale": 0.76}
    save_design(design(fabric={}, stars={"length_mm": 8.0}, border={"rings": 2}, pins=[middle]), file)
    result = run("export", "d.toml", "-o", "out").done
    assert not SHAPE & names("out")
    said = numbers("out")
    low = asterism.preview(load_design(tmp_path / "out" / "rounded.toml")).positions[:, 2].min()
    assert said["hangs_below_base_mm"] == pytest.approx(-low, rel=1e-6) and low < -0.5
    doubt = said["hangs_doubt_mm"]
    assert doubt > 0.0
    told = f"hangs {-low:.1f} mm below the base, give or take {doubt:.1f} mm"
    assert told in instructions("out")
    assert f"{-low:.1f} mm below the base" in result.out


@pytest.mark.slow
def test_the_preview_says_what_rounding_does(file: Path, run: Run) -> None:
    save_design(design(fabric={}, border={"rings": 1}, pins=[]), file)
    result = run("export", "d.toml", "-o", "out").done
    assert "(preview; --simulate is exact)" in result.out
    said = numbers("out")["shape_change"]
    assert said["model"] == "preview" and said["star_distance_mm"] > 0
    assert not SHAPE & names("out")
    words = ["export", "d.toml", "-o", "seen", "--preview", "--law"]
    assert run(*words, str(PAPER_LAW)).done
    assert names("seen") >= SHAPE
    # a print without a shape has no other one's beside it
    assert run("export", "d.toml", "-o", "seen", "--no-border").done
    assert not SHAPE & names("seen")
    assert "none.npz" in run(*words, "none.npz").refusal


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_a_given_shape_that_may_not_stay_is_told(file: Path, tmp_path: Path, run: Run) -> None:
    """As one that was computed on the way is."""
    save_design(design(fabric={}, stars={"length_mm": 8.0, "width_mm": 1.2}, border={"rings": 1}, pins=[]), file)
    found = asterism.preview(load_design(file))
    for doubt in ({"is_minimum": False}, {"converged": False}):
        assert job(load_design(file), shape=replace(found, summary=found.summary | doubt)).is_certain is False
    asterism.write_results(found, tmp_path / "results")
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    doubtful = summary | {"is_minimum": False, "warnings": ["it passes\nthrough itself"]}
    (tmp_path / "results" / "summary.json").write_text(json.dumps(doubtful))
    told = "not certified as a minimum"
    words = ["export", "d.toml", "-o", "out", "--shape", "results"]
    result = run(*words, "--strict")
    assert result.status == 1
    assert result.out.startswith(f"  not reliable         the given shape is {told}") and told not in result.err
    assert "asterism: the given shape: it passes through itself" in result.err.splitlines()
    assert numbers("out")["shape"] == {"is_certain": False, "warnings": ["it passes through itself"]}
    assert told in instructions("out")
    # a shape without a summary says nothing of itself
    (tmp_path / "results" / "summary.json").unlink()
    assert told not in run(*words).done.err
    assert numbers("out")["shape"] == {"is_certain": None, "warnings": []}


@pytest.mark.slow
def test_the_shape_of_results_is_not_replaced_beside_its_summary(file: Path, tmp_path: Path, run: Run) -> None:
    (tmp_path / "results").mkdir()
    for name in ("summary.json", "shape.vtu", "rods.vtu", "shape.obj"):
        (tmp_path / "results" / name).write_text("mine")
    for words in (["--preview"], ["--simulate"], ["--shape", "others"]):
        assert "--output = 'results': holds other results" in run("export", "d.toml", "-o", "results", *words).refusal
    assert run("export", "d.toml", "-o", "results").done
    for name in ("summary.json", "shape.vtu", "rods.vtu", "shape.obj"):
        assert (tmp_path / "results" / name).read_text() == "mine"


@pytest.mark.slow
def test_where_the_preview_knows_no_law_the_print_is_exported_all_the_same(file: Path, run: Run) -> None:
    """The fabric does not bend."""
    save_design(design(fabric={"bending": "none"}), file)
    result = run("export", "d.toml", "-o", "out").done
    assert "not computed (" in result.out and "not known: the fabric has no law" in result.out
    told = instructions("out")
    assert "not known; asterism export --simulate says it" in told
    assert numbers("out")["hangs_below_base_mm"] is None
    for words in (["--preview"], ["--law", str(PAPER_LAW)]):
        assert "fabric.bending" in run("export", "d.toml", "-o", "other", *words).refusal


@pytest.mark.slow
def test_the_exact_shape_of_a_print_has_both_starts_and_lists_both_minima(tmp_path: Path) -> None:
    small = design(fabric={}, stars={"length_mm": 8.0}, border={"rings": 0}, pins=[], mesh={"edge_mm": 6.0})
    shape, change = printed_shape(job(small, simulate=True))
    (minimum,) = change.minima
    assert minimum.start_names == ["release", "preview"] and minimum.energy_n_mm == shape.summary["energy_n_mm"]
    two = change | {"minima": [minimum, minimum | {"distance_percent": 7.5, "start_names": ["preview"]}]}
    rounded = export(small, tmp_path).summary
    assert "minimum 2" not in rounded.table()
    assert (rounded | {"shape_change": two}).table()["minimum 2"].endswith("7.5 % away, from preview")
