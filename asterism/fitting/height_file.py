"""Heights over a rectangular grid from files: grey pictures, arrays of numpy, and tables of numbers."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fitting.errors import TargetError
from asterism.measure.compare.scan import why_no_file
from asterism.pattern.design.sizing.grey_image import ImageError, check_pixel_format, opened_picture

PICTURE_FORMATS = (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp", ".webp")
ARRAY_FORMATS = (".npy", ".csv")
# larger files of numbers are refused
MAX_ARRAY_BYTES = 200_000_000
MAX_CSV_BYTES = 20_000_000
# points along the longer side; finer fields are averaged over blocks, which also evens out the steps of grey values
MAX_HEIGHT_POINTS = 100
# largest ratio of the sides of a field
MAX_FIELD_ASPECT = 20.0
# a block of a field, or a pixel, belongs to the surface if at least this part of it does
MIN_FILLED_SHARE = 0.5


@dataclass(frozen=True, eq=False)
class HeightField:
    """Heights over a grid of squares.

    Attributes
    ----------
    heights_mm : (m, n), the last row of the file first; nan where there is no surface.
    x_mm, y_mm : (n,) and (m,), increasing, around 0.
    note : how the field was made coarser; empty otherwise.
    """

    heights_mm: Floats
    x_mm: Floats
    y_mm: Floats
    note: str


def read_heights(path: Path, mm: float, heights_mm: tuple[float, float] | None, extent_mm: float | None) -> HeightField:
    """The heights in a file, whose first row is the one with the largest y, as in a picture.

    Parameters
    ----------
    mm : length of the unit of the numbers of an array.
    heights_mm : heights of black and white, for a picture.
    extent_mm : width of the field along x, from the middle of the first column to that of the last one.

    Raises
    ------
    TargetError
        The file cannot be read, holds no field of heights, or an option is missing.
    """
    if not path.is_file():
        raise TargetError(path, why_no_file(path))
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
    if min(rows, columns) < 2 or max(rows, columns) > MAX_FIELD_ASPECT * min(rows, columns):
        allowed = f"at least 2 x 2, and one side at most {MAX_FIELD_ASPECT:g} times as long as the other"
        raise TargetError(path, f"has {columns} x {rows} values: must be {allowed}")
    step = extent_mm / (columns - 1)
    reduced, block = _blocks(heights)
    if not np.isfinite(reduced).any():
        raise TargetError(path, "holds no heights: every value is empty")
    note = f"{columns} x {rows} values are averaged over {block} x {block}" if block > 1 else ""
    x, y = (step * block * (np.arange(count) - 0.5 * (count - 1)) for count in reduced.shape[::-1])
    return HeightField(reduced[::-1], x, y, note)


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


def picture_levels(path: Path) -> Floats:
    """(m, n) grey values of a picture from 0 (black) to 1 (white), all bits of them; nan where it is transparent.

    Raises
    ------
    ImageError
        There is no such file, it is too large, or it is not a picture.
    """
    from PIL import ImageOps  # slow to import, rarely used

    with opened_picture(path) as picture:
        check_pixel_format(picture)
        upright = ImageOps.exif_transpose(picture)
        if upright.mode.startswith("I"):
            return np.asarray(upright, dtype=float) / 65535.0
        colours = upright.convert("RGBA")
        levels = np.asarray(colours.convert("L"), dtype=float) / 255.0
        opacity = np.asarray(colours.getchannel("A"), dtype=float) / 255.0
        return np.where(opacity >= MIN_FILLED_SHARE, levels, np.nan)


def _array(path: Path) -> Floats:
    """(m, n) numbers of a .npy file, nan where there is no surface."""
    if path.stat().st_size > MAX_ARRAY_BYTES:
        raise TargetError(path, f"is larger than {MAX_ARRAY_BYTES // 1_000_000} MB")
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
    if path.stat().st_size > MAX_CSV_BYTES:
        raise TargetError(path, f"is larger than {MAX_CSV_BYTES // 1_000_000} MB")
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
        for (number, _), cells in zip(
            lines, csv.reader((line for _, line in lines), delimiter=separator), strict=False
        ):
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
    """Means over square blocks, so many that `MAX_HEIGHT_POINTS` remain along the longer side, and a block's side.

    Rows and columns that fill no block are left out, half of them on each side. A block has no surface if less than
    half of it has.
    """
    block = int(np.ceil(max(heights.shape) / MAX_HEIGHT_POINTS))
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
