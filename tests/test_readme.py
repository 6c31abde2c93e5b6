"""The documentation: commands exist, designs load, Python runs, links lead somewhere, examples give what they show."""

from __future__ import annotations

import doctest
import importlib
import json
import re
import runpy
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from PIL import Image

import asterism
from asterism import Design, load_design, save_design
from asterism.cli.main import application
from asterism.pattern import gallery
from tests.pattern.drawing.rhino_drawing import Drawing
from tests.test_rooms import FILES

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


def test_commands_start_from_nothing_install_and_run_a_design_of_the_gallery() -> None:
    for name, package in (("run", ".[mkl]"), ("test", ".[test]")):
        assert steps(name)[:2] == [["python3", "-m", "venv", ".venv"], [".venv/bin/pip", "install", package]]
    new, verify = steps("run")[2:]
    assert new[:2] == [".venv/bin/asterism", "new"] and new[2] in gallery.names()
    assert verify[:2] == [".venv/bin/asterism", "verify"] and verify[2] == new[new.index("-o") + 1]
    assert set(re.findall(r"`asterism new ([\w-]+)`", TEXT[ROOT / "README.md"])) <= set(gallery.names())


def test_the_checks_run_what_the_readme_says() -> None:
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    for name in ("run", "test"):
        assert f"{name}=$(python3 .ci/readme.py {name})" in script
        assert f'-c "${name}"' in script
    words = [sys.executable, str(ROOT / ".ci" / "readme.py"), "run"]
    said = subprocess.run(words, capture_output=True, text=True, check=True)
    assert said.stdout.strip() in TEXT[ROOT / "README.md"]


@pytest.mark.parametrize("page", PAGES, ids=[page.name for page in PAGES])
def test_links_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)\s]+)\)", TEXT[page]):
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        assert re.match(r"(https?|mailto):", link) or target.exists(), f"{link} does not exist"
        # headings of the site, some of them generated, are checked when it is built: mkdocs build --strict
        if anchor and ROOT / "docs" not in page.parents:
            assert anchor in anchors(target), f"{target.name} has no heading {anchor}"


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


SHELL_BLOCK = re.compile(r"```(?:sh|console|bash)\n(.*?)```", re.DOTALL)
# `asterism` at the beginning of inline code; a line of a shell block
INLINE = re.compile(r"`(asterism [^`]+)`")
LINE = re.compile(r"(?:^|&& ?)\$? ?(?:\.venv/bin/)?(asterism(?: [^&\n#|>]+)?)", re.MULTILINE)
# options in inline code, alone: they belong to asterism on the pages about its commands
OPTION = re.compile(r"`(--[a-z][a-z-]+)[^`]*`")


def documented() -> Iterator[tuple[str, str, bool]]:
    """Page and line of each command in pages and notebooks, and whether it is whole; others have no arguments."""
    texts = {page.name: text for page, text in TEXT.items()}
    for notebook in sorted((ROOT / "notebooks").glob("*.ipynb")):
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        texts[notebook.name] = "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    for page, text in texts.items():
        for block in SHELL_BLOCK.findall(text):
            yield from ((page, line.strip(), True) for line in LINE.findall(block))
        yield from ((page, line, False) for line in INLINE.findall(SHELL_BLOCK.sub("", text)))


ROOT_COMMAND: Any = typer.main.get_command(application())


def mistakes(line: str, is_whole: bool) -> list[str]:
    """What is wrong with a command line; values are not checked, since they may be placeholders."""
    name, *words = shlex.split(line)
    command = ROOT_COMMAND
    while hasattr(command, "commands") and words and not words[0].startswith("-"):
        word = words.pop(0)
        if word.isupper() and not is_whole:
            return []  # a placeholder for any command
        if word not in command.commands:
            return [f"{word} is no command of {name}"]
        command, name = command.commands[word], f"{name} {word}"
    try:
        given, too_many, _ = command.make_parser(command.context_class(command)).parse_args(words)
    except Exception as error:  # the class is hidden in typer
        return [str(error)]
    needed = [p.name for p in command.params if p.required and is_whole and "help" not in given]
    return [f"{word} is one argument too many" for word in too_many] + [n for n in needed if given.get(n) is None]


def option_names(command: Any = ROOT_COMMAND) -> set[str]:
    """The options of all commands."""
    own = {text for p in command.params for text in (*p.opts, *p.secondary_opts)}
    return own.union(*(option_names(inner) for inner in getattr(command, "commands", {}).values()))


def test_documented_commands_and_options_exist() -> None:
    commands = list(documented())
    assert len([page for page, _, is_whole in commands if is_whole]) > 40
    assert len({line.split()[1] for _, line, _ in commands if " " in line} & set(ROOT_COMMAND.commands)) > 8
    assert [(page, line, wrong) for page, line, is_whole in commands if (wrong := mistakes(line, is_whole))] == []
    known = option_names()
    found = [(page.name, option) for page, text in TEXT.items() for option in OPTION.findall(text)]
    assert found and [(page, option) for page, option in found if option not in known] == []


MODULES = [name for name, file in FILES.items() if ">>> " in file.read_text(encoding="utf-8")]
# examples that take seconds
LONG = {
    *("asterism.exact.spread", "asterism.print.export", "asterism.verification.simulate"),
    *("asterism.fitting.fit", "asterism.fitting.solve_for", "asterism.measure.compare"),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow if name in LONG else ()) for name in MODULES]
)
def test_examples_in_docstrings_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with np.printoptions(precision=4, suppress=True):
        result = doctest.testmod(importlib.import_module(name), optionflags=doctest.ELLIPSIS)
    assert result.attempted > 0 and result.failed == 0
