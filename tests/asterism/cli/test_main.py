"""The command line as a user meets it: exit status, one line for a mistake, nothing half-written."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.asterism.commands import SIGN_OF_LIFE, command

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


def run(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "asterism", *words], cwd=cwd, capture_output=True, text=True, timeout=300
    )


def mistake(result: subprocess.CompletedProcess[str]) -> str:
    """The one line of a refused command."""
    assert result.returncode == 2, result.stderr
    assert "Traceback" not in result.stderr
    lines = [line for line in result.stderr.splitlines() if not line.startswith(SIGN_OF_LIFE)]
    assert len(lines) == 1 and lines[0].startswith("asterism: "), result.stderr
    return lines[0]


@pytest.mark.slow
def test_new_lists_and_writes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert "tube" in run("new", cwd=tmp_path).stdout.split()
    drawn = command(["new", "leaf"], capsys, monkeypatch)
    assert drawn.status == 0 and "asterism simulate leaf.toml" in drawn.out and "preview" not in drawn.out
    repeating = command(["new", "skew-grid"], capsys, monkeypatch)
    assert repeating.status == 0 and "asterism preview skew-grid.toml" in repeating.out
    assert command(["new", "tube"], capsys, monkeypatch).status == 0
    assert command(["new", "tube"], capsys, monkeypatch).status == 0  # nothing is lost by writing the same again
    assert command(["new", "tube", "-o", "missing/folder/tube.toml"], capsys, monkeypatch).status == 0
    assert (tmp_path / "missing" / "folder" / "tube.toml").read_bytes() == (tmp_path / "tube.toml").read_bytes()
    (tmp_path / "tube.toml").write_text("mine")
    assert "exists" in mistake(run("new", "tube", cwd=tmp_path))
    assert (tmp_path / "tube.toml").read_text() == "mine"
    for words, expected in ((["spaceship", "-o", "x.toml"], "gallery"), (["tube", "-o", "x.png"], ".toml")):
        refused = command(["new", *words], capsys, monkeypatch)
        assert refused.status == 2 and expected in refused.line


@pytest.mark.slow
def test_simulate_writes_results_and_a_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    result = command(["simulate", "d.toml", "-o", "out"], capsys, monkeypatch)
    assert result.status == 0, result.err
    assert "stable" in result.out and "released" in result.err
    files = sorted(file.name for file in (tmp_path / "out").iterdir())
    assert files == ["rods.vtu", "shape.obj", "shape.png", "shape.vtu", "summary.json"]
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["is_minimum"]
    assert "asks for" not in result.err


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
@pytest.mark.parametrize("name", ["preview", "simulate", "verify"])
def test_a_quiet_command_prints_its_result_and_no_progress(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "d.toml").write_text(SMALL)
    done = command([name, str(tmp_path / "d.toml"), "--quiet"], capsys, monkeypatch)
    assert done.status == 0 and "height" in done.out
    assert all(line.startswith("asterism: ") for line in done.err.splitlines())


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_stars_that_do_not_stay_where_they_were_sent_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """This star starts down, and cannot stay there."""
    (tmp_path / "d.toml").write_text(SMALL.replace("10.0", "5.0\nbranch = 'down'"))
    done = command(["simulate", str(tmp_path / "d.toml")], capsys, monkeypatch)
    assert done.status == 0 and "1 of 1 up" in done.out
    assert done.err.endswith("1 of 1 stars of the exact shape are not on the side that the design asks for: star 0\n")
    # on a fabric that was not stretched stars stay flat, and are on no side
    (tmp_path / "f.toml").write_text("[fabric]\nstretch = 1.0\n" + SMALL)
    done = command(["simulate", str(tmp_path / "f.toml")], capsys, monkeypatch)
    assert done.status == 0 and "asks for" not in done.err


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["simulate"], "design"),
        (["simulate", "none.toml"], "none.toml"),
        (["simulate", "d.toml", "--edge", "-1"], "--edge"),
        (["simulate", "d.toml", "--edge", "nan"], "--edge"),
        (["simulate", "d.toml", "--edge", "two"], "--edge"),
        (["simulate", "d.toml", "--starts", "0"], "--starts"),
        (["simulate", "d.toml", "--backend", "magic"], "backend"),
        (["simulate", "d.toml", "-o", "d.toml"], "d.toml"),
        (["simulate", "d.toml", "--colour", "red"], "--colour"),
        (["simulat", "d.toml"], "simulat"),
        (["strips"], "strips: needs a command: new, fit, weigh or overhang"),
        (["law"], "law: needs a command: show or forget"),
    ],
)
def test_mistakes_are_one_line(
    words: list[str], expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    refused = command(words, capsys, monkeypatch)
    assert refused.status == 2 and expected in refused.line
    assert [file.name for file in tmp_path.iterdir()] == ["d.toml"]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
@pytest.mark.parametrize(
    "words",
    [
        ["preview", "pipe.toml"],
        ["export", "pipe.toml"],
        ["preview", "d.toml", "--material", "pipe.toml"],
        ["preview", "d.toml", "--law", "pipe.npz"],
        ["law", "show", "pipe.npz"],
        ["strips", "fit", "pipe.csv"],
        ["export", "d.toml", "--printer", "pipe.toml"],
        ["compare", "pipe.vtu", "pipe.obj"],
    ],
)
def test_a_pipe_is_refused_at_once(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """To read it would wait until somebody writes into it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    for name in ("pipe.toml", "pipe.npz", "pipe.csv", "pipe.vtu", "pipe.obj"):
        os.mkfifo(tmp_path / name)
    refused = command(words, capsys, monkeypatch)
    assert refused.status == 2 and "pipe." in refused.line
    assert len(list(tmp_path.iterdir())) == 6


def test_a_link_to_nothing_is_refused_before_anything_is_computed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    (tmp_path / "link").symlink_to("nowhere")
    refused = command(["preview", "d.toml", "-o", "link"], capsys, monkeypatch)
    assert refused.status == 2 and refused.line == "asterism: cannot write link: a file is in the way"


@pytest.mark.parametrize("name", ["preview", "simulate", "verify", "report"])
def test_a_sheet_that_would_fall_is_named_by_its_file(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL + "\n[gravity]\non = true\n[fabric]\nmodulus_mpa = 7.0\n")
    refused = command([name, "d.toml"], capsys, monkeypatch)
    assert refused.status == 2 and "d.toml: gravity.on = True: needs [[pins]]" in refused.line
    assert [file.name for file in tmp_path.iterdir()] == ["d.toml"]


@pytest.mark.slow
def test_a_mistake_in_a_design_is_all_that_a_program_prints(tmp_path: Path) -> None:
    """Whatever it loads before."""
    (tmp_path / "d.toml").write_text(SMALL)
    assert "--edge" in mistake(run("simulate", "d.toml", "--edge", "-1", cwd=tmp_path))
    assert [file.name for file in tmp_path.iterdir()] == ["d.toml"]


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_interrupt_leaves_nothing(number: int, tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(SMALL.replace("rings = 0", "rings = 3").replace("4.0", "1.5"))
    words = [sys.executable, "-m", "asterism", "simulate", "d.toml", "-o", "out"]
    with open(tmp_path / "errors", "w") as errors:
        process = subprocess.Popen(words, cwd=tmp_path, stderr=errors)
    while "iteration" not in (tmp_path / "errors").read_text():
        time.sleep(0.05)
        assert process.poll() is None
    process.send_signal(number)
    assert process.wait(timeout=60) == 130
    assert (tmp_path / "errors").read_text().splitlines()[-1] == "asterism: interrupted"
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
@pytest.mark.parametrize(
    ("package", "how"),
    [("typer", RAISED), ("asterism.equilibrium.errors", RAISED), ("scipy", CHANGED)],
)
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
    for words in (["new"], ["--help"], ["simulate", "d.toml", "-o", "out"]):
        with open("/dev/full", "w") as full:
            program = [sys.executable, "-m", "asterism", *words]
            ended = subprocess.run(program, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, timeout=300)
        assert ended.returncode == 1
        assert ended.stderr.splitlines()[-1] == "asterism: cannot print: no space left on device"
        assert "Traceback" not in ended.stderr and "Exception" not in ended.stderr
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["is_minimum"]  # and results stay


def test_names_that_are_too_long_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    name = 300 * "x"
    commands = [[word, "d.toml", "-o", name] for word in ("simulate", "preview", "verify", "export")]
    commands += [["new", "dome", "-o", f"{name}.toml"], ["report", "d.toml", "-o", f"{name}.pdf"]]
    commands += [["calibrate", "d.toml", "-o", f"{name}.npz"], ["simulate", f"{name}.toml"]]
    for words in commands:
        refused = command(words, capsys, monkeypatch)
        assert refused.status == 2 and name in refused.line and "too long" in refused.line
    assert [file.name for file in tmp_path.iterdir()] == ["d.toml"]


def test_an_empty_output_is_not_the_working_directory(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "d.toml").write_text(SMALL)
    with_design = ("simulate", "preview", "verify", "export", "report", "calibrate")
    for words in [*([word, "d.toml"] for word in with_design), ["new", "dome"], ["law", "show"], ["strips", "new"]]:
        refused = command([*words, "-o", ""], capsys, monkeypatch)
        assert refused.status == 2 and "--output" in refused.line and "must not be empty" in refused.line
    assert [file.name for file in tmp_path.iterdir()] == ["d.toml"]


@pytest.mark.usefixtures("blank_pictures")
def test_no_equilibrium_is_status_one(tmp_path: Path, capsys, monkeypatch: pytest.MonkeyPatch) -> None:
    """A state that is not converged is written, said to be none, and ends with status 1."""
    monkeypatch.setattr("asterism.discrete.release.continuation.MAX_ITERATIONS", 1)
    (tmp_path / "d.toml").write_text(SMALL)
    stopped = command(["simulate", str(tmp_path / "d.toml"), "-o", str(tmp_path / "out")], capsys, monkeypatch)
    assert stopped.status == 1
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert not summary["converged"] and not summary["is_minimum"]
