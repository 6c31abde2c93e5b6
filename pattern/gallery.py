"""Designs ready to use: those of the paper's figures, drawn patterns of other works, and templates to start from."""

from __future__ import annotations

import re
from pathlib import Path

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import load_design

_FOLDERS = {name: Path(__file__).parent / name for name in ("templates", "gallery", "patterns")}


def names() -> list[str]:
    """Names of the designs of the paper's figures, in alphabetical order."""
    return _names_in("gallery")


def pattern_names() -> list[str]:
    """Names of the drawn patterns, in alphabetical order.

    >>> pattern_names()[:2]
    ['diamond-auxetic', 'honeycomb']
    """
    return _names_in("patterns")


def template_names() -> list[str]:
    """Names of the templates, in alphabetical order.

    >>> template_names()
    ['arch', 'canopy', 'saddle']
    """
    return _names_in("templates")


def _names_in(folder: str) -> list[str]:
    return sorted(path.stem for path in _FOLDERS[folder].glob("*.toml"))


def path(name: str) -> Path:
    """File of a design, a pattern or a template, with comments on its source and on what was chosen.

    Raises `DesignError` if there is no design of this name.
    """
    known = {each: folder / f"{each}.toml" for key, folder in _FOLDERS.items() for each in _names_in(key)}
    if name not in known:
        raise DesignError("", f"is not in the gallery; there are {', '.join(known)}", name)
    return known[name]


def load(name: str) -> Design:
    """A design of the gallery, a pattern, or a template."""
    return load_design(path(name))


def words(name: str) -> str:
    """One sentence on a design: the first one of the comment in its file.

    >>> words("arch")
    'An arch: two opposite edges stand on the ground, and the sheet bends up between them.'
    """
    comment = re.match(r"(#.*\n)*", path(name).read_text(encoding="utf-8"))
    text = " ".join(line.lstrip("# ") for line in comment[0].splitlines()) if comment else ""
    return re.split(r"(?<=\.)\s", text)[0]
