"""`asterism new`: a template, a drawn pattern, or a design of the gallery."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import output_option
from asterism.cli.common.run import Mistake, Run, command
from asterism.process.environment import quoted


@command
def new(
    run: Run,
    name: Annotated[
        str | None,
        typer.Argument(help="Name of a template or a design. Without a name, the command lists all of them."),
    ] = None,
    output: Annotated[Path | None, output_option("File of the design (default: NAME.toml).")] = None,
) -> None:
    """Write a template, a design of the paper's figures, or a drawn pattern, to a file that you can change."""
    from asterism.pattern import gallery
    from asterism.results.files import write_file

    if name is None:
        run.lines(["templates:"])
        run.table({name: gallery.words(name) for name in gallery.template_names()}, width=24)
        run.lines(["figures of the paper:"])
        run.table({name: gallery.words(name) for name in gallery.names()}, width=24)
        run.lines(["drawn patterns:"])
        run.table({name: gallery.words(name) for name in gallery.pattern_names()}, width=24)
        return
    known = [*gallery.template_names(), *gallery.names(), *gallery.pattern_names()]
    if name not in known:
        raise Mistake(f"NAME: {name!r} is not in the gallery; there are {', '.join(known)}")
    path = output or Path(f"{name}.toml")
    if path.suffix != ".toml":
        raise Mistake(f"--output: {str(path)!r} must end with .toml")
    content = gallery.path(name).read_bytes()
    if path.exists() and not (path.is_file() and path.read_bytes() == content):
        raise Mistake(f"--output: {str(path)!r} exists and is kept; choose another name")
    write_file(path, content)
    where = quoted(path)
    if name in gallery.pattern_names() and "motif" not in tomllib.loads(content.decode())["rods"]:
        run.lines(
            [f"{path}: run  asterism simulate {where}  for its shape, or  asterism export {where}  for the print"]
        )
        return
    run.lines([f"{path}: run  asterism preview {where}  for its shape at once, or  asterism verify {where}"])
