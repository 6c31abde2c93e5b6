"""What others look at: `asterism report`, `compare-designs`, `picture`, and the servers `studio` and `hops`."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

import asterism
from asterism.cli.command import (
    DesignFile,
    LawFile,
    MaterialFile,
    Mistake,
    PrinterName,
    Run,
    command,
    output_option,
    two_sizes,
)


@command
def report(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("File of the page (default: DESIGN-report.pdf).")] = None,
    results: Annotated[
        Path | None,
        typer.Option(
            help="Results of simulate, preview or verify (default: those beside the design, or a new preview)."
        ),
    ] = None,
    printer: PrinterName = "ultimaker2",
    material: MaterialFile = None,
    law: LawFile = None,
) -> None:
    """Write one page about a design as PDF: parameters, picture, layout, needles, accuracy, material."""
    from asterism.laws.from_files import read_design

    plan = read_design(design, material, run.warn)  # before slower imports: many mistakes are here

    from asterism.laws.from_files import law_from_file

    path = output or design.with_name(f"{design.stem}-report.pdf")
    written = asterism.report(
        plan,
        path,
        results=results,
        beside=design.with_suffix(""),
        printer=printer,
        law=law_from_file(plan, law, design, material) if law else None,
        say=run.warn,
    )
    run.lines([f"{path}: layout 1:{written.scale:g}; shape: {written.source}"])


@command
def compare_designs(
    run: Run,
    designs: Annotated[list[Path], typer.Argument(help="Design files (.toml or .json), 2 to 12.")],
    output: Annotated[Path | None, output_option("File of the page (default: A-B-C.html beside the first).")] = None,
    exact: Annotated[bool, typer.Option("--exact", help="Compute exact shapes, not previews.")] = False,
    printer: PrinterName = "ultimaker2",
    law: LawFile = None,
    material: MaterialFile = None,
) -> None:
    """Write one page with several designs: pictures at one scale, sizes, print times, estimated errors, differences.

    Differences are those from the first design. A design without a shape is on the page with the reason.
    """
    from asterism.exact.cost import exact_cost
    from asterism.laws.from_files import read_design
    from asterism.reports.compare_designs import MAX_COMPARED_DESIGNS

    if not 2 <= len(designs) <= MAX_COMPARED_DESIGNS:
        raise Mistake(f"must be 2 to {MAX_COMPARED_DESIGNS} design files, not {len(designs)}")
    if exact and law is not None:
        raise Mistake("--law: is for previews, not with --exact")
    plans = [read_design(file, material, run.warn) for file in designs]
    stems = [file.stem for file in designs]
    path = output or designs[0].with_name("-".join(dict.fromkeys(stems)) + ".html")
    own_law = asterism.load_law(law) if law else None
    if exact:
        run.cost(exact_cost(max(plans, key=lambda plan: exact_cost(plan).seconds), shapes=len(plans)))
    with run.computing():
        written = asterism.compare_designs(
            plans,
            path,
            names=stems,
            exact=exact,
            printer=printer,
            law=own_law,
            say=run.say,
        )
    rows = {"": [each.name for each in written.designs]} | {row.label: row.texts for row in written.numbers}
    run.table({label: "  ".join(f"{text:>20}" for text in texts) for label, texts in rows.items()}, width=50)
    count = len(written.differences)
    run.lines([f"{path}: {count} {'entry differs' if count == 1 else 'entries differ'}"])
    run.warn(*(f"{each.name}: {each.problem}" for each in written.designs if each.problem))


@command
def picture(
    run: Run,
    results: Annotated[
        list[Path], typer.Argument(help="Folders of simulate, preview, verify or fit, or files shape.vtu.")
    ],
    output: Annotated[Path | None, output_option("Folder of the pictures (default: that of each result).")] = None,
    view: Annotated[
        Literal["oblique", "above", "front", "side"], typer.Option(help="In perspective, or a drawing to scale.")
    ] = "oblique",
    size: Annotated[Any, typer.Option(help="Width and height in pixels.", parser=two_sizes)] = "1600x1000",
    scale: Annotated[
        float | None, typer.Option(help="Pixels per mm (default: the largest at which all sheets fit).")
    ] = None,
    plain: Annotated[bool, typer.Option("--plain", help="Draw the sheet alone, without title and numbers.")] = False,
    release: Annotated[
        bool, typer.Option("--release", help="Draw the release from flat print to shape as FOLDER-release.gif.")
    ] = False,
) -> None:
    """Draw results as FOLDER-VIEW.png beside their folders, all at one scale."""
    from io import BytesIO

    from asterism.draw.picture import check_picture, fitting_scale, view_image
    from asterism.results.files import check_writable, write_file
    from asterism.shape.release_picture import release_gif

    width, height = size
    pixels = (int(width), int(height)) if (width, height) == (width // 1, height // 1) else (0, 0)
    try:
        check_picture(view, pixels, scale)
    except ValueError as error:
        raise Mistake(f"--{error}") from None
    if release and scale is not None:
        raise Mistake("--release: a release has the largest scale at which the sheet fits; leave out --scale")
    ending = "release.gif" if release else f"{view}.png"
    files = {result: _place(result, output) / f"{_name(result)}-{ending}" for result in results}
    if len(set(files.values())) < len(set(results)):
        raise Mistake("--output: two results have the same name; draw them into different folders")
    for file in files.values():
        check_writable(file.parent, file.name)
    shapes = {result: asterism.read_shape(result) for result in files}
    with run.computing():
        chosen = fitting_scale(list(shapes.values()), view, pixels, plain) if scale is None else scale
        for result, shape in shapes.items():
            if release:
                write_file(files[result], release_gif(shape, view, pixels, plain, _name(result)))
                run.lines([str(files[result])])
                continue
            stream = BytesIO()
            view_image(shape, view, pixels, chosen, plain, _name(result)).save(stream, format="png")
            write_file(files[result], stream.getvalue())
            run.lines([f"{files[result]}: {chosen:.4g} pixels per mm"])


def _name(result: Path) -> str:
    """The name of a result's folder, or of a file without its ending."""
    absolute = result.resolve()
    return absolute.stem if absolute.is_file() else absolute.name


def _place(result: Path, output: Path | None) -> Path:
    if output is not None:
        return output
    # a dot or two have no name of their own
    return result.parent if result.name.strip(".") else result.resolve().parent


@command
def studio(
    run: Run,
    design: Annotated[
        Path | None, typer.Argument(help="Design file (.toml or .json). Without a file, the page shows the gallery.")
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the page; 0 chooses a free port.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")] = True,
    listen: Annotated[
        str,
        typer.Option(
            help="Address of this machine. With another address than 127.0.0.1, other machines can open the page."
        ),
    ] = "127.0.0.1",
) -> None:
    """Draw stars on a page in the browser, and see the shape of the sheet at once."""
    from asterism.studio.child import ENGINE, Child

    # the engine takes longest to load, so it starts first
    engine = Child(ENGINE)

    def say(line: str) -> None:
        run.hand_over()
        run.lines([line])

    # a terminal that goes away ends the studio as `kill` does: unsaved work is kept
    if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:
        signal.signal(signal.SIGHUP, lambda *_: signal.raise_signal(signal.SIGTERM))
    try:
        from asterism.studio.server import run_studio

        run_studio(design, port=port, listen=listen, opens_browser=browser, say=say, engine=engine)
    finally:
        engine.process.kill()


@command
def hops(
    run: Run,
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port of the server; 0 chooses a free port.")] = 5017,
    folder: Annotated[Path, typer.Option(help="Folder below which prints are written.")] = Path("."),
    key: Annotated[
        str | None, typer.Option(envvar="ASTERISM_HOPS_KEY", help="Key that Hops must send, as in its settings.")
    ] = None,
    patience: Annotated[
        float, typer.Option(min=1, max=86400, help="Longest estimated time of an exact shape in seconds.")
    ] = 100.0,
) -> None:
    """Serve components for Grasshopper to this machine: sites, sheet, rods, exact, fit, print."""
    if not folder.is_dir():
        raise Mistake(f"--folder {folder}: is no folder")

    from asterism.hops.server import run_hops

    def say(line: str) -> None:
        run.hand_over()
        run.lines([line])

    run_hops(folder.absolute(), port=port, key=key or None, patience_s=patience, say=say)
