"""The rooms of the house: who may import whom, and what is not found in any of them."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator, Mapping
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from tests.test_rooms import package_of

ROOT = Path(__file__).parents[1]

MAY_IMPORT = {
    "equilibrium": set(),
    "pattern": {"equilibrium"},
    "discrete": {"equilibrium", "pattern"},
    "fem": {"equilibrium"},
    "homogenize": {"discrete", "equilibrium", "pattern"},
    "asterism": {"homogenize", "fem", "discrete", "equilibrium", "pattern"},
}
ENGINES = [name for name in MAY_IMPORT if name != "asterism"]

SOURCES = [file for package in MAY_IMPORT for file in sorted((ROOT / package).rglob("*.py"))]
# everything that people write and read; pieced together, so that this file does not find itself
TEXTS = [
    file
    for place, kinds in (
        (".", ("*.md", "*.toml", "LICENSE")),
        (".ci", ("*",)),
        ("docs", ("**/*.md",)),
        ("benchmarks", ("**/*.py", "**/*.md")),
        ("tests", ("**/*.py",)),
        *((package, ("**/*.py", "**/*.toml")) for package in MAY_IMPORT),
    )
    for kind in kinds
    for file in sorted((ROOT / place).glob(kind))
    if file.is_file()
]
UNFINISHED = re.compile(r"\b(" + "|".join(["TO" + "DO", "FIX" + "ME", "X" * 3]) + r")\b")
MACHINE_PATH = re.compile(r"(?<![\w.~])(/(home|Users|root|work|mnt)/\w|[A-Z]:\\\\?Users)")


def name(file: Path) -> str:
    return str(file.relative_to(ROOT))


@cache
def nodes(file: Path) -> list[ast.AST]:
    """The syntax tree of a file, node by node; each file is parsed once."""
    return list(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))


@cache
def imports(file: Path) -> list[str]:
    """Full names of the modules that a file imports anywhere, also within functions."""
    return list(_imports(file))


def _imports(file: Path) -> Iterator[str]:
    for node in nodes(file):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module == "asterism":
            yield from (f"asterism.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." * node.level + (node.module or "")


def packages(file: Path) -> set[str]:
    """Engines, `asterism` and packages of others that a file imports from."""
    return {package_of(module) for module in imports(file)}


def test_there_is_something_to_check() -> None:
    assert {file.relative_to(ROOT).parts[0] for file in SOURCES} == set(MAY_IMPORT)
    assert len(TEXTS) > len(SOURCES)


@pytest.mark.slow
def test_imports_name_their_package() -> None:
    assert not [(name(file), module) for file in SOURCES for module in imports(file) if module.startswith(".")]


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_imports_go_down_only(package: str) -> None:
    forbidden = {*MAY_IMPORT, "tests"} - {package} - MAY_IMPORT[package]
    files = [file for file in SOURCES if file.relative_to(ROOT).parts[0] == package]
    assert files and not [(name(file), above) for file in files if (above := packages(file) & forbidden)]


def test_pattern_takes_errors_and_types_of_arrays_from_equilibrium_and_no_more() -> None:
    files = [file for file in SOURCES if file.relative_to(ROOT).parts[0] == "pattern"]
    solver = {module for file in files for module in imports(file) if module.split(".")[0] == "equilibrium"}
    assert solver <= {"asterism.equilibrium.errors", "asterism.equilibrium.arrays"}


@cache
def declared() -> set[str]:
    """Packages that pyproject.toml asks for."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    required = project["dependencies"] + [r for group in project["optional-dependencies"].values() for r in group]
    return {re.split(r"[^\w.-]", requirement)[0].lower().replace("_", "-") for requirement in required}


@cache
def installed() -> Mapping[str, list[str]]:
    """Packages by the modules that they hold. All that is installed is looked at."""
    # optional, so perhaps not installed here; and a package that always comes with another
    known = {"sksparse": ["scikit-sparse"], "pydantic_core": ["pydantic"]}
    return {**packages_distributions(), **known}


@pytest.mark.slow
def test_every_package_used_is_a_dependency_in_pyproject() -> None:
    homes, missing = installed(), []
    for file in SOURCES:
        for module in packages(file) - set(MAY_IMPORT) - sys.stdlib_module_names:
            homes_of = {package.lower().replace("_", "-") for package in homes.get(module, [module])}
            if not homes_of & declared():
                missing.append((name(file), module))
    assert not missing


@pytest.mark.slow
def test_a_preview_runs_without_the_exact_model(tmp_path: Path) -> None:
    """What they are compared by must not come from code that both have."""
    (tmp_path / "star.toml").write_text("[stars]\nlength_mm = 9\n[border]\nrings = 0\n")
    program = "import sys; from asterism.cli.main import main; sys.argv[1:] = ['preview', 'star.toml']\n"
    program += "try:\n    main()\nfinally:\n    print(*sys.modules)"
    there = {"cwd": tmp_path, "env": os.environ | {"PYTHONPATH": str(ROOT)}, "capture_output": True, "text": True}
    ran = subprocess.run([sys.executable, "-c", program], check=True, **there)  # type: ignore[call-overload]
    assert (tmp_path / "star" / "summary.json").exists()
    assert not [module for module in ran.stdout.split() if package_of(module) == "discrete"]


def test_triangle_is_called_in_its_guarded_file_only() -> None:
    users = {name(file) for file in SOURCES if "triangle" in packages(file)}
    assert users <= {"pattern/mesh/triangulate.py"}


def test_the_web_server_is_used_by_studio_and_hops_only() -> None:
    users = {name(file) for file in SOURCES if {"starlette", "uvicorn", "websockets"} & packages(file)}
    homes = ("asterism/studio/", "asterism/hops/", "asterism/process/local_server.py")
    assert users and all(user.startswith(homes) for user in users)


@pytest.mark.parametrize("package", ENGINES)
def test_engines_print_nothing(package: str) -> None:
    printing = []
    for file in SOURCES:
        if file.relative_to(ROOT).parts[0] == package:
            for node in nodes(file):
                called = node.func if isinstance(node, ast.Call) else None
                if isinstance(called, ast.Name) and called.id == "print":
                    printing.append(f"{name(file)}:{called.lineno}")
    assert not printing


@pytest.mark.parametrize("pattern", [UNFINISHED, MACHINE_PATH], ids=["finished", "without paths of one machine"])
def test_texts_are(pattern: re.Pattern[str]) -> None:
    found = []
    for file in TEXTS:
        text = file.read_text(encoding="utf-8")
        if pattern.search(text):
            lines = enumerate(text.splitlines(), start=1)
            found += [f"{name(file)}:{number}: {line.strip()}" for number, line in lines if pattern.search(line)]
    assert not found


def test_the_command_line_toolkit_stays_in_the_command_line() -> None:
    users = {name(file) for file in SOURCES if "typer" in imports(file)}
    assert users and all(user.startswith("asterism/cli/") for user in users)
