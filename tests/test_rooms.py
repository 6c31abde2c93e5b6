"""The order of the rooms: imports go down only and in no circle, names have one meaning, files stay short."""

from __future__ import annotations

import ast
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("equilibrium", "pattern", "discrete", "fem", "homogenize", "asterism")
MAX_LINES = 350

# rooms inside a package from the bottom up; a room may import those of lower rows, and a row's rooms not each other
ORDER: dict[str, list[list[str]]] = {
    "pattern": [["geometry"], ["design"], ["rods"], ["layout"], ["mesh"]],
    "asterism": [
        ["process"],
        ["results"],
        ["shape"],
        ["draw"],
        ["exact", "previews"],
        ["laws"],
        ["verification"],
        ["print"],
        ["measure"],
        ["fitting"],
        ["reports"],
        ["sweeps"],
        ["studio"],
        ["notebook"],
        ["cli"],
    ],
}

FILES = {
    ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): file
    for package in PACKAGES
    for file in sorted((ROOT / package).rglob("*.py"))
}


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


def test_no_import_leads_back() -> None:
    assert [module for module in FILES if module in reached(module)] == []


def rank(module: str) -> tuple[str, int, str] | None:
    """Package, height and name of a module's room; None for modules outside the ordered rooms."""
    package, *rest = module.split(".")
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


def test_files_stay_short() -> None:
    lines = {module: len(file.read_text(encoding="utf-8").splitlines()) for module, file in FILES.items()}
    assert not {module: count for module, count in lines.items() if count > MAX_LINES}


def defined(kinds: tuple[type[ast.AST], ...]) -> dict[str, list[str]]:
    """Public names at the top of modules by the modules that define them."""
    found: dict[str, list[str]] = defaultdict(list)
    for module in FILES:
        for node in tree(module).body:
            if isinstance(node, kinds) and isinstance(node, ast.ClassDef | ast.FunctionDef):
                found[node.name].append(module)
            elif isinstance(node, kinds) and isinstance(node, ast.Assign | ast.AnnAssign):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                for target in targets:
                    for name in ast.walk(target):
                        if isinstance(name, ast.Name):
                            found[name.id].append(module)
    return {name: modules for name, modules in found.items() if not name.startswith("_")}


def test_no_class_has_the_name_of_another() -> None:
    assert {name: modules for name, modules in defined((ast.ClassDef,)).items() if len(modules) > 1} == {}


def test_no_constant_has_the_name_of_another() -> None:
    constants = defined((ast.Assign, ast.AnnAssign))
    assert {name: at for name, at in constants.items() if name.isupper() and len(set(at)) > 1} == {}


def test_no_alias_is_defined_twice() -> None:
    """Aliases of types, such as `Floats`, are capitalised names that are assigned at the top of a module."""
    aliases = {
        name: at
        for name, at in defined((ast.Assign, ast.AnnAssign)).items()
        if name[0].isupper() and not name.isupper()
    }
    assert {name: at for name, at in aliases.items() if len(set(at)) > 1} == {}


def is_command(node: ast.stmt) -> bool:
    """Whether a statement defines a command of the command line."""
    decorators = node.decorator_list if isinstance(node, ast.FunctionDef) else []
    return any(isinstance(each, ast.Name) and each.id == "command" for each in decorators)


def test_no_function_has_the_name_of_another() -> None:
    """A command carries its word on the command line, which is also the name of the public function behind it."""
    commands = {(node.name, module) for module in FILES for node in tree(module).body if is_command(node)}
    functions = {
        name: [module for module in modules if (name, module) not in commands]
        for name, modules in defined((ast.FunctionDef,)).items()
    }
    assert {name: modules for name, modules in functions.items() if len(modules) > 1} == {}


def test_no_class_has_the_name_of_a_function_or_an_alias() -> None:
    others = defined((ast.FunctionDef, ast.Assign, ast.AnnAssign))
    assert {name: [*at, *others[name]] for name, at in defined((ast.ClassDef,)).items() if name in others} == {}
