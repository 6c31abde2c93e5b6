"""Distances on rendered sheets: where thin lines of a colour are, finer than a pixel."""

from __future__ import annotations

import io
import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

Pixels = NDArray[np.float64]
INCH_MM = 25.4


def pdf_band(
    path: Path, page: int, low_mm: tuple[float, float], high_mm: tuple[float, float], pixels_per_mm: float
) -> tuple[Pixels, tuple[float, float]]:
    """Part of a page between two corners in mm from its lower left, and its true pixels per mm along x and y.

    (rows, columns, 3), row 0 the uppermost. The renderer stretches a page to whole pixels.
    """
    import pypdfium2

    document = pypdfium2.PdfDocument(path)
    sheet = document[page]
    width, height = sheet.get_size()
    points = 72 / INCH_MM
    crop = (low_mm[0] * points, low_mm[1] * points, width - high_mm[0] * points, height - high_mm[1] * points)
    image = sheet.render(scale=pixels_per_mm / points, crop=crop).to_pil().convert("RGB")
    document.close()
    true = tuple(math.ceil(side * pixels_per_mm / points) / side * points for side in (width, height))
    return np.asarray(image, dtype=float), (true[0], true[1])


def pdf_size_mm(path: Path, page: int) -> tuple[float, float]:
    """Width and height of a page."""
    import pypdfium2

    document = pypdfium2.PdfDocument(path)
    size = document[page].get_size()
    document.close()
    return size[0] * INCH_MM / 72, size[1] * INCH_MM / 72


def svg_pixels(path: Path, pixels_per_mm: float) -> Pixels:
    """(rows, columns, 3) a whole SVG at its own size."""
    import resvg_py

    data = bytes(resvg_py.svg_to_bytes(svg_path=str(path), dpi=round(pixels_per_mm * INCH_MM), background="white"))
    return np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), dtype=float)


def orange(pixels: Pixels) -> Pixels:
    """(rows, columns) how much of a pixel the check squares cover; no other colour of the sheets counts."""
    red, green, blue = np.moveaxis(pixels, -1, 0)
    return np.clip(np.minimum(green - blue, red - green + 60), 0.0, None)


def lines_mm(cover: Pixels, pixels_per_mm: float) -> list[float]:
    """Middles of the lines that cross all rows of a band, in mm from its left."""
    profile = cover.mean(axis=0)
    on = profile > 0.02 * profile.max()
    starts = np.flatnonzero(on & ~np.r_[False, on[:-1]])
    ends = np.flatnonzero(on & ~np.r_[on[1:], False]) + 1
    middles = []
    for start, end in zip(starts, ends, strict=True):
        columns = np.arange(start, end)
        middles.append(float((profile[columns] * (columns + 0.5)).sum() / profile[columns].sum() / pixels_per_mm))
    return middles


def pdf_words(path: Path, page: int) -> list[str]:
    """All words on a page of a PDF, as another program finds them."""
    import pypdfium2

    document = pypdfium2.PdfDocument(path)
    words = document[page].get_textpage().get_text_range().split()
    document.close()
    return list(words)
