"""The files of a shape: numbers, sheet, rods, pictures, and two files for each further minimum."""

from __future__ import annotations

from pathlib import Path

from asterism.draw.picture import draw_shape
from asterism.pattern.design.errors import check_type
from asterism.print.formats.meshes import write_shape_obj
from asterism.results.files import SUMMARY_FILE, staged_result
from asterism.results.records.exact import ExactRecord
from asterism.shape.shape import Shape
from asterism.shape.vtu import write_rods_vtu, write_shape_vtu


def write_results(shape: Shape, directory: str | Path) -> list[str]:
    """Write the files of a shape into a directory; they appear together, or none of them if writing fails.

    Returns
    -------
    Names of the files.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_type(shape, Shape, "simulate and preview make them")
    with staged_result(directory) as folder:
        write_shape_files(shape, folder)
        draw_shape(shape, shape.summary["design"]["name"], folder / "shape.png")
        for number, other in enumerate(shape.others, 2):
            write_shape_vtu(other, folder / f"minimum-{number}.vtu")
            draw_shape(other, f"{shape.summary['design']['name']}, minimum {number}", folder / f"minimum-{number}.png")
        if "peel_n_per_mm" in shape.rod_fields and shape.layout is not None:
            from asterism.reports.plots import bond_map  # charts take time to import

            (folder / "bond.png").write_bytes(bond_map(shape, shape.layout))
        if isinstance(shape.summary, ExactRecord) and "spread" in shape.summary:
            from asterism.reports.plots import draw_spread  # its charts take time to import

            draw_spread(shape.summary.spread, shape.summary["design"]["name"], folder / "spread.png")
        (folder / SUMMARY_FILE).write_text(shape.summary.json_text())
        return sorted(file.name for file in folder.iterdir())


def write_shape_files(shape: Shape, folder: Path) -> None:
    """Write sheet and rods of a shape for other programs."""
    write_shape_vtu(shape, folder / "shape.vtu")
    write_rods_vtu(shape, folder / "rods.vtu")
    write_shape_obj(folder / "shape.obj", shape, shape.summary["design"]["name"])
