"""The rooms of `pattern` build on each other in one order."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import pattern

ROOT = Path(pattern.__path__[0])
ORDER = ("geometry", "design", "rods", "layout", "mesh")
FILES = [file for room in ORDER for file in sorted((ROOT / room).rglob("*.py"))]


def imported(file: Path) -> set[str]:
    """Rooms of `pattern` that a file imports, also within functions."""
    nodes = [node for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))) if isinstance(node, ast.ImportFrom)]
    names = [node.module.split(".") for node in nodes if node.module]
    return {name[1] for name in names if name[0] == "pattern" and len(name) > 1}


def test_all_rooms_have_a_place_in_the_order() -> None:
    assert {folder.name for folder in ROOT.iterdir() if (folder / "__init__.py").exists()} == set(ORDER)
    assert [line for line in (pattern.__doc__ or "").splitlines() if line in ORDER] == list(ORDER)


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_rooms_import_earlier_rooms_only(file: Path) -> None:
    room = file.relative_to(ROOT).parts[0]
    assert imported(file) <= set(ORDER[: ORDER.index(room) + 1])
