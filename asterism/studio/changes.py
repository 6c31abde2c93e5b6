"""Changes of a design file's table by dotted keys."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asterism.pattern.design.errors import DesignError
from asterism.studio.file_names import FileNameError, file_below

MAX_DEPTH = 8


def with_changes(table: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """The table with other values at some keys; None takes a key away.

    Parameters
    ----------
    changes : dotted keys of the design file, as `fabric.stretch`, `border` or `rods.draw.0.width_mm`, and their values.

    Raises
    ------
    DesignError
        A key leads through something that is not a table, or the values are nested too deeply.

    Examples
    --------
    >>> with_changes({"name": "a", "fabric": {"stretch": 1.35}}, {"fabric.stretch": 1.75, "name": None})
    {'fabric': {'stretch': 1.75}}
    >>> with_changes({"rods": {"draw": [{"width_mm": 1.0}]}}, {"rods.draw.0.width_mm": 2.0})
    {'rods': {'draw': [{'width_mm': 2.0}]}}
    """
    changed = dict(table)
    for key, value in changes.items():
        if not isinstance(key, str) or not 1 <= len(parts := key.split(".")) <= MAX_DEPTH or not all(parts):
            raise DesignError("", "must be a key of the design file, as fabric.stretch", key)
        _check_depth(key, value)
        _set(changed, parts, value, key)
    return changed


def _set(table: dict[str, Any] | list[Any], parts: list[str], value: Any, key: str) -> None:
    """Set one key; tables and lists on the way are copied, so that the old table stays as it was."""
    first, *rest = parts
    if isinstance(table, list):
        if not rest or not first.isdecimal() or int(first) >= len(table):
            raise DesignError(key, f"{first} is not the number of a table in a list of {len(table)}")
        place: Any = int(first)
        inner = table[place]
    else:
        place = first
        if not rest:
            if value is None:
                table.pop(first, None)
            else:
                table[first] = value
            return
        inner = table.get(first, {})
    if not isinstance(inner, dict | list):
        raise DesignError(key, f"{first} is not a table of keys")
    table[place] = inner.copy()
    _set(table[place], rest, value, key)


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


def _check_depth(key: str, value: Any, depth: int = 0) -> None:
    if depth > MAX_DEPTH:
        raise DesignError(key, "is nested too deeply")
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        _check_depth(key, inner, depth + 1)
