"""The files of results: which there are, and those of a shape.

A shape's are summary.json, shape.vtu, rods.vtu, shape.png, and a pair for every further minimum.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from asterism.draw.picture import draw_shape
from asterism.results.files import BESIDE_SUMMARY, LAST, holds_result, staged
from asterism.results.vtu import write_rods_vtu, write_shape_vtu
from asterism.shape.shape import Shape
from pattern.design.arguments import check_kind

VERIFICATION = "verification"  # the `model` of a summary that is of two shapes


@contextmanager
def staged_result(directory: str | Path) -> Iterator[Path]:
    """As `staged`, for files that belong to a summary.json: those of an earlier one, of whatever kind, go away.

    A folder without a summary.json holds no result: nothing goes away there, whatever it is called.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    with staged(directory, stale=BESIDE_SUMMARY if holds_result(directory) else None) as folder:
        yield folder


def write_results(shape: Shape, directory: str | Path) -> list[str]:
    """Write the files of a shape into a directory, all or none; returns their names.

    Raises
    ------
    OutputError
        They cannot be written there.
    """
    check_kind(shape, Shape, "simulate and preview make them")
    with staged_result(directory) as folder:
        write_shape_vtu(shape, folder / "shape.vtu")
        write_rods_vtu(shape, folder / "rods.vtu")
        draw_shape(shape, shape.summary["design"]["name"], folder / "shape.png")
        for number, other in enumerate(shape.others, 2):
            write_shape_vtu(other, folder / f"minimum-{number}.vtu")
            draw_shape(other, f"{shape.summary['design']['name']}, minimum {number}", folder / f"minimum-{number}.png")
        (folder / LAST).write_text(json.dumps(shape.summary.to_json(), indent=2, allow_nan=False) + "\n")
        return sorted(file.name for file in folder.iterdir())
