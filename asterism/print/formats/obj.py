"""OBJ: triangles in mm. The format has no unit: programs ask for it, or use their own."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from asterism.print.formats.registry import export_format
from asterism.shape.shape import Shape
from equilibrium.arrays import Floats, Ints


def write_obj(path: Path, points: Floats, triangles: Ints) -> None:
    """Write triangles (m, 3) over points (n, 3) mm."""
    with path.open("w", encoding="ascii", newline="\n") as stream:
        stream.write("# unit: mm\n")
        np.savetxt(stream, points, "v %.6f %.6f %.6f")
        np.savetxt(stream, triangles + 1, "f %d %d %d")


@export_format("OBJ", ".obj", "shape")
def write_shape_obj(path: Path, shape: Shape, name: str) -> None:
    """Write the sheet in space; the format does not store its name."""
    write_obj(path, shape.positions, shape.triangles)
