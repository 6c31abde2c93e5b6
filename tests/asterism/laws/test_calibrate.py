"""Calibration as a user meets it: one command makes a law, another shows it."""

from __future__ import annotations

import io
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from asterism.homogenize.campaign.workers import CampaignProgress
from asterism.homogenize.law.law_file import law_digest, load_law
from asterism.homogenize.law.plan import CellTask, SampleRecord
from asterism.process.progress_line import CountLine
from tests.asterism.commands import Cli
from tests.homogenize import same_process

PLAN = """
name = "small"
[plan]
lengths_mm = [3.0, 10.0]
thicknesses_mm = [0.3, 0.5]
widths_mm = [1.2]
held_out = 1
edge_mm = 4.0
"""


def run(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    program = [sys.executable, "-m", "asterism", *words]
    return subprocess.run(program, cwd=cwd, capture_output=True, text=True, timeout=300)


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which a small law was made."""
    folder = tmp_path_factory.mktemp("law")
    (folder / "m.toml").write_text(PLAN)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ASTERISM_CELLS", str(folder / "cells"))
        result = run("calibrate", "m.toml", "--jobs", "2", cwd=folder)
    assert result.returncode == 0, result.stderr
    assert "6 of 6 cells" in result.stderr and "held out" in result.stdout
    return folder


@pytest.mark.slow
def test_a_law_with_all_that_made_it(place: Path) -> None:
    law = load_law(place / "m.npz")
    assert law.made["command"] == "asterism calibrate m.toml" and law.made["cell_seconds"] > 0
    assert len(list((place / "cells").glob("*.json"))) == 6
    table = law.at(1.35)
    values = table([0.0, 3.0, 10.0], 0.3, 1.2).value
    assert abs(values["lam"][0] * 1.35 - 1) < 1e-12 and values["kappa"][0] == 0
    assert (np.diff(values["lam"]) > 0).all() and (np.diff(values["kappa"]) > 0).all()


@pytest.mark.slow
def test_show_writes_a_picture_and_a_summary(place: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(place)
    shown = cli(["law", "show", "m.npz", "-o", "shown"])
    assert shown.status == 0, shown.err
    assert "kappa" in shown.out and "stretch 1.35" in shown.out
    with Image.open(place / "shown" / "law.png") as image:
        assert image.width > 1000 and np.asarray(image).std() > 5
    summary = json.loads((place / "shown" / "summary.json").read_text())
    assert summary["cells"] == 6 and summary["residuals"]["1.35"]["held_out"]["cells"]


@pytest.mark.slow
def test_the_law_that_comes_with_the_package(here: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asterism.laws.show_law.law_figure", lambda law: Figure())  # it takes seconds
    shown = cli(["law", "show"])
    assert shown.status == 0, shown.err
    assert "stretch 1.75" in shown.out and (here / "paper-law" / "law.png").exists()
    law = load_law()
    assert law.made["command"] == "asterism calibrate" and law.stretches == (1.35, 1.75)
    for table in law.tables:
        values = table(np.zeros(1), 0.3, 1.2).value
        assert abs(values["lam"][0] * table.stretch - 1) < 1e-8 and values["kappa"][0] == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["calibrate", "none.toml"], "none.toml"),
        (["calibrate", "bad.toml"], "bad.toml: plan.edge_mm = 40"),
        (["calibrate", "m.toml", "-o", "law.txt"], "must end with .npz"),
        (["calibrate", "m.toml", "--jobs", "0"], "--jobs"),
        (["calibrate", "m.toml", "--dask", "nonsense://here", "-o", "n.npz"], "no scheduler answers"),
        (["calibrate", "m.toml", "--jobs", "2", "--dask", "tcp://127.0.0.1:1"], "--jobs"),
        (["law", "show", "m.toml"], "not a law"),
        (["law", "show", "none.npz"], "none.npz: cannot be read"),
    ],
)
def test_mistakes_are_one_line(words: list[str], expected: str, here: Path, cli: Cli) -> None:
    if "--dask" in words:
        pytest.importorskip("distributed")
    (here / "m.toml").write_text(PLAN)
    (here / "bad.toml").write_text("[plan]\nedge_mm = 40")
    refused = cli(words)
    assert refused.status == 2 and expected in refused.line
    assert not list(here.glob("*.npz"))


def test_cells_that_all_fail_are_status_one(here: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """Arms of neighbouring stars that overlap have no cell."""
    (here / "m.toml").write_text(PLAN.replace("3.0, 10.0", "12.0, 14.0") + "[lattice]\narms = 5\n")
    same_process.use(monkeypatch)
    ended = cli(["calibrate", "m.toml", "--jobs", "2"])
    assert ended.status == 1
    last = ended.err.splitlines()[-1]
    assert "fewer than half of the cells" in last and "shorten or turn them" in last
    assert "Traceback" not in ended.err
    assert not list(here.glob("*.npz"))


def test_interrupted_before_a_cell_is_finished(tmp_path: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(watch: CountLine, progress: object) -> None:
        raise KeyboardInterrupt

    (tmp_path / "m.toml").write_text(PLAN)
    monkeypatch.setattr(CountLine, "report", interrupted)
    ended = cli(["calibrate", str(tmp_path / "m.toml"), "--jobs", "1"])
    assert ended.status == 130 and ended.line.startswith("asterism: interrupted")
    assert not (tmp_path / "m.npz").exists()


@pytest.mark.slow
def test_interrupted_and_resumed(place: Path, here: Path, cli: Cli) -> None:
    """With one process and fresh cells: bit for bit the law of two processes at once."""
    (here / "m.toml").write_text(PLAN)
    with open(here / "errors", "w") as errors:
        words = [sys.executable, "-m", "asterism", "calibrate", "m.toml", "--jobs", "1"]
        process = subprocess.Popen(words, cwd=here, stderr=errors)
    samples = here / "cells"
    while not (samples.exists() and list(samples.glob("*.json"))):
        time.sleep(0.02)
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 130
    last = (here / "errors").read_text().splitlines()[-1]
    assert last.startswith(f"asterism: interrupted; finished cells are in {samples}")
    assert not (here / "m.npz").exists()
    kept = len(list(samples.glob("*.json")))
    result = cli(["calibrate", "m.toml", "--jobs", "1"])
    assert law_digest(load_law(here / "m.npz")) == law_digest(load_law(place / "m.npz"))
    assert result.status == 0 and f"{kept} of 6 cells" in result.err.splitlines()[0]


def test_cells_that_fail_for_one_reason_have_one_line() -> None:
    stream = io.StringIO()
    watch = CountLine("cells", stream)
    for number in range(40):
        task = CellTask(1.35, False, (5.0 + 0.1 * number, 0.3, 1.2))
        failed = SampleRecord(task, f"length {task.sizes[0]:g} mm", None, f"gradient {number} N: no minimum", 1.0)
        watch.report(CampaignProgress(number + 1, 80, number + 1, None, failed))
    lines = [line for line in stream.getvalue().splitlines() if "no answer" in line]
    assert lines == ["  no answer: length 5 mm: gradient 0 N: no minimum"]
