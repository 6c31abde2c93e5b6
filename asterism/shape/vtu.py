"""The sheet and its arms as VTU files, for ParaView and other readers of VTK files."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np

from asterism.shape.shape import Shape


def write_shape_vtu(shape: Shape, path: str | Path) -> None:
    """Write the triangles of the sheet with the fields of the shape.

    Point arrays: `printed_mm` (printed coordinates, z = 0), `star` (number of the star whose centre is this point, -1
    elsewhere) and `point_fields`. Cell arrays: `cell_fields`.
    """
    points = {"printed_mm": _flat(shape.printed), "star": shape.star, **shape.point_fields}
    _write(path, shape.positions, "triangle", shape.triangles, points, shape.cell_fields)


def write_rods_vtu(shape: Shape, path: str | Path) -> None:
    """Write a line for each rod edge; `arm`, `star`, `thickness_mm` and `width_mm` are among its arrays."""
    used, edges = np.unique(shape.rod_edges, return_inverse=True)
    points = {"printed_mm": _flat(shape.printed[used]), "star": shape.star[used]}
    _write(path, shape.positions[used], "line", edges.reshape(-1, 2), points, shape.rod_fields)


def _flat(printed: np.ndarray) -> np.ndarray:
    return np.column_stack([printed, np.zeros(len(printed))])


def _write(
    path: str | Path,
    positions: np.ndarray,
    kind: str,
    cells: np.ndarray,
    points: Mapping[str, np.ndarray],
    fields: Mapping[str, np.ndarray],
) -> None:
    """Write one block of cells in VTK's binary form."""
    mesh = meshio.Mesh(
        np.asarray(positions, dtype=np.float64),
        [(kind, np.asarray(cells, dtype=np.int64))],
        point_data={name: _plain(values) for name, values in points.items()},
        cell_data={name: [_plain(values)] for name, values in fields.items()},
    )
    # `meshio.write` would print messages on the terminal
    meshio.vtu.write(str(path), mesh)


def _plain(values: np.ndarray) -> np.ndarray:
    """64-bit integers or floats, the two types that all readers of VTK files support."""
    array = np.asarray(values)
    whole = np.issubdtype(array.dtype, np.integer) or array.dtype == bool
    return np.ascontiguousarray(array, dtype=np.int64 if whole else np.float64)
