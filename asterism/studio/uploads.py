"""Files that a page sends: grey pictures for star sizes, drawings of an outline."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Any

from asterism.measure.compare.outline import OUTLINE_FORMATS, read_outline
from equilibrium.errors import Error
from pattern.design.sizing.grey_image import ImageError, pack_image, read_grey

MAX_UPLOAD_BYTES = 8_000_000
MAX_CORNERS = 1000
OUTLINE_DIGITS = 4


class UploadKind(StrEnum):
    """What a file is for."""

    IMAGE = "image"
    OUTLINE = "outline"


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
    if path.suffix not in OUTLINE_FORMATS:
        raise UploadError(f"an outline must be a file of {' or '.join(OUTLINE_FORMATS)}")
    corners = read_outline(path).corners
    if len(corners) > MAX_CORNERS:
        raise UploadError(f"the outline has {len(corners)} corners; at most {MAX_CORNERS} are allowed")
    return {"border": {"polygon_mm": corners.round(OUTLINE_DIGITS).tolist()}}
