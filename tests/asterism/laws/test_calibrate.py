"""Calibration as a user meets it: a command makes a law of stars, of others or of a design; another shows it."""

from __future__ import annotations

import io
import json
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from asterism import Design, Preview, load_law
from asterism.homogenize.campaign.workers import CampaignProgress
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import law_bytes, law_digest
from asterism.homogenize.law.plan import CellTask, SampleRecord
from asterism.homogenize.law.star_law import StarLaw
from asterism.laws.law import directions_warning
from asterism.process.progress import CountLine
from tests.asterism.commands import Cli, interrupted
from tests.asterism.previews.laws import plain_law
from tests.asterism.verification.printed import design
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
    shown = cli(["law", "show", "m.npz", "-o", "shown"]).done
    assert "kappa" in shown.out and "stretch 1.35" in shown.out
    with Image.open(place / "shown" / "law.png") as image:
        assert image.width > 1000 and np.asarray(image).std() > 5
    summary = json.loads((place / "shown" / "summary.json").read_text())
    assert summary["cells"] == 6 and summary["residuals"]["1.35"]["held_out"]["cells"]


@pytest.mark.slow
def test_the_law_that_comes_with_the_package(here: Path, cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("asterism.laws.law.law_figure", lambda law: Figure())  # it takes seconds
    assert "stretch 1.75" in cli(["law", "show"]).done.out and (here / "paper-law" / "law.png").exists()
    law = load_law()
    assert law.made["command"] == "asterism calibrate" and law.stretches == (1.35, 1.75)
    for table in law.tables:
        values = table(np.zeros(1), 0.3, 1.2).value
        assert abs(values["lam"][0] * table.stretch - 1) < 1e-8 and values["kappa"][0] == 0


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


@pytest.mark.slow
def test_interrupted_and_resumed(place: Path, here: Path, cli: Cli) -> None:
    """With one process and fresh cells: bit for bit the law of two processes at once."""
    (here / "m.toml").write_text(PLAN)
    samples, words = here / "cells", ["calibrate", "m.toml", "--jobs", "1"]
    lines = interrupted(words, here, lambda said: any(samples.glob("*.json")))
    assert lines[-1].startswith(f"asterism: interrupted; finished cells are in {samples}")
    assert not (here / "m.npz").exists()
    kept = len(list(samples.glob("*.json")))
    result = cli(words)
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


# its law takes a quarter of a minute; such laws, and previews with them, have quick tests beside their code
LEFT = "which previews model in part"


@pytest.fixture(scope="module")
def five(tmp_path_factory: pytest.TempPathFactory) -> tuple[StarLaw, str]:
    """A law of five-armed stars, whose longest arms overlap, and what its command printed."""
    folder: Path = tmp_path_factory.mktemp("five")
    plan = PLAN.replace("[3.0, 10.0]", "[7.0, 12.0]").replace("held_out = 1", "held_out = 0")
    plan = plan.replace("[0.3, 0.5]", "[0.3, 0.4]").replace("edge_mm = 4.0", "edge_mm = 2.2")
    (folder / "five.toml").write_text(plan + "[lattice]\narms = 5\n")
    result = run("calibrate", "five.toml", "--jobs", "2", cwd=folder)
    assert result.returncode == 0, result.stderr
    law = load_law(folder / "five.npz")
    assert isinstance(law, StarLaw)
    return law, result.stdout


def sheet(arms: int, thickness: float = 0.4) -> Design:
    return design(lattice={"arms": arms}, stars={"length_mm": 6.0, "thickness_mm": thickness})


@pytest.mark.slow
def test_the_law_says_what_it_leaves_out(five: tuple[StarLaw, str]) -> None:
    law, printed = five
    line = directions_warning(law)
    assert line is not None and LEFT in line and "% at most" in line
    assert line in printed
    samples = [cell["sample"] for cell in law.samples if cell["sample"] and cell["length_mm"] > 0]
    assert len(samples) == 2
    assert all(len(sample["natural_curvature"]) == 6 for sample in samples)
    values = law.at(1.35)(np.array([0.0, 4.0, 7.0]), 0.3, 1.2).value
    assert values["lam"][0] * 1.35 == pytest.approx(1.0, abs=1e-8)
    assert values["kappa"][0] == 0.0 < values["kappa"][1:].min()
    np.testing.assert_array_equal(values["c3"], 0.0)
    # arms that overlap are cells without an answer
    overlapping = [cell for cell in law.samples if cell["length_mm"] == 12.0]
    assert len(overlapping) == 2 and all("shorten or turn them" in cell["problem"] for cell in overlapping)
    assert "cells without a law" in printed and not law.at(1.35)(10.0, 0.3, 1.2).inside[0]


@pytest.mark.slow
def test_a_sheet_of_five_arms_bends_differently_in_each_direction(five: tuple[StarLaw, str]) -> None:
    with pytest.raises(LawError, match=r"lattice\.arms = 3: the law is for another lattice, of 5"):
        Preview(sheet(3), five[0])
    preview = Preview(sheet(5), five[0])
    bending = np.asarray(preview.shell.density.stiffness)[..., 3:5, 3:5]
    assert np.abs(bending[..., 0, 0] / bending[..., 1, 1] - 1.0).max() > 0.01
    assert preview.equilibrium.is_minimum
    edited, fresh = preview.update(sheet(5, 0.45)), Preview(sheet(5, 0.45), five[0]).shape()
    assert edited.height_mm == pytest.approx(fresh.height_mm, rel=0.01)


DESIGN = """
name = "thick"
[fabric]
thickness_mm = {thickness}
bending = "{bending}"
[lattice]
spacing_mm = 17.320508
[stars]
length_mm = 6.0
thickness_mm = 0.5
[border]
rings = 1
"""


def write(path: Path, thickness: float = 2.0, bending: str = "paper") -> None:
    path.write_text(DESIGN.format(thickness=thickness, bending=bending))


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_a_preview_learns_its_fabric_and_a_calibration_finds_the_cells(here: Path, cli: Cli) -> None:
    write(here / "my sheet.toml")
    assert "learning this fabric: cell 1 of 2" in cli(["preview", "my sheet.toml"]).done.err
    summary = json.loads((here / "my sheet" / "summary.json").read_text())
    assert summary["law_in_range"] and summary["law"]["material"] == "thick" and summary["is_minimum"]
    made = cli(["calibrate", "my sheet.toml"]).done
    assert made.err.splitlines() == ["  2 of 2 cells"]
    then = shlex.split(made.out.splitlines()[-1].removeprefix("now run  asterism "))
    assert cli(then).done
    again = json.loads((here / "my sheet" / "summary.json").read_text())
    assert again["height_mm"] == pytest.approx(summary["height_mm"], rel=1e-9)
    # the law's own files are beside the results, not among them
    assert cli(["law", "show", "my sheet-law.npz"]).done
    shutil.copy(here / "my sheet-law.npz", here / "my sheet.npz")
    assert cli(["law", "show", "my sheet.npz"]).done
    assert (here / "my sheet" / "shape.vtu").exists()
    (here / "mine").mkdir()
    (here / "mine" / "summary.json").write_text('{"mine": 1}')
    assert "was not written by asterism" in cli(["law", "show", "my sheet.npz", "-o", "mine"]).refusal
    assert (here / "my sheet-law" / "law.png").exists() and not (here / "my sheet" / "law.png").exists()
    assert load_law(here / "my sheet-law.npz").made["command"] == "asterism calibrate my sheet.toml"
    gone = cli(["law", "forget"])
    assert gone.out.strip() == f"2 cells removed from {here / 'cells'}" and not list((here / "cells").iterdir())


def test_a_law_for_something_else_is_named(here: Path, cli: Cli) -> None:
    (here / "foreign.npz").write_bytes(law_bytes(plain_law(1.2)))
    write(here / "d.toml", 2.0)
    refusal = cli(["preview", "d.toml", "--law", "foreign.npz"]).refusal
    assert "asterism: d.toml: fabric." in refusal
    assert refusal.endswith("(foreign.npz); without it the preview makes its own law")


@pytest.mark.parametrize("word", ["preview", "verify", "calibrate"])
def test_a_fabric_that_does_not_bend_has_no_law(word: str, here: Path, cli: Cli) -> None:
    write(here / "d.toml", thickness=0.8, bending="none")
    refused = cli([word, "d.toml"])
    line = refused.err.splitlines()[-1]
    assert refused.status == 2 and line.startswith("asterism: d.toml: fabric.bending = ") and "has no law" in line
    assert "calibrate" not in line and "asterism simulate" in line
    assert not list(here.glob("*.npz"))
