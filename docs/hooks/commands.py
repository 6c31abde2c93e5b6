"""Writes the reference of the command line from the commands themselves.

The page `reference/commands.md` holds a line `<!-- commands -->`, which is replaced when the site is built.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

MARK = "<!-- commands -->"


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """The page with a section for every command."""
    return markdown.replace(MARK, "\n".join(sections())) if MARK in markdown else markdown


def sections() -> Iterator[str]:
    """Markdown for all commands, in the order of the help."""
    from asterism.cli.main import application

    group: Any = typer.main.get_command(application())
    for name, command in sorted(group.commands.items()):
        if hasattr(command, "commands"):
            for second, inner in sorted(command.commands.items()):
                yield from _section(f"{name} {second}", inner)
        else:
            yield from _section(name, command)


def _section(name: str, command: Any) -> Iterator[str]:
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option" and not getattr(p, "hidden", False)]
    words = [p.name.upper() if p.required else f"[{p.name.upper()}]" for p in arguments]
    yield f"## {name}\n\n{_with_code(command.help)}\n\n```console\nasterism {' '.join([name, *words])} [OPTIONS]\n```\n"
    yield "| argument or option | meaning |\n|---|---|"
    for p, word in zip(arguments, words, strict=True):
        yield f"| `{word}` | {_meaning(p)} |"
    for p in options:
        yield f"| {_names(p)} | {_meaning(p)} |"
    yield ""


def _names(option: Any) -> str:
    return ", ".join(f"`{name}`" for name in (*option.opts, *option.secondary_opts))


def _with_code(text: str) -> str:
    """A text whose options, such as --edge, are set as code."""
    return re.sub(r"(?<![\w`-])(--[a-z][a-z-]*)", r"`\1`", text)


def _meaning(parameter: Any) -> str:
    text = _with_code(parameter.help or "").replace("|", "\\|")
    default = parameter.default
    if default not in (None, False, True, (), []) and not callable(default):
        text += f" Default: {getattr(default, 'value', default)}."
    return text
