"""Fonts of pictures: names may have letters that the usual font lacks."""

from __future__ import annotations

from functools import cache
from typing import Any

from matplotlib import font_manager
from matplotlib.figure import Figure

from asterism.draw.style import INK

# common fonts with the letters of other scripts, those of Linux, Windows and macOS; whichever are installed
OTHER_FAMILIES = (
    "Noto Sans CJK SC", "Noto Sans CJK JP", "Noto Sans CJK KR", "Source Han Sans SC", "WenQuanYi Zen Hei",
    "WenQuanYi Micro Hei", "Droid Sans Fallback", "Microsoft YaHei", "SimHei", "Yu Gothic", "Malgun Gothic",
    "PingFang SC", "Hiragino Sans GB", "Arial Unicode MS", "Noto Sans", "Noto Sans Devanagari", "Noto Sans Thai",
)  # fmt: skip


@cache
def families() -> list[str]:
    """The usual family, and the installed ones with further letters."""
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return ["DejaVu Sans", *(name for name in OTHER_FAMILIES if name in installed)]


def printable(text: str) -> str:
    """The text with letters that no installed font has as their numbers; they would be drawn as boxes."""
    known = _letters()
    return "".join(letter if ord(letter) in known or letter == "\n" else f"<U+{ord(letter):04X}>" for letter in text)


def font_runs(text: str, bold: bool) -> list[tuple[str, str]]:
    """Parts of a text, each with the file of the first font of `families` that has its letters, for drawing by file."""
    weight = "bold" if bold else "normal"
    files = [font_manager.findfont(font_manager.FontProperties(family=name, weight=weight)) for name in families()]
    runs: list[tuple[str, str]] = []
    for letter in printable(text).replace("\n", " "):
        file = next((file for file in files if ord(letter) in _letters_of(file)), files[0])
        if runs and runs[-1][0] == file:
            runs[-1] = (file, runs[-1][1] + letter)
        else:
            runs.append((file, letter))
    return runs


def write_title(figure: Figure, x: float, y: float, text: str, size: float) -> None:
    """Write a title with names at (x, y), parts of the figure's width and height; `$` does not start an equation."""
    style: dict[str, Any] = {"weight": "bold", "color": INK, "parse_math": False}
    figure.text(x, y, printable(text), family=families(), fontsize=size, **style)


@cache
def _letters() -> frozenset[int]:
    """The numbers of all letters in the fonts of `families`."""
    files = (font_manager.findfont(font_manager.FontProperties(family=name)) for name in families())
    return frozenset(number for file in files for number in _letters_of(file))


@cache
def _letters_of(file: str) -> frozenset[int]:
    """The numbers of all letters in the font of a file."""
    return frozenset(font_manager.get_font(file).get_charmap())
