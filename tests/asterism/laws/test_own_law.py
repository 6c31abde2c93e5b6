"""A design of another material: the refusal names the command that makes its law, and the command does."""

from __future__ import annotations

import json
import shlex
import shutil
from pathlib import Path

import pytest

from asterism.homogenize.law.law_file import law_bytes, load_law
from tests.asterism.commands import command
from tests.asterism.previews.laws import plain_law

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


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(path: Path, thickness: float = 2.0, bending: str = "paper") -> None:
    path.write_text(DESIGN.format(thickness=thickness, bending=bending))


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_from_the_refusal_to_the_preview(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write(folder / "my sheet.toml")
    for word in ("preview", "verify"):
        refused = command([word, "my sheet.toml"], capsys, monkeypatch)
        assert refused.status == 2 and "my sheet.toml: fabric.thickness_mm = 2.0: the law is for" in refused.line
    words = shlex.split(refused.line[refused.line.index("asterism calibrate") :])
    words = words[1 : words.index("makes")]
    assert words == ["calibrate", "my sheet.toml"] and refused.line.endswith("--law 'my sheet-law.npz'")
    made = command([*words, "--jobs", "1"], capsys, monkeypatch)
    assert made.status == 0 and "2 of 2 cells" in made.err
    then = shlex.split(made.out.splitlines()[-1].removeprefix("now run  asterism "))
    assert command(then, capsys, monkeypatch).status == 0
    summary = json.loads((folder / "my sheet" / "summary.json").read_text())
    assert summary["law_in_range"] and summary["law"]["material"] == "thick" and summary["is_minimum"]
    # the law's own files are beside the results, not among them
    assert command(["law", "show", "my sheet-law.npz"], capsys, monkeypatch).status == 0
    shutil.copy(folder / "my sheet-law.npz", folder / "my sheet.npz")
    assert command(["law", "show", "my sheet.npz"], capsys, monkeypatch).status == 0
    assert (folder / "my sheet" / "shape.vtu").exists()
    (folder / "mine").mkdir()
    (folder / "mine" / "summary.json").write_text('{"mine": 1}')
    refused = command(["law", "show", "my sheet.npz", "-o", "mine"], capsys, monkeypatch)
    assert refused.status == 2 and "was not written by asterism" in refused.line
    assert (folder / "my sheet-law" / "law.png").exists() and not (folder / "my sheet" / "law.png").exists()
    # finished cells are taken again
    again = command([*words, "-o", "my sheet-law.npz"], capsys, monkeypatch)
    assert again.status == 0 and again.err.splitlines() == ["  2 of 2 cells"]
    assert load_law(folder / "my sheet-law.npz").made["command"] == "asterism calibrate my sheet.toml"


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_another_material_is_part_of_the_command(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write(folder / "d.toml", thickness=0.8)
    (folder / "my m.toml").write_text("[plastic]\nmodulus_ratio = 100000\n")
    refused = command(["preview", "d.toml", "--material", "my m.toml"], capsys, monkeypatch)
    assert "; asterism calibrate d.toml --material 'my m.toml' makes its law" in refused.line
    assert refused.line.endswith("for --law 'd-law-my m.npz'")
    (folder / "d-law.npz").write_text("the law of the design's own material")
    made = command(["calibrate", "d.toml", "--material", "my m.toml", "--jobs", "1"], capsys, monkeypatch)
    then = made.out.splitlines()[-1].removeprefix("now run  asterism ")
    assert then == "preview d.toml --material 'my m.toml' --law 'd-law-my m.npz'"
    assert command(shlex.split(then), capsys, monkeypatch).status == 0
    assert (folder / "d-law.npz").read_text() == "the law of the design's own material"
    assert (folder / "d-law-my m.samples").is_dir() and not (folder / "d-law.samples").exists()


def test_a_law_for_something_else_is_named(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And so is the package's own, where that one would do."""
    (folder / "foreign.npz").write_bytes(law_bytes(plain_law(1.2)))
    advice = "; without --law the package's own is taken"
    for thickness, papers in ((0.8, True), (2.0, False)):
        write(folder / "d.toml", thickness)
        refused = command(["preview", "d.toml", "--law", "foreign.npz"], capsys, monkeypatch)
        assert refused.status == 2 and "asterism: d.toml: fabric." in refused.line and "(foreign.npz)" in refused.line
        assert (advice in refused.line) == papers
        assert refused.line.endswith("for --law d-law.npz")


def test_a_stretch_the_law_does_not_have(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "d.toml").write_text(
        DESIGN.format(thickness=0.8, bending="paper").replace("[fabric]", "[fabric]\nstretch = 2.5")
    )
    refused = command(["preview", "d.toml"], capsys, monkeypatch)
    assert "d.toml: fabric.stretch = 2.5: the law was made for 1.35, 1.75" in refused.line
    assert "asterism calibrate d.toml makes its law" in refused.line


def test_an_own_star_at_a_finer_spacing_has_one_verdict(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither each star nor each law that does not serve has a line."""
    table = DESIGN.replace("17.320508", "12.0").replace("rings = 1", "rings = 3")
    (folder / "fine.toml").write_text(table.format(thickness=0.8, bending="paper").replace("= 0.5", "= 0.9"))
    refused = command(["preview", "fine.toml"], capsys, monkeypatch)
    assert refused.status == 2 and refused.out == ""
    assert "spacing_mm = 12.0" in refused.line and "does not serve for 37 of 37 stars" in refused.line


@pytest.mark.parametrize(("thickness", "is_advised"), [(0.5, False), (0.6, True)])
def test_no_law_is_advised_whose_cells_buckle(
    thickness: float,
    is_advised: bool,
    folder: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With edges of 1.15 mm, fabric below 0.52 mm buckles between the stars, as the mesh lets it."""
    (folder / "d.toml").write_text(
        DESIGN.format(thickness=thickness, bending="paper").replace("[fabric]", "[fabric]\nstretch = 2.5")
    )
    refused = command(["preview", "d.toml"], capsys, monkeypatch)
    assert ("asterism calibrate d.toml makes its law" in refused.line) == is_advised
    assert refused.line.endswith("plan.edge_mm of at most 1.11") != is_advised


@pytest.mark.parametrize("word", ["preview", "verify", "calibrate"])
def test_a_fabric_that_does_not_bend_has_no_law(
    word: str, folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    write(folder / "d.toml", thickness=0.8, bending="none")
    refused = command([word, "d.toml"], capsys, monkeypatch)
    assert refused.status == 2 and "fabric.bending" in refused.line and "has no law" in refused.line
    assert "asterism: d.toml: fabric.bending = " in refused.line
    assert "calibrate" not in refused.line and "asterism simulate" in refused.line
    assert not list(folder.glob("*.npz"))


def test_mistakes(folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    write(folder / "d.toml")
    (folder / "m.toml").write_text('[fabric]\nbending = "none"\n')
    (folder / "both.toml").write_text(DESIGN.format(thickness=2.0, bending="paper") + "[plan]\nheld_out = 0\n")
    for words, said in (
        (["calibrate", "m.toml"], "fabric.bending"),
        (["calibrate", "m.toml", "--material", "m.toml"], "--material = 'm.toml': goes with a design"),
        (["calibrate", "d.toml", "--material", "m.toml"], "fabric.bending"),
        (["calibrate", "both.toml"], "both.toml: plan"),
    ):
        refused = command(words, capsys, monkeypatch)
        assert refused.status == 2 and said in refused.line, refused.line
    assert not list(folder.glob("*.samples"))
