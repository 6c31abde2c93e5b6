"""Designs of the paper's figures, ready to use."""

from __future__ import annotations

from pathlib import Path

from pattern.design.design import Design
from pattern.layout.load_design import load_design

_FOLDER = Path(__file__).parent / "gallery"


def names() -> list[str]:
    """Names of the designs, in alphabetical order."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def path(name: str) -> Path:
    """File of a design, with comments that say what the paper says and what was chosen."""
    if name not in names():
        raise KeyError(f"no design {name!r} in the gallery; there are {', '.join(names())}")
    return _FOLDER / f"{name}.toml"


def load(name: str) -> Design:
    """A design of the gallery."""
    return load_design(path(name))
