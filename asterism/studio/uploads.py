"""Files that a page sends: grey pictures for star sizes, and outlines, also from drawings in DXF."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.measure.compare.outline import OUTLINE_FORMATS, read_outline
from asterism.pattern.design.sizing.grey_image import ImageError, pack_image, read_grey

MAX_UPLOAD_BYTES = 8_000_000
MAX_CORNERS = 1000


class UploadKind(StrEnum):
    """What a file is for."""

    IMAGE = "image"
    OUTLINE = "outline"
    TARGET = "target"
    DRAWING = "drawing"


class UploadError(Error, ValueError):
    """A file that cannot be used; the message is one line."""


def read_upload(kind: UploadKind, path: Path, name: str = "") -> dict[str, Any]:
    """The part of a design file that a file stands for.

    Parameters
    ----------
    name : of the file as the page gives it; it goes into the design as a note.

    Returns
    -------
    `{"value": {...}}` for a picture: a sizing profile without `low`, `high` and `extent_mm`; `{"border": {...}}` for an
    outline.

    Raises
    ------
    UploadError, ScanError
        The file cannot be read as such.
    """
    if kind is UploadKind.IMAGE:
        try:
            grey = read_grey(path)
        except ImageError as error:
            raise UploadError(f"the picture {error}") from None
        rows, columns = grey.shape
        return {"value": {"image": name or path.name, "pixels": [columns, rows], "grey": pack_image(grey)}}
    if path.suffix not in (*OUTLINE_FORMATS, ".dxf"):
        raise UploadError(f"an outline must be a file of {', '.join((*OUTLINE_FORMATS, '.dxf'))}")
    return {"border": {"polygon_mm": border_corners(read_outline(path).corners).round(4).tolist()}}


def border_corners(corners: Floats) -> Floats:
    """An outline for a design: around the origin, counterclockwise, and with as few corners as a print can show.

    Raises
    ------
    UploadError
        The outline still has too many corners.
    """
    # Corners that are nearer to the line between their neighbours are left out.
    polygon = shapely.Polygon(corners).simplify(0.05)
    simple: Floats = np.asarray(shapely.geometry.polygon.orient(polygon).exterior.coords)[:-1, :2]
    if len(simple) > MAX_CORNERS:
        raise UploadError(f"the outline has {len(simple)} corners; at most {MAX_CORNERS} are allowed")
    centred: Floats = simple - (simple.min(axis=0) + simple.max(axis=0)) / 2
    return centred
