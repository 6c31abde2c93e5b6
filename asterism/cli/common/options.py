"""Arguments and options of several commands."""

from __future__ import annotations

import re
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from asterism.cli.common.mistake import Mistake


class FileUnit(StrEnum):
    """Units of the numbers in a file, as `asterism.measure.compare.units.MM`."""

    mm = "mm"
    cm = "cm"
    m = "m"
    inches = "in"
    um = "um"


DesignFile = Annotated[Path, typer.Argument(help="Design file (.toml or .json).")]
MaterialFile = Annotated[
    Path | None,
    typer.Option(
        help="Name (see asterism materials) or file of a material, in place of the design's fabric and plastic."
    ),
]
LawFile = Annotated[
    Path | None, typer.Option(help="File of the law (.npz; default: that of the design, or of the paper's material).")
]
Processes = Annotated[
    int | None, typer.Option("--jobs", min=1, max=1000, help="Number of processes (default: one per core).")
]
DaskAddress = Annotated[
    str | None, typer.Option("--dask", help="Address of a Dask scheduler, instead of processes on this machine.")
]
Contact = Annotated[
    bool | None,
    typer.Option("--contact/--no-contact", help="Prevent the sheet from passing through itself (requires ipctk)."),
]
BackendOption = Annotated[str, typer.Option(help="Linear solver: auto, pardiso, cholmod, superlu or amg.")]


def output_option(help: str) -> Any:
    """-o, for the annotation of a parameter that is a path, or None without the option."""
    return typer.Option("-o", "--output", help=help, parser=nonempty_path)


def two_sizes(text: str, option: str) -> tuple[float, float]:
    """Two sizes from a text such as `300x250`; one number is both.

    Raises
    ------
    Mistake
        These are not one or two numbers; the message names the option.
    """
    words = re.split("[x×]", text.lower())
    try:
        sizes = [float(word) for word in words]
    except ValueError:
        sizes = []
    if len(sizes) not in (1, 2):
        raise Mistake(f"{option}: must be width x depth, such as 300x250, not {text!r}")
    return sizes[0], sizes[-1]


def nonempty_path(text: str) -> Path:
    """Refuse an empty name: it would be the working directory, and usually comes from a variable that is not set."""
    if not str(text):
        raise typer.BadParameter("must not be empty")
    return Path(text)
