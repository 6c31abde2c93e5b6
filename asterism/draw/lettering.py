"""Letters of pictures: matplotlib's fonts for Pillow, which starts faster than matplotlib's figures."""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec
from pathlib import Path

from PIL import ImageFont

# all letters below this number, those of European languages, are in the usual font; the tests check it
FIRST_RARE_LETTER = 0x250


def lettered(text: str, pixels: float, bold: bool = False) -> list[tuple[ImageFont.FreeTypeFont, str]]:
    """Parts of a text, each with a font of this size that has its letters.

    >>> [part for _, part in lettered("7 × 3 mm", 20.0)]
    ['7 × 3 mm']
    """
    if all(ord(letter) < FIRST_RARE_LETTER and letter.isprintable() for letter in text):
        return [(_font(usual_font(bold), pixels), text)]
    from asterism.draw.fonts import font_runs  # imports matplotlib, which takes long, for names with other letters

    return [(_font(file, pixels), run) for file, run in font_runs(text, bold)]


@cache
def usual_font(bold: bool) -> str:
    """File of the usual font in matplotlib's data; matplotlib itself is not imported."""
    package = find_spec("matplotlib")
    assert package is not None and package.origin is not None
    fonts = Path(package.origin).parent / "mpl-data" / "fonts" / "ttf"
    return str(fonts / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"))


@cache
def _font(file: str, pixels: float) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(file, pixels)
