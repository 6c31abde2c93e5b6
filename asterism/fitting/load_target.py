"""`asterism.load_target`: a target surface from a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from asterism.fitting.errors import TargetError
from asterism.fitting.height_file import ARRAY_FORMATS, PICTURE_FORMATS, read_heights
from asterism.fitting.rhino_file import read_rhino
from asterism.fitting.target import PlasticSide, TargetSurface
from asterism.measure.compare.scan import MM, SCAN_FORMATS, read_surface
from asterism.pattern.drawing.rhino import RHINO_FORMAT

# larger files take more than a minute on a busy machine: one of 64 MB, with 1.3 million triangles, took 58 s
MAX_MESH_BYTES = 60_000_000


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
    picture.
    Transparent pixels, empty cells and nan are no part of the surface.

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
    >>> import numpy as np
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
        field = read_heights(path, MM[unit or "mm"], heights_mm, extent_mm)
        target = TargetSurface.of_heights(field.heights_mm, field.x_mm, field.y_mm, str(path), side, size_mm)
        return replace(target, notes=(*((field.note,) if field.note else ()), *target.notes))
    if heights_mm is not None or extent_mm is not None:
        name = "extent_mm" if heights_mm is None else "heights_mm"
        raise TargetError(path, f"{name} belongs to pictures and arrays of heights ({', '.join(ARRAY_FORMATS)}, ...)")
    if ending == RHINO_FORMAT:
        vertices, triangles = read_rhino(path, None if unit is None else MM[unit])
    elif ending in SCAN_FORMATS:
        if path.is_file() and path.stat().st_size > MAX_MESH_BYTES:
            raise TargetError(path, f"is larger than {MAX_MESH_BYTES // 1_000_000} MB: simplify it")
        vertices, triangles = read_surface(path)
        vertices = MM[unit or "mm"] * vertices
    else:
        known = (*SCAN_FORMATS, RHINO_FORMAT, *PICTURE_FORMATS, *ARRAY_FORMATS)
        raise TargetError(path, f"must end in {', '.join(known)}")
    return TargetSurface.of_triangles(vertices, triangles, str(path), side, size_mm)
