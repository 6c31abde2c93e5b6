"""The option -o of every command that writes files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer


def output_option(help: str) -> Any:
    """For the annotation of a parameter that is a path, or None without the option."""
    return typer.Option("-o", "--output", help=help, parser=path)


def path(text: str) -> Path:
    """An empty name would be the working directory: most likely a variable that is not set."""
    if not str(text):
        raise typer.BadParameter("must not be empty")
    return Path(text)
