"""The shape beside the files of an export: computed or given, how rounding changes it, and how certain it is."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import asterism
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.pattern.design.design import save_design
from asterism.pattern.layout.build import layout, load_design
from asterism.print.export import export, printed_shape, shape_change
from tests.asterism.print.jobs import ALWAYS, PINNED, SHAPE, Run, design, job, mistake


@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.slow
def test_simulated_shape_and_change_of_shape(file: Path, tmp_path: Path, run: Run) -> None:
    save_design(design(fabric={}, border={"rings": 1}, mesh={"edge_mm": 6.0}), file)
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
    save_design(design(fabric={"bending": "none"}, stars={"length_mm": 8.0}, border={"rings": 2}, pins=[middle]), file)
    result = run("export", "d.toml", "-o", "unknown")
    assert result.status == 0 and "not known: the fabric has no law" in result.out
    told = " ".join((tmp_path / "unknown" / "instructions.txt").read_text().split())
    assert "not known; asterism export --simulate says it" in told
    assert json.loads((tmp_path / "unknown" / "export.json").read_text())["hangs_below_base_mm"] is None


@pytest.mark.slow
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_the_shape_of_results_is_not_replaced_beside_its_summary(file: Path, tmp_path: Path, run: Run) -> None:
    (tmp_path / "results").mkdir()
    for name in ("summary.json", "shape.vtu", "rods.vtu", "shape.obj"):
        (tmp_path / "results" / name).write_text("mine")
    for words in (["--preview"], ["--simulate"], ["--shape", "others"]):
        assert "--output = 'results': holds other results" in mistake(run("export", "d.toml", "-o", "results", *words))
    assert run("export", "d.toml", "-o", "results").status == 0
    for name in ("summary.json", "shape.vtu", "rods.vtu", "shape.obj"):
        assert (tmp_path / "results" / name).read_text() == "mine"


@pytest.mark.slow
def test_where_the_preview_knows_no_law_the_print_is_exported_all_the_same(file: Path, run: Run) -> None:
    """The fabric does not bend."""
    save_design(design(fabric={"bending": "none"}), file)
    result = run("export", "d.toml", "-o", "out")
    assert result.status == 0, result.err
    assert "not computed (" in result.out
    for words in (["--preview"], ["--law", str(PAPER_LAW)]):
        assert "fabric.bending" in mistake(run("export", "d.toml", "-o", "other", *words))


@pytest.mark.slow
def test_the_preview_takes_a_law(file: Path, run: Run) -> None:
    save_design(design(fabric={}, border={"rings": 1}, pins=[]), file)
    result = run("export", "d.toml", "-o", "out", "--preview", "--law", str(PAPER_LAW))
    assert result.status == 0, result.err
    assert "none.npz" in mistake(run("export", "d.toml", "-o", "other", "--preview", "--law", "none.npz"))


@pytest.mark.slow
def test_the_exact_shape_of_a_print_has_both_starts_and_lists_both_minima(tmp_path: Path) -> None:
    small = design(fabric={}, stars={"length_mm": 8.0}, border={"rings": 0}, pins=[], mesh={"edge_mm": 6.0})
    shape, change = printed_shape(job(small, simulate=True))
    assert shape is not None and change is not None
    (minimum,) = change.minima
    assert minimum.start_names == ["release", "preview"] and minimum.energy_n_mm == shape.summary["energy_n_mm"]
    two = change.changed(minima=[minimum, minimum.changed(distance_percent=7.5, start_names=["preview"])])
    rounded = export(small, tmp_path).summary
    assert "minimum 2" not in rounded.table()
    assert rounded.changed(shape_change=two).table()["minimum 2"].endswith("7.5 % away, from preview")
