"""A shape from the files of a result: shape.vtu or exact.vtu, with rods.vtu and summary.json if they are beside it."""

from __future__ import annotations

import contextlib
import io
import json
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from scipy.spatial import cKDTree

from asterism.results.files import VERIFICATION
from asterism.results.records.of_shape import shape_record
from asterism.shape.shape import Shape
from pattern.design.errors import DesignError
from pattern.geometry.arrays import Floats, Ints

# name of the shape in the folder of a preview or a simulation
SHAPE_FILE = "shape.vtu"
# name of the exact shape in the folder of a verification
EXACT_FILE = "exact.vtu"


def read_shape(path: str | Path) -> Shape:
    """The shape in a result's directory, the exact one in that of a verification, or that in a `.vtu` file.

    Without rods.vtu it has no arms; without summary.json no summary, and it counts as free. Beside exact.vtu and
    preview.vtu of a verification it is the part of the summary that is of that shape, and for minimum-2.vtu, ... what
    the summary says of that minimum.

    Raises
    ------
    DesignError
        There is no shape, or not one of asterism's; the message names the file.
    """
    path = Path(path)
    sheet = path
    if path.is_dir():
        verified = not (path / SHAPE_FILE).exists() and (path / EXACT_FILE).exists()
        sheet = path / (EXACT_FILE if verified else SHAPE_FILE)
    mesh = _read(sheet)
    printed, triangles = _printed(mesh, sheet), _cells(mesh, "triangle", sheet)
    star = np.asarray(mesh.point_data.get("star", np.full(len(mesh.points), -1)), dtype=np.int64)
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
        held=_is_held(summary),
    )


def folder_of(path: Path) -> Path:
    """The directory of a result that is named by its directory or its `.vtu` file."""
    return (path if path.is_dir() else path.parent).resolve()


def _is_held(summary: dict[str, Any]) -> bool:
    """Whether the design that a shape was made from has pins."""
    design = summary.get("design")
    return isinstance(design, dict) and bool(design.get("pins"))


def _rods(path: Path, printed: Floats) -> tuple[tuple[Ints, ...], dict[str, np.ndarray]]:
    """Arms as vertices of the sheet, and their fields; none without the file."""
    if not path.exists():
        return (), {}
    mesh = _read(path)
    lines, places = _cells(mesh, "line", path), _printed(mesh, path)
    # every point of an arm is a vertex of the sheet, where it was printed
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
        # the reader prints its complaints
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return meshio.vtu.read(str(path))
    except (Exception, SystemExit) as error:
        reason = str(error).strip().split("\n")[0]
        other = f": {reason}" if reason else "; a folder of results, or the shape.vtu in it, can"
        raise DesignError("", f"cannot be read as VTU{other}", file=path) from None


def _printed(mesh: meshio.Mesh, path: Path) -> Floats:
    printed = np.asarray(mesh.point_data.get("printed_mm", ()), dtype=np.float64)
    if printed.shape != (len(mesh.points), 3) or not np.isfinite(mesh.points).all():
        raise DesignError("", "must hold finite points with printed_mm, as asterism writes them", file=path)
    return printed[:, :2].copy()


def _cells(mesh: meshio.Mesh, kind: str, path: Path) -> Ints:
    cells = mesh.cells_dict.get(kind)
    if cells is None or len(mesh.cells) != 1 or len(cells) == 0:
        raise DesignError("", f"must hold {kind}s and nothing else", file=path)
    return np.asarray(cells, dtype=np.int64)


def _summary(path: Path, of: str) -> dict[str, Any]:
    if not path.exists():
        return {}
    try:
        summary = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise DesignError("", f"cannot be read as JSON: {error}", file=path) from None
    if isinstance(summary, dict) and summary.get("model") == VERIFICATION:
        summary = summary.get(of)
    if isinstance(summary, dict) and of.startswith("minimum-"):
        summary = _of_minimum(summary, of)
    if isinstance(summary, dict) and not isinstance(summary.get("design", {}), dict):
        raise DesignError("design", "must be a table of keys and values", summary["design"], file=path)
    return summary if isinstance(summary, dict) else {}


def _of_minimum(summary: dict[str, Any], of: str) -> dict[str, Any]:
    """What a summary says of a further minimum: the rest of it is of the first one."""
    minima = summary.get("minima")
    entries = [entry for entry in minima if isinstance(entry, dict)] if isinstance(minima, list) else []
    found = next((entry for entry in entries if entry.get("file") == of), {})
    of_all: dict[str, Any] = {key: summary[key] for key in ("model", "version", "design") if key in summary}
    return of_all | found
