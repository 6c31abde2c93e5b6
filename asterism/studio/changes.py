"""The files that changes of a design may name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asterism.pattern.design.errors import DesignError
from asterism.studio.file_names import FileNameError, file_below


def check_files(value: Any, folder: Path) -> None:
    """Refuse files outside a folder: changes come from a page, and files of pictures and drawings are read.

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
