"""Sweeps: their table, designs that fail, interruption, and other workers."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import asterism
from asterism.homogenize.campaign.workers import CampaignProgress
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.pattern.design.design import Design
from asterism.sweeps.point import named_law
from asterism.sweeps.sweep import Sweep, sweep_csv, sweep_design, write_sweep
from tests.asterism.commands import Cli
from tests.homogenize import same_process

# arms of 30 mm cross those of their neighbours
VARY = {"stars.thickness_mm": [0.3, 0.4], "stars.length_mm": [8.0, 30.0]}


def small() -> Design:
    return Design.from_dict({"name": "seven", "stars": {"length_mm": 8.0}, "border": {"rings": 1}})


@pytest.fixture(autouse=True)
def one_process(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if "slow" not in request.keywords:
        same_process.use(monkeypatch)


@pytest.fixture(scope="module")
def once(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Sweep]:
    folder = tmp_path_factory.mktemp("sweep") / "designs"
    with pytest.MonkeyPatch.context() as monkeypatch:
        same_process.use(monkeypatch)
        return folder, sweep_design(small(), VARY, folder=folder)


@pytest.mark.slow
def test_each_row_is_the_preview_of_its_design(once: tuple[Path, Sweep]) -> None:
    result = once[1]
    assert [dict(point.parameters) for point in result.points] == [
        {"stars.thickness_mm": h, "stars.length_mm": length} for h in (0.3, 0.4) for length in (8.0, 30.0)
    ]
    third = result.points[2]
    assert third.results is not None and result.pictures[2] is not None and third.problem is None
    shape = asterism.preview(result.design_of(3))
    assert result.design_of(3).required_stars.thickness_mm == 0.4
    assert third.results["height_mm"] == pytest.approx(shape.height_mm, rel=1e-5)
    assert third.results["is_minimum"] is True and third.results["extent_z_mm"] == third.results["height_mm"]


def test_a_design_that_fails_is_a_row_with_its_reason(once: tuple[Path, Sweep]) -> None:
    result = once[1]
    assert result.failed == 2 and result.doubts == ["2 of 4 designs have no shape"]
    failed = result.points[1]
    assert failed.results is None and result.pictures[1] is None and "stars.length_mm" in (failed.problem or "")
    heights = result.column("height_mm")
    assert np.isfinite(heights).tolist() == [True, False, True, False]
    assert result.column("stars.thickness_mm").tolist() == [0.3, 0.3, 0.4, 0.4]


def test_finished_designs_are_not_computed_again(once: tuple[Path, Sweep]) -> None:
    folder, result = once
    reports: list[CampaignProgress] = []
    again = sweep_design(small(), VARY, folder=folder, report=reports.append)
    assert [progress.done for progress in reports] == [4] and reports[0].failed == 2
    assert again.summary == result.summary and sweep_csv(again) == sweep_csv(result)
    more = sweep_design(small(), {**VARY, "stars.length_mm": [8.0, 9.0]}, folder=folder, report=reports.append)
    assert [progress.done for progress in reports[1:]] == [2, 3, 4] and more.failed == 0
    assert reports[1].seconds_left is None and reports[-1].seconds_left == 0.0


def test_a_changed_law_of_the_design_is_not_the_same_law(tmp_path: Path) -> None:
    file = tmp_path / "own.npz"
    table = {"material": {"law": str(file)}}
    assert named_law({}) is None and named_law(table) is None
    names = []
    for number, content in enumerate((b"one", b"two", b"one")):
        file.write_bytes(content)
        os.utime(file, ns=(number, number))
        names.append(named_law(table))
    assert names[0] == names[2] != names[1]


def test_a_law_that_this_machine_cannot_read_is_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker on another machine may lack the file: its failure is a row, and not kept."""
    file, folder = tmp_path / "own.npz", tmp_path / "designs"
    monkeypatch.setattr("asterism.sweeps.sweep.named_law", lambda table: "the law that the caller can read")
    named = Design.from_dict({**small().to_dict(), "material": {"law": str(file)}})
    vary = {"stars.thickness_mm": [0.3]}
    first = sweep_design(named, vary, folder=folder)
    assert "own.npz: cannot be read" in (first.points[0].problem or "") and not list(folder.glob("*.json"))
    file.write_bytes(PAPER_LAW.read_bytes())
    assert sweep_design(named, vary, folder=folder).failed == 0 and len(list(folder.glob("*.json"))) == 1


def test_the_files_hold_the_same_table(once: tuple[Path, Sweep], tmp_path: Path) -> None:
    result = once[1]
    assert write_sweep(result, tmp_path / "out") == ["summary.json", "sweep.csv", "sweep.html"]
    with (tmp_path / "out" / "sweep.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert len(rows) == len(summary["table_rows"]) == 4
    for row, record in zip(rows, summary["table_rows"], strict=True):
        assert int(row["number"]) == record["number"]
        assert row["problem"] == (record["problem"] or "")
        if record["results"]:
            assert float(row["height_mm"]) == record["results"]["height_mm"]
            assert row["is_minimum"] == "true"
    assert summary["design"] == small().to_dict() and summary["sampling"] == "grid"


def test_the_page_needs_no_other_file_and_texts_are_escaped(tmp_path: Path) -> None:
    """A text of the table is no formula of a spreadsheet."""
    named = Design.from_dict({**small().to_dict(), "name": "</script><b>bold"})
    swept = sweep_design(named, {"fabric.bending": ["paper"], "stars.length_mm": [30.0]})
    write_sweep(swept, tmp_path)
    page = (tmp_path / "sweep.html").read_text()
    assert page.count("</script>") == 2 and "&lt;/script&gt;" in page
    assert "src=" not in page.replace("src: `data:image", "") and "<link" not in page
    swept = sweep_design(small(), {"name": ["=1+1"], "stars.length_mm": [30.0]})
    assert next(csv.DictReader(sweep_csv(swept).splitlines()))["name"] == "'=1+1"


def test_a_sweep_by_the_exact_model_has_its_quantities() -> None:
    coarse = Design.from_dict({**small().to_dict(), "mesh": {"edge_mm": 6.0}})
    result = sweep_design(coarse, {"stars.thickness_mm": [0.3]}, exact=True)
    values = result.points[0].results
    assert values is not None and values["stars_up"] == 7 and values["minima"] == 1
    assert "expected_rms_percent" not in values and result.summary.by == "exact"


def test_what_is_no_column_is_refused(once: tuple[Path, Sweep]) -> None:
    with pytest.raises(asterism.Error, match=r"width_mm: no column of this sweep; there are stars\.thickness_mm"):
        once[1].column("width_mm")
    with pytest.raises(asterism.Error, match=r"fabric\.bending: has values that are not numbers"):
        sweep_design(small(), {"fabric.bending": ["none"], "stars.thickness_mm": [0.3]}).column("fabric.bending")
    with pytest.raises(asterism.Error, match="have numbers from 1 to 4"):
        once[1].design_of(5)


def written(folder: Path) -> Path:
    file = folder / "seven.toml"
    file.write_text('name = "seven"\n[stars]\nlength_mm = 8.0\n[border]\nrings = 1\n')
    return file


def test_the_command_writes_the_files(tmp_path: Path, cli: Cli) -> None:
    words = ["sweep", str(written(tmp_path)), "--vary", "stars.thickness_mm=0.3,0.4", "--vary", "stars.length_mm=8,30"]
    ended = cli(words)
    assert ended.status == 0 and "4, of which 2 failed" in ended.out
    assert "about 4 previews" in ended.err and "no answer: design 2, stars.thickness_mm = 0.3" in ended.err
    folder = tmp_path / "seven-sweep"
    assert sorted(file.name for file in folder.iterdir()) == ["designs", "summary.json", "sweep.csv", "sweep.html"]
    strict = cli([*words, "--strict", "--quiet"])
    assert strict.status == 1 and "2 of 4 designs have no shape" in strict.out and strict.err == ""
    none = cli([*words[:2], "--vary", "stars.length_mm=30", "-q"])
    assert none.status == 1
    assert none.line == "asterism: no design has a shape; the column problem of sweep.csv has the reasons"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["stars.thicknes_mm=0.3"], "stars.thicknes_mm = 0.3: unknown key, did you mean thickness_mm?"),
        (
            ["stars.thickness_mm=0.3", "--jobs", "2", "--dask", "tcp://x:1"],
            "--jobs: applies to processes of this machine, not to --dask",
        ),
        (["stars.thickness_mm=0.3", "--exact", "--law", "x.npz"], "--law: is for previews, not with --exact"),
    ],
)
def test_wrong_words_end_the_command_at_once(words: list[str], line: str, tmp_path: Path, cli: Cli) -> None:
    assert cli(["sweep", str(written(tmp_path)), "--vary", *words]).refusal == f"asterism: {line}"
    assert [file.name for file in tmp_path.iterdir()] == ["seven.toml"]


VARIED = "stars.thickness_mm=0.2:0.6:12"
WORDS = [sys.executable, "-m", "asterism", "sweep", "seven.toml", "--vary", VARIED, "--jobs", "2"]


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGKILL])
def test_a_stopped_sweep_goes_on_where_it_stopped(
    number: int, here: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(here)
    first = subprocess.Popen(WORDS, stderr=subprocess.PIPE, text=True)
    kept = here / "seven-sweep" / "designs"
    while len(list(kept.glob("*.json")) if kept.exists() else []) < 3:
        time.sleep(0.01)
        assert first.poll() is None
    first.send_signal(number)
    errors = first.communicate(timeout=30)[1]
    finished = {file: file.stat().st_mtime_ns for file in kept.glob("*.json")}
    assert 3 <= len(finished) < 12
    if number == signal.SIGINT:
        assert first.returncode == 130 and "the same command continues from there" in errors
    same_process.use(monkeypatch)
    assert cli(WORDS[3:]).status == 0
    assert all(file.stat().st_mtime_ns == made for file, made in finished.items())
    with (here / "seven-sweep" / "sweep.csv").open(newline="") as stream:
        heights = [float(row["height_mm"]) for row in csv.DictReader(stream)]
    thickest = Design.from_dict(small().to_dict() | {"stars": {"length_mm": 8.0, "thickness_mm": 0.6}})
    assert len(heights) == 12 and heights[-1] == pytest.approx(asterism.preview(thickest).height_mm, rel=1e-5)


@pytest.mark.slow
def test_dask_gives_the_same_table(monkeypatch: pytest.MonkeyPatch) -> None:
    distributed = pytest.importorskip("distributed")
    vary = {"stars.thickness_mm": "0.2:0.6:3"}
    same_process.use(monkeypatch)
    own = sweep_design(small(), vary)
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        there = sweep_design(small(), vary, dask=cluster.scheduler_address)
    assert sweep_csv(there) == sweep_csv(own) and own.failed == 0
