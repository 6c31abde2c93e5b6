"""OBJ: sheet, stars and needles as groups, which other programs read as layers, in mm.

The format has no unit: programs ask for it, or use their own. The sheet is triangles; arms and needles are lines.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import off_sheet_mm
from asterism.print.formats.registry import export_format
from asterism.print.needles import needles
from asterism.print.settings import ExportSettings
from asterism.shape.shape import Shape


@export_format("OBJ", ".obj", "shape")
def write_shape_obj(path: Path, shape: Shape, name: str) -> None:
    """Write a sheet in space with the groups `sheet`, `stars` and `needles`; a group without content is left out.

    Needles stand along z, at the places of `needles` on supported edges. The name of the sheet is a comment.
    """
    ends = needle_ends(shape)
    with path.open("w", encoding="utf-8", newline="\n") as stream:
        stream.write(f"# {' '.join(name.split())}\n# unit: mm\n")
        np.savetxt(stream, shape.positions, "v %.6f %.6f %.6f")
        np.savetxt(stream, ends.reshape(-1, 3), "v %.6f %.6f %.6f")
        stream.write("g sheet\n")
        np.savetxt(stream, shape.triangles + 1, "f %d %d %d")
        if shape.rods:
            stream.write("g stars\n")
            stream.writelines(f"l {' '.join(str(vertex + 1) for vertex in rod)}\n" for rod in shape.rods)
        if len(ends):
            stream.write("g needles\n")
            first = len(shape.positions) + 1 + 2 * np.arange(len(ends))
            np.savetxt(stream, np.column_stack([first, first + 1]), "l %d %d")


def needle_ends(shape: Shape) -> Floats:
    """(n, 2, 3) mm, upper and lower end of each needle; empty without supports or without a layout."""
    plan = shape.layout
    if plan is None or not plan.pins:
        return np.empty((0, 2, 3))
    printed = np.array([needle.printed for needle in needles(plan, ExportSettings().needle_spacing_mm)])
    upper = shape.at(printed, off_sheet_mm(plan, len(shape.printed)))
    lower = upper.copy()
    # needles end so far below the lowest point of the sheet
    lower[:, 2] = shape.positions[:, 2].min() - 5.0
    return np.stack([upper, lower], axis=1)
