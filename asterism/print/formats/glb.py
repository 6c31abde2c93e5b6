"""GLB, the binary form of glTF 2.0. The unit is the metre and y points up."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from asterism.print.formats.registry import export_format
from asterism.shape.shape import Shape


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
