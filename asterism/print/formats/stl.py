"""STL, binary: triangles in mm. The format has no unit; slicers assume mm."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.print.formats.registry import export_format


def write_stl(path: Path, points: Floats, triangles: Ints) -> None:
    """Write triangles (m, 3) over points (n, 3) mm."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    # a triangle without area has the normal 0, and programs compute it from the corners
    normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
    mesh = meshio.Mesh(points, [("triangle", triangles)], cell_data={"facet_normals": [normals]})
    # meshio's general function prints messages
    meshio.stl.write(str(path), mesh, binary=True)


export_format("STL", ".stl", "solid")(lambda path, solid: write_stl(path, solid.points, solid.triangles))
# the format does not store the name of a shape
export_format("STL", ".stl", "shape")(lambda path, shape, name: write_stl(path, shape.positions, shape.triangles))
