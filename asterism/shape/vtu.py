"""The sheet and its arms as VTU files, for ParaView and other readers of VTK files; a shape read from them."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import read_table
from asterism.pattern.geometry.planar import triangle_areas
from asterism.results.files import MAX_SUMMARY_BYTES, VERIFICATION_MODEL
from asterism.results.record import misfit
from asterism.shape.shape import Shape, shape_record
from asterism.shape.surface import surface_triangle_areas


def write_shape_vtu(shape: Shape, path: str | Path) -> None:
    """Write the triangles of the sheet with the fields of the shape.

    Point arrays: `printed_mm` (printed coordinates, z = 0), `star` (number of the star whose centre is this point, -1
    elsewhere) and `point_fields`. Cell arrays: `cell_fields`.
    """
    _write(path, shape, slice(None), ("triangle", shape.triangles), shape.cell_fields, shape.point_fields)


def write_rods_vtu(shape: Shape, path: str | Path) -> None:
    """Write a line for each rod edge; `arm`, `star`, `thickness_mm` and `width_mm` are among its arrays."""
    used, edges = np.unique(shape.rod_edges, return_inverse=True)
    _write(path, shape, used, ("line", edges.reshape(-1, 2)), shape.rod_fields, {})


def _write(
    path: str | Path,
    shape: Shape,
    vertices: Any,
    cells: tuple[str, np.ndarray],
    fields: Mapping[str, np.ndarray],
    more: Mapping[str, np.ndarray],
) -> None:
    """Write one block of cells, of some vertices of a shape, in VTK's binary form; `more` are fields of these."""
    printed = np.pad(shape.printed[vertices], ((0, 0), (0, 1)))
    points = {"printed_mm": printed, "star": shape.star[vertices], **more}
    mesh = meshio.Mesh(
        np.asarray(shape.positions[vertices], dtype=np.float64),
        [(cells[0], np.asarray(cells[1], dtype=np.int64))],
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


# name of the shape in the folder of a preview or a simulation
SHAPE_FILE = "shape.vtu"


def read_shape(path: str | Path) -> Shape:
    """Read a shape from a directory of results or from a `.vtu` file.

    If rods.vtu is missing, the shape has no arms. If summary.json is missing, its summary is empty and it counts as
    a free sheet. For exact.vtu and preview.vtu of a verification, the summary is the part of summary.json on that
    shape; for minimum-2.vtu and further minima it is the entry of that minimum.

    Parameters
    ----------
    path : directory of a preview or simulation (reads shape.vtu), directory of a verification (reads exact.vtu), or
        a `.vtu` file written by asterism.

    Raises
    ------
    DesignError
        The file is missing or not written by asterism; the message names the file.
    """
    path = Path(path)
    sheet = path
    if path.is_dir():
        verified = not (path / SHAPE_FILE).exists() and (path / "exact.vtu").exists()
        sheet = path / ("exact.vtu" if verified else SHAPE_FILE)
    mesh = _read(sheet)
    printed, triangles = _printed(mesh, sheet), _cells(mesh, "triangle", sheet)
    areas = [triangle_areas(printed, triangles), surface_triangle_areas(np.asarray(mesh.points), triangles)]
    if np.min(areas) <= 0.0:
        raise DesignError("", "must hold triangles with an area, counterclockwise in print", file=sheet)
    star = np.asarray(mesh.point_data.get("star", np.full(len(mesh.points), -1)))
    if star.shape != (len(mesh.points),) or not np.issubdtype(star.dtype, np.integer):
        raise DesignError("", "must hold whole numbers of stars", file=sheet)
    centres = np.flatnonzero(star >= 0)
    rods, rod_fields = _rods(sheet.with_name("rods.vtu"), printed)
    summary = _summary(sheet.with_name("summary.json"), sheet.stem)
    return Shape(
        printed=printed,
        positions=np.asarray(mesh.points, dtype=np.float64),
        triangles=triangles,
        star=star,
        rods=rods,
        star_vertices=centres[np.argsort(star[centres])],
        point_fields={k: np.asarray(v) for k, v in mesh.point_data.items() if k not in ("printed_mm", "star")},
        cell_fields={name: np.asarray(values[0]) for name, values in mesh.cell_data.items()},
        rod_fields=rod_fields,
        summary=shape_record(summary),
        held=bool(summary.get("design", {}).get("pins")),
    )


def folder_of(path: Path) -> Path:
    """The directory of a result, given the directory or a `.vtu` file in it."""
    return (path if path.is_dir() else path.parent).resolve()


def _rods(path: Path, printed: Floats) -> tuple[tuple[Ints, ...], dict[str, np.ndarray]]:
    """Arms as vertices of the sheet, and their fields; empty if the file is missing."""
    if not path.exists():
        return (), {}
    mesh = _read(path)
    lines, places = _cells(mesh, "line", path), _printed(mesh, path)
    # each point of an arm is a vertex of the sheet: match them by their printed coordinates
    distance, vertex = cKDTree(printed).query(places)
    if len(lines) == 0 or distance.max() > 1e-9 * np.ptp(printed):
        raise DesignError("", "does not belong to the sheet in shape.vtu", file=path)
    edges = np.asarray(vertex, dtype=np.int64)[lines]
    fields = {name: np.asarray(values[0]) for name, values in mesh.cell_data.items()}
    arm = fields.get("arm", np.zeros(len(edges)))
    cuts = np.flatnonzero((np.diff(arm) != 0) | (edges[1:, 0] != edges[:-1, 1])) + 1
    rods = tuple(np.concatenate([part[:, 0], part[-1:, 1]]) for part in np.split(edges, cuts))
    return rods, fields


def _read(path: Path) -> meshio.Mesh:
    if not path.is_file():
        raise DesignError("", "is not there: asterism simulate writes one", file=path)
    try:
        # meshio prints its errors on the terminal
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return meshio.vtu.read(str(path))
    except (Exception, SystemExit) as error:
        reason = str(error).strip().split("\n")[0]
        detail = f": {reason}" if reason else "; give a folder of results, or the shape.vtu in it"
        raise DesignError("", f"cannot be read as VTU{detail}", file=path) from None


def _printed(mesh: meshio.Mesh, path: Path) -> Floats:
    printed = np.asarray(mesh.point_data.get("printed_mm", ()), dtype=np.float64)
    if printed.shape != (len(mesh.points), 3) or not (np.abs([printed, mesh.points]) < 1e6).all():
        raise DesignError("", "must hold points below 1e+06 mm with printed_mm, as asterism writes them", file=path)
    return printed[:, :2].copy()


def _cells(mesh: meshio.Mesh, kind: str, path: Path) -> Ints:
    cells = mesh.cells_dict.get(kind)
    if cells is None or len(mesh.cells) != 1 or len(cells) == 0:
        raise DesignError("", f"must hold {kind}s and nothing else", file=path)
    if not 0 <= cells.min() <= cells.max() < len(mesh.points):
        raise DesignError("", f"must hold {kind}s of points from 0 to {len(mesh.points) - 1}", file=path)
    return np.asarray(cells, dtype=np.int64)


def _summary(path: Path, of: str) -> dict[str, Any]:
    if not path.exists():
        return {}
    summary = read_table(path, MAX_SUMMARY_BYTES)
    if summary.get("model") == VERIFICATION_MODEL:
        part = summary.get(of)
        summary = part if isinstance(part, dict) else {}
    if wrong := misfit(shape_record(summary)):
        raise DesignError(wrong, "must have the type that asterism writes", summary[wrong], file=path)
    if not isinstance(summary.get("design", {}), dict):
        raise DesignError("design", "must be a table of keys and values", summary["design"], file=path)
    if not of.startswith("minimum-"):
        return summary
    # of a further minimum its entry in `minima`, and the keys that hold for all minima
    minima = summary.get("minima")
    entries = [entry for entry in minima if isinstance(entry, dict)] if isinstance(minima, list) else []
    minimum = next((entry for entry in entries if entry.get("file") == of), {})
    common: dict[str, Any] = {key: summary[key] for key in ("model", "version", "design") if key in summary}
    return common | minimum
