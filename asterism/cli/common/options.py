"""Arguments and options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

DesignFile = Annotated[Path, typer.Argument(help="The design file (.toml or .json).")]
MaterialFile = Annotated[
    Path | None, typer.Option(help="A material's file: its fabric and plastic in place of the design's.")
]
LawFile = Annotated[Path | None, typer.Option(help="The law's file (.npz); none: the paper's material.")]
Contact = Annotated[
    bool | None,
    typer.Option("--contact/--no-contact", help="Keep the sheet from passing through itself (needs ipctk)."),
]
BackendOption = Annotated[str, typer.Option(help="Linear solver: auto, pardiso, cholmod, superlu or amg.")]


def output_option(help: str) -> Any:
    """-o, for the annotation of a parameter that is a path, or None without the option."""
    return typer.Option("-o", "--output", help=help, parser=nonempty_path)


def nonempty_path(text: str) -> Path:
    """An empty name would be the working directory: most likely a variable that is not set."""
    if not str(text):
        raise typer.BadParameter("must not be empty")
    return Path(text)
