"""Meshes of the sheet in space and of solids: OBJ, STL and GLB.

OBJ holds sheet, stars and needles as groups, which other programs read as layers: the sheet as triangles, arms and
needles as lines. OBJ and STL have no unit: slicers assume mm, other programs ask for it. The unit of GLB, the binary
form of glTF 2.0, is the metre, and y points up.
"""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.print.formats.registry import export_format
from asterism.print.needles import needles
from asterism.process.settings import ExportSettings
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
    upper = shape.at_edges(printed)
    lower = upper.copy()
    # needles end so far below the lowest point of the sheet
    lower[:, 2] = shape.positions[:, 2].min() - 5.0
    return np.stack([upper, lower], axis=1)


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


@export_format("GLB", ".glb", "shape")
def write_glb(path: Path, shape: Shape, name: str) -> None:
    """Write the sheet, of which both sides are visible."""
    import trimesh  # slow to import

    colour = {"baseColorFactor": [0.96, 0.90, 0.78, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9}
    matte = trimesh.visual.material.PBRMaterial(**colour, doubleSided=True)
    visual = trimesh.visual.TextureVisuals(material=matte)
    # z upwards becomes y, and mm become metres
    points = 1e-3 * shape.positions @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    mesh = trimesh.Trimesh(points, shape.triangles, visual=visual, process=False)
    scene = trimesh.Scene()
    scene.add_geometry(mesh, node_name=name, geom_name=name)
    path.write_bytes(trimesh.exchange.gltf.export_glb(scene, include_normals=True))
