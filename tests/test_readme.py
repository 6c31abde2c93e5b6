"""The documentation: its commands are those that are tested, designs load, Python runs, links lead somewhere."""

from __future__ import annotations

import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

import asterism
from asterism.pattern import gallery
from asterism.pattern.design.design import Design, save_design
from asterism.pattern.layout.build import load_design
from tests.pattern.drawing.rhino_drawing import Drawing

ROOT = Path(__file__).parents[1]
# a drawing of two layers: a closed rim, and a rib across it
LEAF = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"
 width="60mm" height="40mm" viewBox="0 0 60 40">
<g inkscape:groupmode="layer" inkscape:label="rim" fill="none" stroke="black" stroke-width="1.2">
<circle cx="30" cy="20" r="18"/></g>
<g inkscape:groupmode="layer" inkscape:label="ribs" fill="none" stroke="black" stroke-width="1.2">
<path d="M 12 20 H 48"/></g>
</svg>"""
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]
TEXT = {page: page.read_text(encoding="utf-8") for page in PAGES}

LINKS = [(page, link) for page in PAGES for link in re.findall(r"\]\(([^)\s]+)\)", TEXT[page])]
DESIGNS = [(page, block) for page in PAGES for block in re.findall(r"```toml\n(.*?)```", TEXT[page], re.DOTALL)]
BLOCKS = [(page, block) for page in PAGES for block in re.findall(r"```python\n(.*?)```", TEXT[page], re.DOTALL)]
# those of the shell's pages have tests of their own
PYTHON = [(page, block) for page, block in BLOCKS if "import asterism\n" in block]

EXAMPLES = sorted((ROOT / "docs" / "examples").glob("*.py"))

command = runpy.run_path(str(ROOT / ".ci" / "readme.py"))["command"]


def steps(name: str) -> list[list[str]]:
    """The commands of a line of the README, word by word."""
    return [shlex.split(step) for step in command(name).split("&&")]


def anchors(page: Path) -> set[str]:
    """Names that a link may point to: headings as GitHub spells them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def whole_designs(block: str) -> list[str]:
    """A block with a name is a design; tables without one are part of a design; lines are ways to write a size."""
    if re.search("^name = ", block, re.MULTILINE):
        return [block]
    border = "[border]\nrings = 3\n"
    if re.search(r"^\[", block, re.MULTILINE):
        stars = "" if "[stars]" in block else "[stars]\nlength_mm = 10.0\n"
        return [stars + ("" if "[border]" in block else border) + block]
    return [f"{border}[stars]\n{line}\n" for line in block.splitlines()]


@pytest.mark.parametrize("name", ["run", "test"])
def test_commands_start_from_nothing_and_install(name: str) -> None:
    first, second, *_ = steps(name)
    assert first == ["python3", "-m", "venv", ".venv"]
    assert second[:2] == [".venv/bin/pip", "install"]
    assert second[2:] == ([".[mkl]"] if name == "run" else [".[test]"])


def test_the_main_job_runs_a_design_of_the_gallery() -> None:
    new, verify = steps("run")[2:]
    assert new[:2] == [".venv/bin/asterism", "new"]
    assert new[2] in gallery.names()
    assert verify[:2] == [".venv/bin/asterism", "verify"]
    assert verify[2] == new[new.index("-o") + 1]


def test_the_checks_run_what_the_readme_says() -> None:
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    for name in ("run", "test"):
        assert f"{name}=$(python3 .ci/readme.py {name})" in script
        assert f'-c "${name}"' in script
    said = subprocess.run(
        [sys.executable, str(ROOT / ".ci" / "readme.py"), "run"], capture_output=True, text=True, check=True
    )
    assert said.stdout.strip() in TEXT[ROOT / "README.md"]


@pytest.mark.parametrize("name", re.findall(r"`asterism new ([\w-]+)`", TEXT[ROOT / "README.md"]))
def test_designs_named_are_in_the_gallery(name: str) -> None:
    assert name in gallery.names()


@pytest.mark.parametrize(("page", "link"), LINKS, ids=[f"{page.name}-{link}" for page, link in LINKS])
def test_links_lead_somewhere(page: Path, link: str) -> None:
    if re.match(r"(https?|mailto):", link):
        return
    path, _, anchor = link.partition("#")
    target = page.parent / path if path else page
    assert target.exists(), f"{page.name} links to {link}, which does not exist"
    if ROOT / "docs" in page.parents:
        return  # headings of the site, some of them generated, are checked when it is built: mkdocs build --strict
    assert not anchor or anchor in anchors(target), f"{target.name} has no heading {anchor}"


@pytest.mark.parametrize(("page", "block"), DESIGNS, ids=[f"{page.name}-{i}" for i, (page, _) in enumerate(DESIGNS)])
def test_designs_in_the_text_load(page: Path, block: str, tmp_path: Path) -> None:
    Image.new("L", (4, 3)).save(tmp_path / "sizes.png")
    (tmp_path / "leaf.svg").write_text(LEAF, encoding="utf-8")
    if "roof.3dm" in block:
        roof = Drawing()
        roof.polyline([(0, 0), (200, 0), (200, 150), (0, 150), (0, 0)], "sheet::cut")
        roof.polyline([(100, 40), (100, 110)], "ribs")
        roof.saved(tmp_path, "roof.3dm")
    for text in whole_designs(block):
        file = tmp_path / "design.toml"
        file.write_text(text, encoding="utf-8")
        load_design(file)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("page", "block"), [pytest.param(*each, id=f"{each[0].name}-{i}") for i, each in enumerate(PYTHON)]
)
def test_python_in_the_text_runs(page: Path, block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With a small design in place of the gallery's dome, in a folder that holds it as a file."""
    small = gallery.load("dome").to_dict() | {"border": {"rings": 1}, "mesh": {"edge_mm": 5.0}}
    small["stars"] |= {"length_mm": 8.0}
    design = Design.from_dict(small)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("asterism.draw.render.SUPERSAMPLING", 1)
    monkeypatch.setattr(asterism, "new", lambda name: design if name == "dome" else gallery.load(name), raising=False)
    save_design(design, tmp_path / "dome.toml")
    exec(compile(block, page.name, "exec"), {})


@pytest.mark.slow
@pytest.mark.parametrize("script", EXAMPLES, ids=[file.stem for file in EXAMPLES])
def test_examples_run(script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = script.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 25
    (picture,) = re.findall(r"^Picture: (\S+)$", text, re.MULTILINE)
    assert (ROOT / "docs" / "pictures" / picture).exists()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("asterism.draw.render.SUPERSAMPLING", 1)  # as in the notebooks' test
    runpy.run_path(str(script))
