"""Arguments and options of several commands, and what they stand for."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from asterism.cli.run import Mistake

if TYPE_CHECKING:
    from asterism.pattern.design.design import Design


# units of the numbers in a file, as `asterism.measure.compare.scan.MM`
FileUnit = Literal["mm", "cm", "m", "in", "um"]
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
PrinterName = Annotated[str, typer.Option(help="Name of a printer (see asterism printers), or its file.")]
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
ToleranceOption = Annotated[
    float | None,
    typer.Option(
        help="Refine the mesh until the error of the shape is within this part of the diameter, in percent, instead of "
        "the value or the edge length in the design; not for the paper's hinges."
    ),
]
EdgeOption = Annotated[
    float | None, typer.Option(help="Edge length of the exact mesh in mm, instead of the value in the design.")
]
BackendOption = Annotated[str, typer.Option(help="Linear solver: auto, pardiso, cholmod, superlu or amg.")]


def output_option(help: str) -> Any:
    """-o, for the annotation of a parameter that is a path, or None without the option."""
    return typer.Option("-o", "--output", help=help, parser=nonempty_path)


def nonempty_path(text: str) -> Path:
    """Refuse an empty name: it would be the working directory, and usually comes from a variable that is not set."""
    if not str(text):
        raise typer.BadParameter("must not be empty")
    return Path(text)


def check_workers(jobs: int | None, dask: str | None) -> None:
    """Refuse --jobs beside --dask."""
    if jobs is not None and dask is not None:
        raise Mistake("--jobs: applies to processes of this machine, not to --dask")


def group(help: str, *commands: Callable[..., int]) -> typer.Typer:
    """Commands below one name."""
    app = typer.Typer(help=help, invoke_without_command=True)
    names = [each.__name__ for each in commands]

    @app.callback()
    def needs_a_command(context: typer.Context) -> None:
        if context.invoked_subcommand is None:
            raise Mistake(f"{context.info_name}: needs a command: {', '.join(names[:-1])} or {names[-1]}")

    for each in commands:
        app.command()(each)
    return app


def results_folder(design: Path, output: Path | None, default: Path, *names: str) -> Path:
    """The folder given by the user, or the default one, for files of these names (or summary.json and its like).

    Raises OutputError: the folder cannot be written to, holds files of another origin, or the results would replace the
    design.
    """
    from asterism.results.files import SUMMARY_FILE, OutputError, check_writable

    directory = output or default
    for name in names or (SUMMARY_FILE,):
        with suppress(OSError):  # of a file that is not there
            if (directory / name).samefile(design):
                raise OutputError(
                    f"--output: {str(directory)!r} is where {design.name} is and stays; choose another name"
                )
    check_writable(directory, *names)
    return directory


# entries of the design in whose place options stand
OVERRIDES = {
    "edge": "mesh.edge_mm",
    "tolerance": "mesh.tolerance_percent",
    "contact": "solver.contact",
}


def with_overrides(design: Design, **options: Any) -> Design:
    """The design with the entries given on the command line: options of `OVERRIDES`; None for no change.

    Raises DesignError: a value is not allowed; the message names the option.
    """
    from asterism.pattern.design.design import Design
    from asterism.pattern.design.entries import with_entries
    from asterism.pattern.design.errors import DesignError
    from asterism.pattern.layout.build import layout

    data = design.to_dict()
    given = {OVERRIDES[option]: value for option, value in options.items() if value is not None}
    if not given:
        return design
    refines = "mesh.tolerance_percent" in given
    if refines:
        if "mesh.edge_mm" in given:
            raise Mistake("--tolerance: goes without --edge: the mesh is refined until the error is within it")
        data["mesh"].pop("edge_mm", None)
    try:
        new = Design.from_dict(with_entries(data, given))
        if refines and new.mesh_edge_mm is not None:
            plates = "plate and consistent have one; --edge sets the mesh of others"
            raise Mistake(f"--tolerance: not for fabric.bending = {new.fabric.bending!r}: {plates}")
        layout(new)
    except DesignError as error:
        for option, field in OVERRIDES.items():
            if field == error.field and field in given:
                raise DesignError(f"--{option}", error.allowed, error.value) from None
        raise
    return new
