"""GLB, the binary form of glTF 2.0. The unit is the metre and y points up.

This module needs the standard library only: a file with one surface is a header, a small JSON and three arrays.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np

from asterism.pattern.geometry.normals import vertex_normals
from asterism.print.formats.registry import export_format
from asterism.process.version import __version__
from asterism.shape.shape import Shape

# codes of the format: types of numbers, and kinds of buffers
_FLOAT_CODE = 5126
_UNSIGNED_CODE = 5125
_POINTS_BUFFER = 34962
_INDEX_BUFFER = 34963
# turns z upwards to y, and converts mm to metres
_TO_METRES = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]) * 1e-3


@export_format("GLB", ".glb", "shape")
def write_glb(path: Path, shape: Shape, name: str) -> None:
    """Write the sheet."""
    points = np.asarray(shape.positions @ _TO_METRES.T, dtype="<f4")
    normals = vertex_normals(shape.positions, shape.triangles) @ (_TO_METRES.T * 1e3)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    arrays = [points, np.asarray(normals, dtype="<f4"), np.asarray(shape.triangles, dtype="<u4").ravel()]
    data = b"".join(array.tobytes() for array in arrays)
    starts = np.cumsum([0, *(array.nbytes for array in arrays)])
    views = [
        {"buffer": 0, "byteOffset": int(start), "byteLength": array.nbytes, "target": target}
        for start, array, target in zip(starts, arrays, (_POINTS_BUFFER, _POINTS_BUFFER, _INDEX_BUFFER), strict=False)
    ]
    accessors = [
        {"bufferView": 0, "componentType": _FLOAT_CODE, "count": len(points), "type": "VEC3"}
        | {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()},
        {"bufferView": 1, "componentType": _FLOAT_CODE, "count": len(points), "type": "VEC3"},
        {"bufferView": 2, "componentType": _UNSIGNED_CODE, "count": shape.triangles.size, "type": "SCALAR"},
    ]
    surface = {"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}
    matte = {"baseColorFactor": [0.96, 0.90, 0.78, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9}
    scene = {
        "asset": {"version": "2.0", "generator": f"asterism {__version__}"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": name}],
        "meshes": [{"name": name, "primitives": [surface]}],
        # both sides of the sheet are visible
        "materials": [{"pbrMetallicRoughness": matte, "doubleSided": True}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data)}],
    }
    text = json.dumps(scene, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
