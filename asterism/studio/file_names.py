"""Files below one folder, by names that come from outside."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asterism.equilibrium.errors import Error
from asterism.pattern.design.errors import DesignError

MAX_NAME_CHARACTERS = 200


class FileNameError(Error, ValueError):
    """A name that does not lead to a file below the folder of the design."""


def file_below(folder: Path, name: str) -> Path:
    """The path of a file below a folder.

    Raises
    ------
    FileNameError
        The name is empty, absolute or hidden, holds characters that cannot be printed, or leads out of the folder, also
        by a symbolic link.
    """
    if not isinstance(name, str) or not 0 < len(name) <= MAX_NAME_CHARACTERS or not name.isprintable():
        raise FileNameError("a file's name must be 1 to 200 printable characters")
    parts = name.replace("\\", "/").split("/")
    root = folder.resolve()
    path = (root / name).resolve()
    if any(part.startswith(".") or not part or ":" in part for part in parts) or not path.is_relative_to(root):
        raise FileNameError(f"{name!r} must be the name of a file below the design's folder")
    return path


def check_files(value: Any, folder: Path) -> None:
    """Refuse changes of a design that name files outside a folder: they come from a page, and such files are read.

    Raises
    ------
    DesignError
        A sizing profile, a drawing or an outline names a file that is not below the folder.
    """
    if isinstance(value, list):
        for inner in value:
            check_files(inner, folder)
    if not isinstance(value, Mapping):
        return
    # a file is not read where its content is stored
    is_read = not any(value.get(key) for key in ("grey", "lines", "rings_mm", "polygon_mm"))
    for key, inner in value.items():
        check_files(inner, folder)
        name = key.rpartition(".")[2]
        if name in ("image", "file") and isinstance(inner, str) and is_read:
            try:
                file_below(folder, inner)
            except FileNameError as error:
                raise DesignError(name, str(error)) from None


def shown_path(path: Path) -> str:
    """A path as people write it: from the home folder on, if it is in there and the system has such a name for it."""
    home = Path.home()
    if os.name == "nt" or not path.is_relative_to(home):
        return str(path)
    return str("~" / path.relative_to(home))
