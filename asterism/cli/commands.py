"""The commands."""

from __future__ import annotations

import sys
from pathlib import Path
from shlex import quote
from typing import Annotated, Any

import typer

from asterism import __version__
from asterism.cli.compare import compare
from asterism.cli.export import export, printers
from asterism.cli.options import Backend, Contact, DesignFile, MaterialFile, output_option
from asterism.cli.preview import preview
from asterism.cli.report import report
from asterism.cli.strips import app as strips
from asterism.cli.verify import verify
from asterism.process.stopping import stop

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)

# what the option parser raises for a wrong command line; some versions of typer bring their own click
UsageError: type[Exception] = typer.BadParameter.__mro__[1]

law = typer.Typer(help="What a law of the sheet says.", no_args_is_help=True)
app.add_typer(law, name="law")
app.command()(preview)
app.command()(verify)
app.command()(export)
app.command()(compare)
app.command()(report)
app.command()(printers)
app.add_typer(strips, name="strips")


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """The shape of plastic stars printed on stretched fabric."""
    if version:
        typer.echo(__version__)
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def new(
    name: Annotated[str | None, typer.Argument(help="A design of the gallery; none: list them.")] = None,
    output: Annotated[Path | None, output_option("The file to write (NAME.toml).")] = None,
) -> None:
    """Write a design of the gallery to a file, to be looked at and changed."""
    from asterism.results.files import write_file
    from pattern import gallery

    if name is None:
        typer.echo("\n".join(gallery.names()))
        return
    if name not in gallery.names():
        raise Mistake(f"NAME: {name!r} is not in the gallery; there are {', '.join(gallery.names())}")
    path = output or Path(f"{name}.toml")
    if path.suffix != ".toml":
        raise Mistake(f"--output: {str(path)!r} must end with .toml")
    content = gallery.path(name).read_bytes()
    if path.exists() and not (path.is_file() and path.read_bytes() == content):
        raise Mistake(f"--output: {str(path)!r} exists already and is left as it is; choose another name")
    write_file(path, content)
    where = quote(str(path))
    typer.echo(f"{path}: now run  asterism preview {where}  for its shape at once, or  asterism verify {where}")


@app.command()
def simulate(
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    edge: Annotated[float | None, typer.Option(help="Edge length of the mesh in mm, in place of the design's.")] = None,
    start: Annotated[str | None, typer.Option(help="bump or flat, in place of the design's.")] = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the start's noise, in place of the design's.")] = None,
    starts: Annotated[
        int,
        typer.Option(
            min=1,
            max=1000,
            help="Starts to look for other minima; the result is the lowest whose stars are all on their side.",
        ),
    ] = 1,
    fabric_bending: Annotated[
        str | None, typer.Option(help="paper, consistent or none, in place of the design's.")
    ] = None,
    contact: Contact = None,
    material: MaterialFile = None,
    backend: Backend = "auto",
) -> None:
    """The exact model: the shape of a design, certified to be an equilibrium.

    Writes summary.json, shape.vtu, rods.vtu and shape.png, and minimum-2.vtu, minimum-2.png, ... if --starts has found
    other minima. Exit status 1 if what was found is not an equilibrium.
    """
    from asterism.cli.overrides import changed
    from asterism.cli.progress import Progress
    from asterism.exact.simulation import simulate as run
    from asterism.laws.material import read_design
    from asterism.process.compiling import told_of_compiling
    from asterism.results.files import LAST, check_kept, check_writable
    from asterism.results.write_results import write_results

    plan = changed(
        read_design(design, material),
        {
            "--edge": ("mesh.edge_mm", edge),
            "--start": ("solver.start", start),
            "--seed": ("solver.seed", seed),
            "--fabric-bending": ("fabric.bending", fabric_bending),
            "--contact": ("solver.contact", contact),
        },
    )
    directory = output or design.with_suffix("")
    check_kept(design, directory, LAST)
    check_writable(directory)
    progress = Progress()
    try:
        with told_of_compiling(progress.say):
            shape = run(plan, backend, progress.report, progress.say, starts)
    finally:
        progress.close()
    files = write_results(shape, directory)
    _table(dict(shape.summary))
    typer.echo(f"{directory}: {', '.join(files)}")
    for line in shape.summary["warnings"]:
        print(f"asterism: {line}", file=sys.stderr)
    if not shape.summary["is_minimum"]:
        raise typer.Exit(1)


def _table(s: dict[str, Any]) -> None:
    from asterism.shape.mesh_error import in_words
    from asterism.shape.tube import rolled

    extent = " x ".join(f"{size:.1f}" for size in s["extent_mm"])
    rows = {
        "stars": f"{s['stars_up']} of {s['stars_total']} up",
        "height": f"{s['height_mm']:.2f} mm",
        "extent": f"{extent} mm",
        "contraction": "-" if s["contraction"] is None else f"{s['contraction']:.4f}",
        "rolled about": rolled(s),
        "energy": f"{s['energy_n_mm']:.4f} N mm",
        "gradient": f"{s['gradient_norm']:.1e} N",
        "smallest eigenvalue": f"{s['smallest_eigenvalue']:.3e} N/mm",
        "equilibrium": "stable" if s["is_minimum"] else "no",
        "mesh": f"{s['vertices']} vertices, {s['mesh']}",
        "mesh error": in_words(s),
        "work": f"{s['iterations']} iterations, {s['factorisations']} factorisations, {s['wall_s']:.1f} s",
    }
    if s["starts"] > 1:
        if lost := s["starts_lost"]:
            rows["starts"] = f"{s['starts']}, of which {lost} came to no equilibrium"
        rows |= {f"minimum {number}": _minimum(m) for number, m in enumerate(s["minima"], 1)}
    for name, value in rows.items():
        typer.echo(f"  {name:<20} {value}")


def _minimum(m: dict[str, Any]) -> str:
    axis = "" if m["roll_axis_deg"] is None else f", rolled about {m['roll_axis_deg']:.0f} deg"
    away = f"{m['distance_percent']:.1f} % away, " if m["distance_percent"] >= 0.05 else ""
    return f"{m['energy_n_mm']:.4f} N mm, {m['stars_up']} up{axis}; {away}{m['starts']} starts"


class Mistake(Exception):
    """What the user typed cannot be done; one line."""


@app.command()
def calibrate(
    file: Annotated[
        Path | None,
        typer.Argument(help="A material and plan, or a design, for its stars alone; none: the paper's material."),
    ] = None,
    output: Annotated[
        Path | None, output_option("The law's file (MATERIAL.npz, DESIGN-law.npz, DESIGN-law-MATERIAL.npz).")
    ] = None,
    material: MaterialFile = None,
    jobs: Annotated[int | None, typer.Option(min=1, max=1000, help="Processes (one per core).")] = None,
    dask: Annotated[str | None, typer.Option(help="Address of a Dask scheduler to use in their place.")] = None,
) -> None:
    """The law of the sheet for a material, from many unit cells; for a design's own stars, from a few.

    Goes on where an earlier run has stopped: finished cells are kept beside the law, in LAW.samples. Exit status 1 if
    too many cells have no answer.
    """
    from asterism.laws import calibrate as command
    from asterism.laws.own_law import is_design, law_path, material_of
    from pattern.design.errors import DesignError

    path = law_path(file, output, material)
    if path.suffix != ".npz":
        raise Mistake(f"--output: {str(path)!r} must end with .npz")
    if jobs is not None and dask is not None:
        raise Mistake("--jobs: goes with processes of this machine, not with --dask")
    made_for = material_of(file, material)
    line = " ".join(["asterism calibrate", *([file.name] if file else [])])
    line += f" --material {material.name}" if material else ""
    try:
        law = command.calibrate(made_for, path, jobs or command.default_jobs(), dask, line)
    except KeyboardInterrupt:
        folder = command.samples_folder(path)
        if not folder.exists():
            raise
        stop(f"interrupted; finished cells are in {folder}, the same command goes on from there", 130)
    except DesignError as error:
        raise error.within(material or file or "") from None
    typer.echo("\n".join(command.report_lines(law, path)))
    if is_design(file):
        other = f" --material {quote(str(material))}" if material else ""
        typer.echo(f"now run  asterism preview {quote(str(file))}{other} --law {quote(str(path))}")


@law.command("show")
def law_show(
    path: Annotated[Path | None, typer.Argument(help="The law's file (.npz); none: the paper's material.")] = None,
    output: Annotated[Path | None, output_option("Directory (the law's name).")] = None,
) -> None:
    """A law as a table, and as a picture in law.png, with its errors."""
    from asterism.laws.show import show

    typer.echo("\n".join(show(path, output)))
