"""The documentation's commands exist: each `asterism ...` line of README, pages, notebooks and messages parses."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import typer

from asterism.cli.app import app

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]
NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SHELL_BLOCK = re.compile(r"```(?:sh|console|bash)\n(.*?)```", re.DOTALL)
# `asterism` at the beginning of inline code; a line of a shell block
INLINE = re.compile(r"`(asterism [^`]+)`")
LINE = re.compile(r"(?:^|&& ?)\$? ?(?:\.venv/bin/)?(asterism(?: [^&\n#|>]+)?)", re.MULTILINE)
# options in inline code, alone: they belong to asterism on the pages about its commands
OPTION = re.compile(r"`(--[a-z][a-z-]+)[^`]*`")


@dataclass(frozen=True)
class Documented:
    """A command line in the documentation; an inline one may leave out its arguments."""

    place: str
    line: str
    is_whole: bool


def texts() -> Iterator[tuple[Path, str]]:
    """Each page, and the markdown cells of each notebook."""
    for page in PAGES:
        yield page, page.read_text(encoding="utf-8")
    for notebook in NOTEBOOKS:
        cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
        yield notebook, "\n\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")


def documented() -> Iterator[Documented]:
    """All command lines, with the page that holds each."""
    for page, text in texts():
        for block in SHELL_BLOCK.findall(text):
            yield from (Documented(page.name, line.strip(), True) for line in LINE.findall(block))
        yield from (Documented(page.name, line, False) for line in INLINE.findall(SHELL_BLOCK.sub("", text)))


COMMANDS = list(documented())
ROOT_COMMAND: Any = typer.main.get_command(app)


def mistakes(line: str, is_whole: bool) -> list[str]:
    """What is wrong with a command line; values are not checked, since they may be placeholders."""
    name, *words = shlex.split(line)
    command, wrong = ROOT_COMMAND, []
    while hasattr(command, "commands") and words and not words[0].startswith("-"):
        word = words.pop(0)
        if word.isupper() and not is_whole:
            return []  # a placeholder for any command
        if word not in command.commands:
            return [f"{word} is no command of {name}"]
        command, name = command.commands[word], f"{name} {word}"
    options = {text: p for p in command.params for text in (*p.opts, *p.secondary_opts) if text.startswith("-")}
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    given = 0
    while words:
        word = words.pop(0)
        if not word.startswith("-"):
            given += 1
            if given > len(arguments) and all(p.nargs > 0 for p in arguments):
                wrong.append(f"{word} is one argument too many")
            continue
        text, has_value, _ = word.partition("=")
        if text == "--help":
            continue
        if text not in options:
            wrong.append(f"{text} is no option of {name}")
        elif not options[text].is_flag and not has_value:
            if len(words) < options[text].nargs:
                wrong.append(f"{text} has no value")
            words[: options[text].nargs] = []
    if is_whole:
        wrong += [f"{p.name.upper()} is missing" for p in arguments[given:] if p.required]
    return wrong


def option_names(command: Any = ROOT_COMMAND) -> set[str]:
    """The options of all commands."""
    own = {text for p in command.params for text in (*p.opts, *p.secondary_opts)}
    return own.union(*(option_names(inner) for inner in getattr(command, "commands", {}).values()))


@pytest.mark.parametrize("entry", COMMANDS, ids=[f"{entry.place}: {entry.line}" for entry in COMMANDS])
def test_each_documented_command_line_parses(entry: Documented) -> None:
    assert mistakes(entry.line, entry.is_whole) == []


def test_the_documentation_was_searched() -> None:
    assert len([entry for entry in COMMANDS if entry.is_whole]) > 40
    assert len({entry.line.split()[1] for entry in COMMANDS if " " in entry.line} & set(ROOT_COMMAND.commands)) > 8


@pytest.mark.parametrize("page", PAGES, ids=[page.name for page in PAGES])
def test_options_in_the_text_exist(page: Path) -> None:
    known = option_names()
    assert [option for option in OPTION.findall(page.read_text(encoding="utf-8")) if option not in known] == []


@pytest.mark.parametrize(
    ("line", "mistake"),
    [
        ("asterism previw a.toml", "previw is no command of asterism"),
        ("asterism strips neu", "neu is no command of asterism strips"),
        ("asterism preview a.toml --edges 2", "--edges is no option of asterism preview"),
        ("asterism verify a.toml --edge", "--edge has no value"),
        ("asterism preview", "DESIGN is missing"),
        ("asterism preview a.toml b.toml", "b.toml is one argument too many"),
    ],
)
def test_mistakes_are_found(line: str, mistake: str) -> None:
    assert mistake in mistakes(line, True)


def test_inline_commands_may_leave_out_their_arguments() -> None:
    assert mistakes("asterism simulate", False) == []
    assert mistakes("asterism COMMAND --help", False) == []
