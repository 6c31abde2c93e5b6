"""`asterism new`: a design of the gallery."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import Annotated

import typer

from asterism.cli.common.options import output_option
from asterism.cli.common.run import Run, command


@command
def new(
    run: Run,
    name: Annotated[
        str | None,
        typer.Argument(help="Name of the design. Without a name, the command lists all designs of the gallery."),
    ] = None,
    output: Annotated[Path | None, output_option("File of the design (default: NAME.toml).")] = None,
) -> None:
    """Write a design of the gallery to a file that you can change."""
    from asterism.cli.common.mistake import Mistake
    from asterism.results.files import write_file
    from pattern import gallery

    if name is None:
        run.lines(gallery.names())
        return
    if name not in gallery.names():
        raise Mistake(f"NAME: {name!r} is not in the gallery; there are {', '.join(gallery.names())}")
    path = output or Path(f"{name}.toml")
    if path.suffix != ".toml":
        raise Mistake(f"--output: {str(path)!r} must end with .toml")
    content = gallery.path(name).read_bytes()
    if path.exists() and not (path.is_file() and path.read_bytes() == content):
        raise Mistake(f"--output: {str(path)!r} exists and is kept; choose another name")
    write_file(path, content)
    where = quote(str(path))
    run.lines([f"{path}: run  asterism preview {where}  for its shape at once, or  asterism verify {where}"])
