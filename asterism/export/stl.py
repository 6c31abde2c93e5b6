"""STL, binary: triangles in mm. The format has no unit; slicers take the numbers for mm."""

from __future__ import annotations

from pathlib import Path

import meshio

from pattern.layout import Floats, Ints


def write(path: Path, points: Floats, triangles: Ints) -> None:
    """Write triangles (m, 3) over points (n, 3) mm."""
    # the format's own writer: the general one reports its choices on the terminal
    meshio.stl.write(str(path), meshio.Mesh(points, [("triangle", triangles)]), binary=True)
