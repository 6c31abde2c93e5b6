"""One case: files in a folder and a command line, all from the number of the case."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.pattern.design.files import table_text
from benchmarks.fuzz.kit import DESIGNS, MATERIAL
from benchmarks.fuzz.mutations import Rng, json_text, mutated_archive, mutated_bytes, mutated_cells, mutated_table, pick

# the seed of all cases; a case is this seed with its number
SEED = 20251125
# largest mesh of a case with the exact model: others are left to the preview
MAX_VERTICES = 1500
KEYS = ("length_mm", "thickness_mm", "width_mm", "rings", "scale", "where", "polygon_mm", "on", "seed", "kind")
ODD_OPTIONS = (
    "0", "-1", "1e9", "nan", "inf", "", "x", "0.05", "0.3", "0.5", "0.8", "1.35", "2", "3", "5", "10", "45", "1000000",
    "\u661f", "none.toml", "design.json", "out", "prusa-mk4", "ender-3", "pla", "mm", "cm", "in", "auto", "up", "down",
    "paper", "consistent", "none", "timoshenko", "zero", "per-thickness", "superlu", "amg", "flat", "bump", "above",
)  # fmt: skip
# parameters of sweeps that some designs can have, entries, and values
SWEPT = (
    "stars.length_mm=6,8", "stars.length_mm=5:14:3", "stars.thickness_mm=0.3:0.5:3", "stars.thickness_mm=0.2:0.6",
    "stars.width_mm=0.8,2", "border.rings=1,2", "border.rings=0:2", "fabric.stretch=1.35,1.75", "gravity.on=true,false",
    "pins.0.scale=0.5:0.95:3", "pins.0.step=0:1", "mesh.edge_mm=4,6", "lattice.spacing_mm=15:20:2", "solver.seed=1:9",
    "fabric.bending=paper,none", "stars.length_mm.from=6:12:3", "stars.override.0.thickness_mm=0.3,0.6",
    "border.polygon_mm.0.0=-30:-20:2", "border.star_margin_mm=2:9", "lattice.orientation_deg=0:90:3",
    'stars.length_mm=7,{"profile": "radial", "from": 9, "to": 5, "over_mm": 60}',
)  # fmt: skip
SWEPT_PATHS = (
    "stars.length_mm", "stars.thickness_mm", "stars.width_mm", "stars.length_mm.from", "stars.override.0.thickness_mm",
    "stars.override[0].remove", "border.rings", "border.polygon_mm.0.1", "pins.0.scale", "pins.1.step", "pins.0.where",
    "pins", "fabric.stretch", "fabric.thickness_mm", "fabric.bending", "gravity.on", "solver.seed", "solver.start",
    "mesh.edge_mm", "lattice.spacing_mm", "lattice.arms", "lattice", "name", "material.law", "stars.lenght_mm",
    "stars", "", ".", "stars.", "stars..length_mm", "pins.9.scale", "pins.-1.scale", "\u661f",
)  # fmt: skip
SWEPT_VALUES = (
    "0.3,0.4", "0.3:0.5:3", "0.3:0.5", "6:9:2", "1:3", "1:3:3", "1,2", "true,false", "paper,none", "flat,bump",
    "nan:1:2", "0:inf:2", "1:2:1", "1:2:-1", "1:2:1e9", "1:2:100000", "1:1:2", "2:1", "1:2:3:4", ":", "::", ",",
    "0.3,0.3", "0.3,", "x", "[1.3,1.4],1.35", "[[", '{"formula": "7+x/50"},8', '{"a"', "null", "1e308:1e309:2",
    "-1:1:2", "1e-300,1e300", "0.3:0.4:2,0.5", "\u661f,\u2603", "none.npz,law.npz",
)  # fmt: skip
OPTIONS: dict[str, tuple[str, ...]] = {
    "preview": ("--side", "--law", "--material", "-o", "--strict", "--quiet"),
    "simulate": ("--edge", "--start", "--seed", "--fabric-bending", "--backend", "-o", "--material", "--strict"),
    "verify": ("--edge", "--law", "--backend", "-o"),
    "export": (
        "--printer", "--plastic", "--first-layer", "--layer", "--plate", "--fabric", "--turn", "--needle-spacing",
        "--no-border", "--shape", "-o",
    ),
    "report": ("--results", "--printer", "--plastic", "-o"),
    "strips fit": ("--kappa-bar", "--stretch", "--flat-height", "--confidence", "--rest-curvature", "--outside", "-o"),
    "strips new": ("--thickness", "--count", "--length", "--width", "--stretch", "--plate", "--fabric", "--printer"),
    "compare": ("--units", "--view", "--trim", "-o"),
    "law show": ("-o",),
    "law errors": ("--quiet",),
    "new": ("-o",),
    "printers": (),
    "sweep": ("--samples", "--seed", "--jobs", "--law", "--material", "-o", "--strict", "--quiet"),
    "compare-designs": ("--printer", "--plastic", "--law", "--material", "-o", "--strict", "--quiet"),
}  # fmt: skip
FLAGS = ("--strict", "--quiet", "--no-border", "--outside")


@dataclass(frozen=True)
class Case:
    """A case: its number, the kind of input that is mutated, and the words of the command line."""

    number: int
    kind: str
    words: tuple[str, ...]


def make_case(number: int, kit: Path, folder: Path) -> Case:
    """Write the files of a case into an empty folder, and return it."""
    rng = np.random.default_rng([SEED, number])
    kind = pick(rng, KINDS)
    return Case(number, kind, tuple(MAKERS[kind](rng, kit, folder)))


def _design(rng: Rng, folder: Path, intact: bool = False) -> str:
    """Write a design, as JSON or TOML; returns the name of its file."""
    table = DESIGNS[pick(rng, DESIGNS)]
    if not intact and rng.random() < 0.8:
        table = mutated_table(table, rng, KEYS)
    text, name = json_text(table), "design.json"
    if rng.random() < 0.6:
        text, name = _toml(table) or text, "design.toml"
    content = text.encode("utf-8", "surrogatepass")
    if not intact and rng.random() < 0.1:
        content = mutated_bytes(content, rng)
    (folder / name).write_bytes(content)
    return name


def _toml(table: dict[str, Any]) -> str:
    """The TOML of a table; empty for lists in which tables and numbers are mixed, which TOML writes in another way."""
    try:
        return table_text(table, Path("a.toml"))
    except (AttributeError, TypeError, ValueError):
        return ""


def _exact_is_small(name: str, folder: Path) -> bool:
    """Whether the exact model takes a second or two, or refuses the design."""
    from asterism.equilibrium.errors import Error
    from asterism.exact.cost import exact_cost
    from asterism.pattern.layout.load_design import load_design

    try:
        return exact_cost(load_design(folder / name)).vertices <= MAX_VERTICES
    except Error:
        return True


def _designs(rng: Rng, kit: Path, folder: Path) -> list[str]:
    name = _design(rng, folder)
    command = pick(rng, ["preview"] * 5 + ["export"] * 3 + ["simulate"] * 2 + ["verify", "report"])
    if command in ("simulate", "verify") and not _exact_is_small(name, folder):
        command = "preview"
    return [command, name]


def _materials(rng: Rng, kit: Path, folder: Path) -> list[str]:
    content = _toml(mutated_table(MATERIAL, rng, ("modulus_mpa", "plan", "lattice"))).encode()
    (folder / "material.toml").write_bytes(mutated_bytes(content, rng) if rng.random() < 0.3 else content)
    return [
        pick(rng, ["preview", "export", "simulate"]),
        _design(rng, folder, intact=True),
        "--material",
        "material.toml",
    ]


def _strips(rng: Rng, kit: Path, folder: Path) -> list[str]:
    text = mutated_cells((kit / "strips.csv").read_text(), rng)
    (folder / "strips.csv").write_bytes(mutated_bytes(text.encode(), rng) if rng.random() < 0.3 else text.encode())
    kinds = ("zero", "constant", "per-thickness")
    options = ["--kappa-bar", pick(rng, kinds)] if rng.random() < 0.5 else []
    return ["strips", "fit", "strips.csv", *options]


def _laws(rng: Rng, kit: Path, folder: Path) -> list[str]:
    content = (kit / "law.npz").read_bytes()
    (folder / "law.npz").write_bytes(
        mutated_archive(content, rng) if rng.random() < 0.8 else mutated_bytes(content, rng)
    )
    if rng.random() < 0.5:
        return ["law", "show", "law.npz"]
    return ["preview", _design(rng, folder, intact=True), "--law", "law.npz"]


def _scans(rng: Rng, kit: Path, folder: Path) -> list[str]:
    name = pick(rng, ["scan.obj", "scan.stl", "scan.ply", "text.ply", "text.stl"])
    (folder / name).write_bytes(mutated_bytes((kit / name).read_bytes(), rng))
    return ["compare", str(kit / "shape"), name]


def _targets(rng: Rng, kit: Path, folder: Path) -> list[str]:
    """A surface for which a design is fitted, without the exact check."""
    name = pick(rng, ["scan.obj", "scan.stl", "text.ply"])
    (folder / name).write_bytes(mutated_bytes((kit / name).read_bytes(), rng))
    return ["fit", name, "--no-exact", "--needles", pick(rng, ["0", "3"])]


def _drawings(rng: Rng, kit: Path, folder: Path) -> list[str]:
    name = pick(rng, ["outline.svg", "outline.csv"])
    (folder / name).write_bytes(mutated_bytes((kit / name).read_bytes(), rng))
    return ["compare", str(kit / "shape"), name, "--view", pick(rng, ["above", "front", "side"])]


def _shapes(rng: Rng, kit: Path, folder: Path) -> list[str]:
    """Results of an earlier command that are damaged."""
    shutil.copytree(kit / "shape", folder / "shape")
    name = pick(rng, ["summary.json", "shape.vtu", "rods.vtu"])
    (folder / "shape" / name).write_bytes(mutated_bytes((kit / "shape" / name).read_bytes(), rng))
    if rng.random() < 0.5:
        return ["compare", "shape", str(kit / "scan.obj")]
    (folder / "star.json").write_text(json_text(DESIGNS["star"]))
    return ["export", "star.json", "--shape", "shape"]


def _profiles(rng: Rng, kit: Path, folder: Path) -> list[str]:
    name = pick(rng, ["printer", "plastic"])
    (folder / f"{name}.toml").write_bytes(mutated_bytes((kit / f"{name}.toml").read_bytes(), rng))
    return ["export", _design(rng, folder, intact=True), f"--{name}", f"{name}.toml"]


def _sweeps(rng: Rng, kit: Path, folder: Path) -> list[str]:
    """A sweep of a few designs, whose parameters may be wrong."""
    name = _design(rng, folder, intact=rng.random() < 0.8)
    words = ["sweep", name, *(word for _ in range(int(rng.integers(1, 3))) for word in ("--vary", _varied(rng)))]
    if rng.random() < 0.4:
        words += ["--samples", pick(rng, ["2", "3", "5", "1", "0", "-1", "nan", "x", "20000"])]
    if rng.random() < 0.2:
        option = pick(rng, OPTIONS["sweep"][1:])
        words += [option] if option in FLAGS else [option, pick(rng, ODD_OPTIONS)]
    if rng.random() < 0.1 and _exact_is_small(name, folder):
        words.append("--exact")
    return words


def _varied(rng: Rng) -> str:
    """Words of one parameter: mostly an entry of a design with values that it may have."""
    if rng.random() < 0.5:
        return str(pick(rng, SWEPT))
    path = pick(rng, SWEPT_PATHS)
    if rng.random() < 0.4:
        base = pick(rng, [0.35, 1, 8.0])
        values = pick(rng, ["{0},{1}", "{0}:{1}:2", "{0}:{1}:3", "{0}:{1}", "{0}", "{1}:{0}:2"])
        text = values.format(base, pick(rng, [1.1, 1.5, 2]) * base)
    else:
        text = pick(rng, SWEPT_VALUES)
    form: str = pick(rng, ["{}={}"] * 12 + ["{}", "={1}", "{} = {}", "{}=={}"])
    return form.format(path, text)


def _comparisons(rng: Rng, kit: Path, folder: Path) -> list[str]:
    """Two or three designs on one page."""
    names = []
    for number in range(int(rng.integers(2, 4))):
        name = _design(rng, folder, intact=number > 0 and rng.random() < 0.7)
        part = f"{number}-{name}"
        (folder / name).rename(folder / part)
        names.append(part)
    words = ["compare-designs", *names]
    if rng.random() < 0.3:
        option = pick(rng, OPTIONS["compare-designs"])
        words += [option] if option in FLAGS else [option, pick(rng, ODD_OPTIONS)]
    if rng.random() < 0.1 and all(_exact_is_small(name, folder) for name in names):
        words.append("--exact")
    return words


def _options(rng: Rng, kit: Path, folder: Path) -> list[str]:
    command = pick(rng, OPTIONS)
    words = command.split()
    inputs: dict[str, Callable[[], list[str]]] = {
        "strips fit": lambda: [str(shutil.copy(kit / "strips.csv", folder))],
        "compare": lambda: [str(kit / "shape"), str(shutil.copy(kit / "scan.obj", folder))],
        "law show": lambda: [str(shutil.copy(kit / "law.npz", folder))],
        "law errors": lambda: [str(shutil.copy(kit / "law.npz", folder))],
        "new": lambda: [pick(rng, ["tube", "dome", "nothing", ""])],
        "strips new": list,
        "printers": list,
        "sweep": lambda: [_design(rng, folder, intact=True), "--vary", "stars.thickness_mm=0.3,0.4"],
        "compare-designs": lambda: 2 * [_design(rng, folder, intact=True)],
    }
    words += inputs[command]() if command in inputs else [_design(rng, folder, intact=True)]
    for _ in range(int(rng.integers(1, 3))):
        known = [option for option in OPTIONS[command] if option not in words]
        option = pick(rng, [*known, "--colour"]) if known else "--colour"
        words += [option] if option in FLAGS else [option, pick(rng, ODD_OPTIONS)]
    if command in ("simulate", "verify") and "--edge" in words and not _edge_is_coarse(words, folder):
        words[words.index("--edge") + 1] = "3"
    return words


def _edge_is_coarse(words: list[str], folder: Path) -> bool:
    """Whether the exact model takes a second or two with the option --edge, or refuses it."""
    from asterism.cli.common.overrides import with_overrides
    from asterism.equilibrium.errors import Error
    from asterism.exact.cost import exact_cost
    from asterism.pattern.layout.load_design import load_design

    try:
        edge_mm = float(words[words.index("--edge") + 1])
        changed = with_overrides(load_design(folder / words[1]), {"--edge": ("mesh.edge_mm", edge_mm)})
        return exact_cost(changed).vertices <= MAX_VERTICES
    except (Error, ValueError):
        return True


MAKERS: dict[str, Callable[[Rng, Path, Path], list[str]]] = {
    "design": _designs,
    "material": _materials,
    "strips": _strips,
    "law": _laws,
    "scan": _scans,
    "target": _targets,
    "drawing": _drawings,
    "shape": _shapes,
    "profile": _profiles,
    "sweep": _sweeps,
    "comparison": _comparisons,
    "option": _options,
}
# how often each kind comes
KINDS = (
    ["design"] * 8
    + ["option"] * 4
    + ["strips", "scan", "drawing"] * 2
    + ["material", "law", "shape", "profile", "target", "sweep", "comparison"]
)
