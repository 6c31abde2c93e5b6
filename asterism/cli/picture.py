"""`asterism picture`: pictures of results, of several at one scale."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from asterism.cli.common.options import output_option, two_sizes
from asterism.cli.common.run import Mistake, Run, command


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
    size: Annotated[str, typer.Option(help="Width and height in pixels.")] = "1600x1000",
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
    from asterism.shape.read_shape import read_shape
    from asterism.shape.release_picture import release_gif

    width, height = two_sizes(size, "--size")
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
    shapes = {result: read_shape(result) for result in files}
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
