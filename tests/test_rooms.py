"""The rooms of the house: who may import whom, in no circle, and what is not found in any of them."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tomllib
from functools import cache
from graphlib import TopologicalSorter
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAY_IMPORT = {
    "equilibrium": set(),
    "pattern": {"equilibrium"},
    "discrete": {"equilibrium", "pattern"},
    "fem": {"equilibrium"},
    "homogenize": {"discrete", "equilibrium", "pattern"},
    "asterism": {"homogenize", "fem", "discrete", "equilibrium", "pattern"},
}
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
# packages that only some files use
HOMES = {
    ("triangle",): "pattern/mesh/triangulate.py",
    ("starlette", "uvicorn", "websockets"): ("asterism/studio/", "asterism/hops/", "asterism/process/local_server.py"),
    ("typer",): "asterism/cli/",
}
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


def module_of(file: Path) -> str:
    """The name by which a file of the checkout is imported: all of it is in `asterism`."""
    first, *rest = file.relative_to(ROOT).with_suffix("").parts
    inside = rest if first == "asterism" else [first, *rest]
    return ".".join(["asterism", *inside]).removesuffix(".__init__")


FILES = {module_of(file): file for package in MAY_IMPORT for file in sorted((ROOT / package).rglob("*.py"))}


def package_of(module: str) -> str:
    """The engine to which a module belongs, or else its package of the first level."""
    first, *rest = module.split(".")
    return rest[0] if first == "asterism" and rest and rest[0] in MAY_IMPORT else first


def name(module: str) -> str:
    return str(FILES[module].relative_to(ROOT))


@cache
def nodes(module: str) -> list[ast.AST]:
    """The syntax tree of a file, node by node; each file is parsed once."""
    return list(ast.walk(ast.parse(FILES[module].read_text(encoding="utf-8"))))


@cache
def imported(module: str) -> frozenset[str]:
    """Modules that a module imports anywhere, also within functions and for type checking only."""
    found = set()
    for node in nodes(module):
        if isinstance(node, ast.ImportFrom):
            whole = "." * node.level + (node.module or "")
            inner = {alias.name: f"{whole}.{alias.name}" for alias in node.names}
            found |= {inner[alias] if inner[alias] in FILES else whole for alias in inner}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return frozenset(found)


def rank(module: str) -> tuple[str, int, str] | None:
    """Package, height and name of a module's room; None for modules outside the ordered rooms."""
    package = package_of(module)
    rest = module.split(".")[1 if package == "asterism" else 2 :]
    for height, rooms in enumerate(ORDER.get(package, [])):
        if rest and rest[0] in rooms:
            return package, height, rest[0]
    return None


def is_allowed(module: str, other: str) -> bool:
    """Whether a module may import another, by its full name: of its engine and room, or of lower ones."""
    package, needed = package_of(module), package_of(other)
    above, below = rank(module), rank(other)
    if other.startswith(".") or needed == "tests" or needed in MAY_IMPORT.keys() - {package} - MAY_IMPORT[package]:
        return False
    return not (above and below and above[0] == below[0] and above[2] != below[2] and below[1] >= above[1])


def test_imports_go_down_only() -> None:
    assert {package_of(module) for module in FILES} == set(MAY_IMPORT) and len(TEXTS) > len(FILES)
    for package, rows in ORDER.items():
        folders = {file.parent.name for file in (ROOT / package).glob("*/__init__.py")}
        assert folders == {room for row in rows for room in row}
    assert [f"{m} imports {other}" for m in FILES for other in imported(m) if not is_allowed(m, other)] == []
    # of the solver's package, drawn patterns know no solver
    used = {other for module in FILES if package_of(module) == "pattern" for other in imported(module)}
    solver = {other for other in used if package_of(other) == "equilibrium"}
    assert solver == {"asterism.equilibrium.errors", "asterism.equilibrium.arrays"}


def test_no_import_leads_back() -> None:
    # of a circle its error names all modules
    TopologicalSorter({module: imported(module) & FILES.keys() for module in FILES}).prepare()


def test_every_package_used_is_a_dependency_in_pyproject() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    required = project["dependencies"] + [r for group in project["optional-dependencies"].values() for r in group]
    declared = {re.split(r"[^\w.-]", requirement)[0].lower().replace("_", "-") for requirement in required}
    # optional, so perhaps not installed here; and a package that always comes with another
    homes = {**packages_distributions(), "sksparse": ["scikit-sparse"], "pydantic_core": ["pydantic"]}
    used = {package_of(other) for module in FILES for other in imported(module)}
    foreign = used - set(MAY_IMPORT) - sys.stdlib_module_names
    assert not [
        each for each in foreign if not {h.lower().replace("_", "-") for h in homes.get(each, [each])} & declared
    ]


@pytest.mark.parametrize("packages", HOMES, ids=lambda packages: packages[0])
def test_some_packages_are_used_in_their_files_only(packages: tuple[str, ...]) -> None:
    users = [name(module) for module in FILES if {package_of(other) for other in imported(module)} & set(packages)]
    assert users and [user for user in users if not user.startswith(HOMES[packages])] == []


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


def test_engines_print_nothing() -> None:
    engines = [module for module in FILES if package_of(module) != "asterism"]
    names = [(module, node) for module in engines for node in nodes(module) if isinstance(node, ast.Name)]
    assert [f"{name(module)}:{node.lineno}" for module, node in names if node.id == "print"] == []


@pytest.mark.parametrize("pattern", [UNFINISHED, MACHINE_PATH], ids=["finished", "without paths of one machine"])
def test_texts_are(pattern: re.Pattern[str]) -> None:
    found = []
    for file in TEXTS:
        text = file.read_text(encoding="utf-8")
        if pattern.search(text):
            lines = enumerate(text.splitlines(), start=1)
            found += [f"{file.name}:{number}: {line.strip()}" for number, line in lines if pattern.search(line)]
    assert not found
