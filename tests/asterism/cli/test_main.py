"""The command line as a user meets it: exit status, one line for a mistake, what it costs, nothing half-written."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from asterism.homogenize.law.law_file import law_bytes
from asterism.results.files import SUMMARY_FILE
from tests.asterism.commands import SIGN_OF_LIFE, Cli, interrupted
from tests.asterism.previews.laws import plain_law

SMALL = """
[stars]
length_mm = 10.0
thickness_mm = 0.4
width_mm = 1.2
[border]
rings = 0
[mesh]
edge_mm = 4.0
"""


@pytest.fixture
def folder(here: Path) -> Path:
    """Where the commands run, with a small design."""
    (here / "d.toml").write_text(SMALL)
    return here


@pytest.mark.slow
def test_new_lists_and_writes(here: Path, cli: Cli) -> None:
    assert "tube" in cli(["new"]).out.split()
    drawn = cli(["new", "leaf"]).done
    assert "asterism simulate leaf.toml" in drawn.out and "preview" not in drawn.out
    assert "asterism preview skew-grid.toml" in cli(["new", "skew-grid"]).done.out
    for words in ([], [], ["-o", "missing/folder/tube.toml"]):  # nothing is lost by writing the same again
        assert cli(["new", "tube", *words]).done
    assert (here / "missing" / "folder" / "tube.toml").read_bytes() == (here / "tube.toml").read_bytes()
    (here / "tube.toml").write_text("mine")
    assert "exists" in cli(["new", "tube"]).refusal
    assert (here / "tube.toml").read_text() == "mine"


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.parametrize("name", ["simulate", "verify"])
def test_a_quiet_command_prints_its_result_and_no_progress(name: str, folder: Path, cli: Cli) -> None:
    done = cli([name, "d.toml", "--quiet"])
    assert done.status == 0 and "height" in done.out
    assert all(line.startswith("asterism: ") for line in done.err.splitlines())


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_stars_that_do_not_stay_where_they_were_sent_are_named(tmp_path: Path, cli: Cli) -> None:
    """This star starts down, and cannot stay there."""
    (tmp_path / "d.toml").write_text(SMALL.replace("10.0", "5.0\nbranch = 'down'"))
    done = cli(["simulate", str(tmp_path / "d.toml")]).done
    assert "1 of 1 up" in done.out
    assert done.err.endswith("1 of 1 stars of the exact shape is not on the side that the design asks for: star 0\n")
    # on a fabric that was not stretched stars stay flat, and are on no side
    (tmp_path / "f.toml").write_text("[fabric]\nstretch = 1.0\n" + SMALL)
    assert "asks for" not in cli(["simulate", str(tmp_path / "f.toml")]).done.err


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
@pytest.mark.parametrize(
    "words",
    [
        ["preview", "pipe.toml"],
        ["preview", "d.toml", "--material", "pipe.toml"],
        ["preview", "d.toml", "--law", "pipe.npz"],
        ["strips", "fit", "pipe.csv"],
        ["export", "d.toml", "--printer", "pipe.toml"],
        ["compare", "pipe.vtu", "pipe.obj"],
    ],
)
def test_a_pipe_is_refused_at_once(words: list[str], folder: Path, cli: Cli) -> None:
    """To read it would wait until somebody writes into it."""
    for name in ("pipe.toml", "pipe.npz", "pipe.csv", "pipe.vtu", "pipe.obj"):
        os.mkfifo(folder / name)
    assert "pipe." in cli(words).refusal
    assert len(list(folder.iterdir())) == 6


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_interrupt_leaves_nothing(number: int, tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(SMALL.replace("rings = 0", "rings = 3").replace("4.0", "1.5"))
    lines = interrupted(["simulate", "d.toml", "-o", "out"], tmp_path, lambda said: "iteration" in said, number)
    assert lines[-1] == "asterism: interrupted"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["d.toml", "errors"]


# what Python runs before the command: a Ctrl-C at the moment when a package is looked for
INTERRUPTED = """
import signal, sys
class Interruption:
    def find_spec(self, name, *others):
        if name == {package!r}:
            sys.meta_path.remove(self)
            {how}
sys.meta_path.insert(0, Interruption())
"""
RAISED = "signal.raise_signal(signal.SIGINT)"
CHANGED = f"""try:
                {RAISED}
            except BaseException:
                raise RuntimeError from None"""


@pytest.mark.slow
@pytest.mark.parametrize(("package", "how"), [("typer", RAISED), ("scipy", CHANGED)])
def test_interrupt_while_packages_are_loaded(package: str, how: str, tmp_path: Path) -> None:
    """Some packages make an error of it."""
    (tmp_path / "d.toml").write_text(SMALL)
    (tmp_path / "sitecustomize.py").write_text(INTERRUPTED.format(package=package, how=how))
    words = [sys.executable, "-m", "asterism", "simulate", "d.toml", "-o", "out"]
    places = f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
    environment = {**os.environ, "PYTHONPATH": places, "PYTHONDONTWRITEBYTECODE": "1"}
    ended = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300)
    assert ended.returncode == 130
    # the cost is said once the engine is loaded
    lines = [line for line in ended.stderr.splitlines() if not line.startswith(("about ", SIGN_OF_LIFE))]
    assert lines == ["asterism: interrupted"]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["d.toml", "sitecustomize.py"]


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no file that is always full")
def test_what_cannot_be_printed_is_said_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(SMALL)
    for words in (["new"], ["simulate", "d.toml", "-o", "out"]):
        with open("/dev/full", "w") as full:
            program = [sys.executable, "-m", "asterism", *words]
            ended = subprocess.run(program, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, timeout=300)
        assert ended.returncode == 1
        assert ended.stderr.splitlines()[-1] == "asterism: cannot print: no space left on device"
        assert "Traceback" not in ended.stderr and "Exception" not in ended.stderr
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["is_minimum"]  # and results stay


VARY = ["--vary", "stars.thickness_mm=0.3,0.4"]
FIT = ["fit", "t.npy", "--extent-mm", "120", "-o"]
# a command, a folder or a file in the way of its results, and the function that computes them
CASES = [
    (["preview", "d.toml"], f"d/{SUMMARY_FILE}/", "previews.session.preview"),
    (["simulate", "d.toml"], "d/minimum-2.png/", "verification.simulate.simulate"),
    (["verify", "d.toml"], "d-verified/exact.obj/", "verification.verify.verify"),
    (["export", "d.toml"], "d-print/layout.pdf/", "print.export.export"),
    (["export", "d.toml", "--simulate"], "d-print/rods.vtu/", "print.export.export"),
    (["report", "d.toml"], "d-report.pdf/", "reports.design_report.prepare"),
    (["sweep", "d.toml", *VARY], "d-sweep/sweep.html/", "sweeps.sweep.sweep_design"),
    (["sweep", "d.toml", *VARY], "d-sweep/designs", "sweeps.sweep.sweep_design"),
    (["compare", "d", "scan.obj"], "scan-compared/compare.png/", "measure.compare.compare"),
    (["compare-designs", "d.toml", "d.toml", "-o", "p.html"], "p.html/", "reports.compare_designs.prepare"),
    ([*FIT, "f.toml"], "f.toml/", "fitting.target_files.load_target"),
    ([*FIT, "f.toml"], "f-fit/target.obj/", "fitting.target_files.load_target"),
    (["law", "show"], "paper-law/law.png/", "laws.law.law_figure"),
    (["calibrate", "d.toml"], "d-law.npz/", "laws.law.run_campaign"),
    (["picture", "d", "-o", "p"], "p/d-oblique.png/", "shape.vtu.read_shape"),
]


@pytest.mark.parametrize(("words", "obstacle", "computation"), CASES, ids=lambda value: str(value))
def test_an_obstacle_is_named_before_anything_is_computed(
    words: list[str], obstacle: str, computation: str, folder: Path, monkeypatch: pytest.MonkeyPatch, cli: Cli
) -> None:
    (folder / "scan.obj").write_text("v 0 0 0\n")
    np.save(folder / "t.npy", np.zeros((4, 4)))
    path = folder / obstacle
    path.parent.mkdir(parents=True, exist_ok=True)
    path.mkdir() if obstacle.endswith("/") else path.write_text("mine")
    before = sorted(folder.rglob("*"))

    def compute(*arguments: object, **options: object) -> None:
        raise AssertionError("it computes")

    monkeypatch.setattr(f"asterism.{computation}", compute)
    kind = "folder" if obstacle.endswith("/") else "file"
    assert cli(words).refusal == f"asterism: cannot write {obstacle.rstrip('/')}: a {kind} is in the way"
    assert sorted(folder.rglob("*")) == before


@pytest.mark.usefixtures("blank_pictures")
def test_a_search_beyond_its_budget_ends_with_its_state_and_status_1(
    folder: Path, monkeypatch: pytest.MonkeyPatch, cli: Cli
) -> None:
    monkeypatch.setattr("asterism.discrete.release.continuation.MAX_RELEASE_ITERATIONS", 12)
    done = cli(["simulate", "d.toml", "--starts", "1"])
    assert done.status == 1 and "not an equilibrium: gradient" in done.err
    assert "about 42 vertices, 0.2 GB, 2 s" in done.err
    summary = json.loads((folder / "d" / "summary.json").read_text())
    assert summary["iterations"] == 12 and summary["gradient_norm"] > 0
    assert not summary["converged"] and not summary["is_minimum"]


@pytest.mark.slow
def test_verify_writes_a_report_and_a_table(here: Path, cli: Cli) -> None:
    (here / "d.toml").write_text(SMALL.replace("10.0", "8.0").replace("rings = 0", "rings = 1").replace("4.0", "3.5"))
    (here / "law.npz").write_bytes(law_bytes(plain_law()))
    result = cli(["verify", "d.toml", "--law", "law.npz"]).done
    assert "% of the diameter rms" in result.out and "same form" in result.out
    # what is seen while waiting
    said = ("preview done in", "released from the flat print", "started from the preview", "comparing", "report")
    assert [result.err.index(text) for text in said] == sorted(result.err.index(text) for text in said)
    assert (here / "d-verified" / "report.html").is_file()
    summary = json.loads((here / "d-verified" / "summary.json").read_text())
    assert summary["preview"]["model"] == "preview" and summary["exact"]["is_minimum"]
    assert 0.0 < summary["rms_percent"] < 30.0
    expected, height = (summary[f"expected_{what}_percent"] for what in ("rms", "height"))
    line = next(line for line in result.out.splitlines() if line.startswith("  estimated error      "))
    assert f" {expected:.1f} % of the diameter of " in line and line.endswith(f" ({height:.0f} %)")


# it passes through itself
ROLLED = SMALL.replace("0.4", "0.2").replace("rings = 0", "rings = 2").replace("4.0", "4.3")
ROLLED += '[fabric]\nbending = "paper"\n'


@pytest.fixture
def rolled(here: Path, blank_pictures: None) -> Path:
    (here / "d.toml").write_text(ROLLED)
    return here


@pytest.mark.slow
def test_a_sheet_that_passes_through_itself_is_told(rolled: Path, cli: Cli) -> None:
    result = cli(["simulate", "d.toml", "--starts", "1"]).done
    assert "passes through itself" in result.err and "--contact" in result.err
    summary = json.loads((rolled / "d" / "summary.json").read_text())
    assert summary["self_intersections"] > 0 and summary["self_contact"] is None


@pytest.mark.slow
def test_contact_keeps_it_apart(rolled: Path, cli: Cli) -> None:
    pytest.importorskip("ipctk")
    result = cli(["simulate", "d.toml", "--contact"]).done
    assert "passes through itself" not in result.err
    summary = json.loads((rolled / "d" / "summary.json").read_text())
    assert summary["self_intersections"] == 0 and summary["is_minimum"] and summary["design"]["solver"]["contact"]
    contact = summary["self_contact"]
    assert contact["closest_possible_mm"] < contact["least_distance_mm"] < contact["begins_at_mm"]
    assert contact["pairs"] > 0 and summary["energy_parts_n_mm"]["contact"] > 0.0


def test_without_the_package_a_design_with_contact_is_one_line(rolled: Path, monkeypatch, cli: Cli) -> None:
    monkeypatch.setitem(sys.modules, "ipctk", None)
    (rolled / "d.toml").write_text(ROLLED + "[solver]\ncontact = true\n")
    needed = "asterism: d.toml: solver.contact: needs the package ipctk: pip install ipctk"
    assert cli(["simulate", "d.toml"]).refusal == needed
    assert [file.name for file in rolled.iterdir()] == ["d.toml"]
    # the option overrides the design
    (rolled / "d.toml").write_text(ROLLED.replace("rings = 2", "rings = 0") + "[solver]\ncontact = true\n")
    assert cli(["simulate", "d.toml", "--no-contact"]).done
