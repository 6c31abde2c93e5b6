"""What the studio offers on its first page: designs of the gallery, and design files in the folder."""

from __future__ import annotations

import re
from contextlib import suppress
from functools import cache, lru_cache
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from asterism.pattern import gallery
from asterism.pattern.design.files import read_bytes
from asterism.pattern.layout.build import layout
from asterism.studio.autosave import autosaves, design_name

PICTURES = Path(__file__).parent / "gallery"
MAX_FILES = 50
# lines of a design file in TOML's ways of writing: tables, dotted keys, inline tables
PARTS_OF_DESIGN = [
    re.compile(rb"^\s*\[{0,2}\s*(%s)\s*[].=]" % names, re.MULTILINE) for names in (b"border", b"stars|rods")
]


@cache
def gallery_entries() -> tuple[dict[str, Any], ...]:
    """Name, title, numbers of stars and rods, and printed size (mm) of each design of the gallery and each pattern."""
    entries = []
    for name in (*gallery.names(), *gallery.pattern_names()):
        sheet = layout(gallery.load(name))
        size = np.ptp(sheet.outline, axis=0)
        entries.append(
            {
                "name": name,
                "title": _title(gallery.path(name).read_text(encoding="utf-8")),
                "stars": len(sheet.centres),
                "rods": len(sheet.drawn_rods),
                "size_mm": [round(float(side), 1) for side in size],
                "has_picture": (PICTURES / f"{name}.png").is_file(),
            }
        )
    return tuple(entries)


def _title(text: str) -> str:
    """The first sentence of the comment at the head of a design file."""
    comment = " ".join(line.lstrip("# ") for line in re.match(r"(#.*\n)*", text)[0].splitlines())  # type: ignore[index]
    return re.split(r"(?<=[.:])\s", comment)[0].rstrip(":") if comment else ""


def design_files(folder: Path) -> list[str]:
    """Names of the design files in a folder, the newest first; also of designs that exist as autosaves only."""
    times: dict[str, float] = {}
    for file in folder.glob("*.toml"):
        name = design_name(file.name) or file.name
        with suppress(OSError):
            stamp = file.stat()
            if not name.startswith(".") and _is_design(file, stamp.st_mtime_ns, stamp.st_size):
                times[name] = max(stamp.st_mtime, times.get(name, 0.0))
    return sorted(times, key=lambda name: times[name], reverse=True)


@lru_cache(maxsize=4096)  # the first page asks for the list every few seconds
def _is_design(file: Path, mtime_ns: int, size: int) -> bool:
    """Whether a file of this time and size looks like a design: it has a border, and stars or rods."""
    text = read_bytes(file)
    return all(part.search(text) for part in PARTS_OF_DESIGN)


def free_name(folder: Path, stem: str) -> Path:
    """A name for a new design file in a folder: `stem.toml`, or `stem-2.toml` and so on if that is taken."""
    paths = (folder / (f"{stem}.toml" if number == 1 else f"{stem}-{number}.toml") for number in count(1))
    return next(path for path in paths if not path.exists() and not autosaves(path))
