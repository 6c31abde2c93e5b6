"""A target from a file: triangles, a 3DM file of Rhino by `rhino3dm` (the extra `cad`), or heights."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fitting.disk import TargetError
from asterism.fitting.target import MIN_FILLED_SHARE, PICTURE_FORMATS, PlasticSide, TargetSurface, picture_levels
from asterism.measure.scan import MM, SCAN_FORMATS, check_file, read_surface
from asterism.pattern.design.sizing.grey_image import ImageError
from asterism.pattern.drawing.rhino import RHINO_FORMAT, open_rhino_model


def read_rhino(path: Path, mm: float | None) -> tuple[Floats, Ints]:
    """The visible surfaces of a 3DM file as triangles.

    Meshes are taken as they are. A surface that is not trimmed is sampled at its parameters; of a trimmed or joined one
    the file must hold the render mesh, as files saved by Rhino do.

    `mm`: length of the unit of the numbers; None for the unit that the file names.

    Returns vertices (V, 3) in mm and triangles (T, 3).

    Raises TargetError: `rhino3dm` is not installed, or the file holds no surface that can be read.
    """
    model = open_rhino_model(path, mm, lambda problem: TargetError(path, problem))
    meshes = [mesh for geometry, _, hidden in model.shown() if not hidden for mesh in _meshes(path, geometry)]
    if not meshes:
        kinds = sorted({type(thing.Geometry).__name__ for thing in model.file.Objects})
        held = f"only {', '.join(kinds)}" if kinds else "nothing"
        raise TargetError(path, f"holds no visible surface or mesh, {held}")
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    vertices = np.concatenate([vertices for vertices, _ in meshes])
    triangles = np.concatenate([triangles + start for (_, triangles), start in zip(meshes, starts, strict=False)])
    return model.mm * vertices, triangles


def _meshes(path: Path, geometry: Any) -> list[tuple[Floats, Ints]]:
    """The triangles of one object: none for curves, points and the like."""
    import rhino3dm

    if isinstance(geometry, rhino3dm.Mesh):
        return [mesh_triangles(geometry)]
    if isinstance(geometry, rhino3dm.Extrusion):
        geometry = geometry.ToBrep(False)
    if isinstance(geometry, rhino3dm.Brep):
        table: Any = geometry.Faces
        faces = list(table)
        cached = [face.GetMesh(rhino3dm.MeshType.Any) for face in faces]
        if len(faces) == 1 and geometry.IsSurface:
            return [_sampled(faces[0].UnderlyingSurface())]
        if any(mesh is None or len(mesh.Vertices) == 0 for mesh in cached):
            problem = "a trimmed or joined surface without its render mesh: save the file shaded, or mesh it in Rhino"
            raise TargetError(path, f"holds {problem}")
        return [mesh_triangles(mesh) for mesh in cached]
    if isinstance(geometry, rhino3dm.Surface):
        return [_sampled(geometry)]
    return []


def mesh_triangles(mesh: Any) -> tuple[Floats, Ints]:
    """Vertices (V, 3) and triangles (T, 3) of a mesh of Rhino, in its unit."""
    vertices = np.array([[point.X, point.Y, point.Z] for point in mesh.Vertices], dtype=float).reshape(-1, 3)
    faces = mesh.Faces
    corners = np.array([faces[number] for number in range(len(faces))], dtype=np.int64).reshape(-1, 4)
    # a triangle repeats its third corner
    quads = corners[corners[:, 2] != corners[:, 3]]
    return vertices, np.concatenate([corners[:, :3], quads[:, [0, 2, 3]]])


def _sampled(surface: Any) -> tuple[Floats, Ints]:
    """A grid of points on a surface that is not trimmed."""
    values = []
    for direction in (0, 1):
        # points along each parameter: so many for each span between knots
        count = int(np.clip(8 * surface.SpanCount(direction), 60, 200))
        interval = surface.Domain(direction)
        values.append(np.linspace(interval.T0, interval.T1, count))
    points = [surface.PointAt(float(u), float(v)) for u in values[0] for v in values[1]]
    number = np.arange(len(points)).reshape(len(values[0]), -1)
    a, b, c, d = (part.ravel() for part in (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return np.array([[point.X, point.Y, point.Z] for point in points]), triangles


ARRAY_FORMATS = (".npy", ".csv")


def load_target(
    path: str | Path,
    unit: str | None = None,
    size_mm: float | None = None,
    side: PlasticSide = "auto",
    heights_mm: tuple[float, float] | None = None,
    extent_mm: float | None = None,
) -> TargetSurface:
    """Read a target from a file.

    The suffix of its name decides how the file is read: as triangles (`.obj`, `.stl`, `.ply`), as a NURBS surface or a
    mesh of Rhino (`.3dm`, needs the extra `cad`), or as heights over a rectangle. Heights are a grey picture (`.png`
    and others), an array of numpy (`.npy`) or a table of numbers (`.csv`). Their first row has the largest y, as in a
    picture. Transparent pixels, empty cells and nan are no part of the surface.

    Parameters
    ----------
    unit : of the numbers in the file: `mm`, `cm`, `m`, `in` or `um`. By default mm, or the unit that a 3DM file names.
    size_mm : scales the target so that the largest distance of two of its points is this long.
    side : of the plastic, see `TargetSurface.of_triangles`.
    heights_mm : heights of black and white, for a picture.
    extent_mm : width of a picture or an array, from the middle of its first column to that of its last one.

    Raises
    ------
    ScanError
        The file of triangles cannot be read.
    TargetError
        Another file cannot be read, its surface cannot be a target, or an option is wrong.

    Examples
    --------
    >>> import tempfile
    >>> x = np.linspace(-1.0, 1.0, 41)
    >>> file = Path(tempfile.mkdtemp()) / "vault.npy"
    >>> np.save(file, 12.0 * (1.0 - x[None] ** 2) * (1.0 - x[:, None] ** 2))
    >>> round(load_target(file, extent_mm=90.0).diameter_mm, 1)
    127.3
    """
    path = Path(path)
    ending = path.suffix.lower()
    if unit is not None and unit not in MM:
        raise TargetError(path, f"unit = {unit!r}: must be {', '.join(MM)}")
    if size_mm is not None and not (isinstance(size_mm, int | float) and np.isfinite(size_mm) and size_mm > 0.0):
        raise TargetError(path, f"size_mm = {size_mm!r}: must be a number of mm above 0")
    if ending in (*PICTURE_FORMATS, *ARRAY_FORMATS):
        heights, x, y, notes = _heights(path, MM[unit or "mm"], heights_mm, extent_mm)
        target = TargetSurface.of_heights(heights, x, y, str(path), side, size_mm)
        return replace(target, notes=(*notes, *target.notes))
    if heights_mm is not None or extent_mm is not None:
        name = "extent_mm" if heights_mm is None else "heights_mm"
        raise TargetError(path, f"{name} belongs to pictures and arrays of heights ({', '.join(ARRAY_FORMATS)}, ...)")
    if ending == RHINO_FORMAT:
        vertices, triangles = read_rhino(path, None if unit is None else MM[unit])
    elif ending in SCAN_FORMATS:
        if path.is_file():  # 64 MB, with 1.3 million triangles, take a minute on a busy machine
            _check_length(path, 60, ": simplify it")
        vertices, triangles = read_surface(path)
        vertices = MM[unit or "mm"] * vertices
    else:
        known = (*SCAN_FORMATS, RHINO_FORMAT, *PICTURE_FORMATS, *ARRAY_FORMATS)
        raise TargetError(path, f"must end in {', '.join(known)}")
    return TargetSurface.of_triangles(vertices, triangles, str(path), side, size_mm)


def _heights(
    path: Path, mm: float, heights_mm: tuple[float, float] | None, extent_mm: float | None
) -> tuple[Floats, Floats, Floats, list[str]]:
    """Heights (m, n) in mm over x (n,) and y (m,) around 0, nan where there is no surface; a note if made coarser.

    The first row of a file has the largest y. `mm` is the length of the unit of the numbers of an array.
    """
    check_file(path, TargetError)
    if extent_mm is None:
        raise TargetError(path, "extent_mm (--extent-mm) is missing: the width of the field in mm")
    if not (isinstance(extent_mm, int | float) and np.isfinite(extent_mm) and extent_mm > 0.0):
        raise TargetError(path, f"extent_mm = {extent_mm!r}: must be a number of mm above 0")
    if path.suffix.lower() in PICTURE_FORMATS:
        heights = _picture_heights(path, heights_mm)
    else:
        if heights_mm is not None:
            raise TargetError(path, "heights_mm belongs to pictures: the numbers of an array are heights")
        heights = mm * (_array(path) if path.suffix.lower() == ".npy" else _table(path))
    rows, columns = heights.shape
    if min(rows, columns) < 2 or max(rows, columns) > 20 * min(rows, columns):
        allowed = "at least 2 x 2, and one side at most 20 times as long as the other"
        raise TargetError(path, f"has {columns} x {rows} values: must be {allowed}")
    step = extent_mm / (columns - 1)
    reduced, block = _blocks(heights)
    if not np.isfinite(reduced).any():
        raise TargetError(path, "holds no heights: every value is empty")
    notes = [f"{columns} x {rows} values are averaged over {block} x {block}"] if block > 1 else []
    x, y = (step * block * (np.arange(count) - 0.5 * (count - 1)) for count in reduced.shape[::-1])
    return reduced[::-1], x, y, notes


def _picture_heights(path: Path, heights_mm: tuple[float, float] | None) -> Floats:
    if heights_mm is None:
        raise TargetError(path, "heights_mm (--heights-mm) is missing: the heights of black and white in mm")
    is_pair = isinstance(heights_mm, tuple | list) and len(heights_mm) == 2
    if not is_pair or not all(isinstance(height, int | float) and np.isfinite(height) for height in heights_mm):
        raise TargetError(path, f"heights_mm = {heights_mm!r}: must be two numbers of mm")
    low, high = heights_mm
    if low == high:
        raise TargetError(path, f"heights_mm = {low:g}, {high:g}: must be two different numbers")
    try:
        levels = picture_levels(path)
    except ImageError as error:
        raise TargetError(path, f"the picture {error}") from None
    known = levels[np.isfinite(levels)]
    if known.size and known.max() == known.min():
        raise TargetError(path, "has no contrast: all its pixels have the same grey value")
    return low + (high - low) * levels


def _check_length(path: Path, megabytes: int, remedy: str = "") -> None:
    if path.stat().st_size > 1_000_000 * megabytes:
        raise TargetError(path, f"is larger than {megabytes} MB{remedy}")


def _array(path: Path) -> Floats:
    """(m, n) numbers of a .npy file, nan where there is no surface."""
    _check_length(path, 200)
    try:
        values = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError, SyntaxError, MemoryError):
        raise TargetError(path, "cannot be read as an array of numpy: the file is damaged or cut short") from None
    if not isinstance(values, np.ndarray) or values.ndim != 2:
        shape = getattr(values, "shape", "?")
        raise TargetError(path, f"holds an array of shape {shape}: heights have two axes, (rows, columns)")
    if values.dtype.kind not in "iufb":
        raise TargetError(path, f"holds {values.dtype} in place of numbers")
    return _finite(path, values.astype(float))


def _table(path: Path) -> Floats:
    """(m, n) numbers of a CSV file; an empty cell has no surface. Commas, semicolons or tabs separate the cells."""
    _check_length(path, 20)
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise TargetError(path, "cannot be read as CSV: it is not text") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    if not lines:
        raise TargetError(path, "is empty")
    separator = max(",;\t", key=lines[0][1].count)
    rows: list[list[float]] = []
    try:
        cells_of = csv.reader((line for _, line in lines), delimiter=separator)
        for (number, _), cells in zip(lines, cells_of, strict=False):
            rows.append([_number(path, number, column, cell) for column, cell in enumerate(cells, 1)])
            if len(rows[-1]) != len(rows[0]):
                raise TargetError(path, f"row {number} has {len(rows[-1])} values, the first row has {len(rows[0])}")
    except csv.Error as error:
        raise TargetError(path, f"cannot be read as CSV: {error}") from None
    return _finite(path, np.array(rows))


def _number(path: Path, row: int, column: int, cell: str) -> float:
    if not cell.strip():
        return np.nan
    try:
        return float(cell)
    except ValueError:
        raise TargetError(path, f"row {row}, column {column}: {cell.strip()[:40]!r} is no number") from None


def _finite(path: Path, values: Floats) -> Floats:
    if np.isinf(values).any():
        raise TargetError(path, "holds infinite heights: leave places without a surface empty, or nan")
    return values


def _blocks(heights: Floats) -> tuple[Floats, int]:
    """Means over square blocks, so many that 100 remain along the longer side, and a block's side.

    This also evens out the steps of grey values. Rows and columns that fill no block are left out, half of them on each
    side. A block has no surface if less than half of it has.
    """
    block = int(np.ceil(max(heights.shape) / 100))
    if block == 1:
        return heights, 1
    counts = [size // block for size in heights.shape]
    first = [(size - count * block) // 2 for size, count in zip(heights.shape, counts, strict=True)]
    kept = heights[first[0] : first[0] + counts[0] * block, first[1] : first[1] + counts[1] * block]
    parts = kept.reshape(counts[0], block, counts[1], block)
    filled = np.isfinite(parts)
    number = filled.sum(axis=(1, 3))
    mean = np.where(filled, parts, 0.0).sum(axis=(1, 3)) / np.maximum(number, 1)
    return np.where(number >= MIN_FILLED_SHARE * block**2, mean, np.nan), block
