"""The order of the rooms: imports go down only and in no circle."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("equilibrium", "pattern", "discrete", "fem", "homogenize", "asterism")

# rooms inside a package from the bottom up; a room may import those of lower rows, and a row's rooms not each other
ORDER: dict[str, list[list[str]]] = {
    "pattern": [["geometry"], ["drawing"], ["design"], ["rods"], ["layout"], ["mesh"]],
    "asterism": [
        ["process"],
        ["results"],
        ["draw"],
        ["shape"],
        ["exact", "previews"],
        ["laws"],
        ["verification"],
        ["print"],
        ["measure"],
        ["fitting"],
        ["reports"],
        ["sweeps"],
        ["studio"],
        ["notebook", "hops"],
        ["cli"],
    ],
}


def module_of(file: Path) -> str:
    """The name by which a file of the checkout is imported: all of it is in `asterism`."""
    first, *rest = file.relative_to(ROOT).with_suffix("").parts
    inside = rest if first == "asterism" else [first, *rest]
    return ".".join(["asterism", *inside]).removesuffix(".__init__")


FILES = {module_of(file): file for package in PACKAGES for file in sorted((ROOT / package).rglob("*.py"))}


def package_of(module: str) -> str:
    """The engine to which a module belongs, or else its package of the first level."""
    first, *rest = module.split(".")
    return rest[0] if first == "asterism" and rest and rest[0] in PACKAGES else first


@cache
def tree(module: str) -> ast.Module:
    return ast.parse(FILES[module].read_text(encoding="utf-8"))


@cache
def imported(module: str) -> frozenset[str]:
    """Modules of the project that a module imports anywhere, also within functions and for type checking only."""
    found = set()
    for node in ast.walk(tree(module)):
        if isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found.add(inner if inner in FILES else node.module)
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return frozenset(found & FILES.keys())


def reached(module: str) -> set[str]:
    """Modules that are imported by way of others."""
    seen: set[str] = set()
    left = [module]
    while left:
        for other in imported(left.pop()) - seen:
            seen.add(other)
            left.append(other)
    return seen


@pytest.mark.slow
def test_no_import_leads_back() -> None:
    assert [module for module in FILES if module in reached(module)] == []


def rank(module: str) -> tuple[str, int, str] | None:
    """Package, height and name of a module's room; None for modules outside the ordered rooms."""
    package = package_of(module)
    rest = module.split(".")[1 if package == "asterism" else 2 :]
    for height, rooms in enumerate(ORDER.get(package, [])):
        if rest and rest[0] in rooms:
            return package, height, rest[0]
    return None


@pytest.mark.parametrize("package", ORDER)
def test_every_room_has_a_place_in_the_order(package: str) -> None:
    folders = {file.parent.name for file in (ROOT / package).glob("*/__init__.py")}
    assert folders == {room for row in ORDER[package] for room in row}


def test_rooms_import_lower_rooms_only() -> None:
    wrong = []
    for module in FILES:
        for other in imported(module):
            above, below = rank(module), rank(other)
            if above and below and above[0] == below[0] and above[2] != below[2] and below[1] >= above[1]:
                wrong.append(f"{module} imports {other}")
    assert wrong == []
