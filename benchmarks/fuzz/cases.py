"""One case: files in a folder and a command line, all from its number; and the intact files that are mutated."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.pattern.design.files import table_text
from benchmarks.fuzz.mutations import Rng, json_text, mutated_archive, mutated_bytes, mutated_cells, mutated_table, pick
from benchmarks.fuzz.nested import write_nested

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
OPTIONS: dict[str, tuple[str, ...]] = {
    "preview": ("--side", "--law", "--material", "-o", "--strict", "--quiet"),
    "simulate": ("--edge", "--backend", "-o", "--material", "--strict"),
    "verify": ("--edge", "--law", "--backend", "-o"),
    "export": (
        "--printer", "--plastic", "--first-layer", "--layer", "--plate", "--fabric", "--turn", "--needle-spacing",
        "--no-border", "--shape", "-o",
    ),
    "report": ("--results", "--printer", "-o"),
    "strips fit": ("--kappa-bar", "--stretch", "--rest-curvature", "--outside", "-o"),
    "strips new": ("--thickness", "--count", "--length", "--stretch", "--plate", "--fabric", "--printer"),
    "compare": ("--units", "--view", "--trim", "-o"),
    "law show": ("-o",),
    "new": ("-o",),
    "printers": (),
    "sweep": ("--samples", "--jobs", "--law", "--material", "-o", "--strict", "--quiet"),
    "compare-designs": ("--printer", "--law", "--material", "-o", "--strict", "--quiet"),
}  # fmt: skip
FLAGS = ("--strict", "--quiet", "--no-border", "--outside")
SIX_CORNERS = [[-30.0, -25.0], [30.0, -25.0], [38.0, 0.0], [30.0, 25.0], [-30.0, 25.0], [-38.0, 0.0]]
# small sheets: a case of the exact model takes a second or two
DESIGNS: dict[str, dict[str, Any]] = {
    "star": {"stars": {"length_mm": 10.0, "thickness_mm": 0.4}, "border": {"rings": 0}, "mesh": {"edge_mm": 4.0}},
    "seven": {
        "stars": {"length_mm": {"profile": "radial", "from": 10, "to": 6, "over_mm": 20}, "thickness_mm": 0.35},
        "border": {"rings": 1},
        "mesh": {"edge_mm": 5.0},
    },
    "pinned": {
        "stars": {"length_mm": 9.0, "override": [{"star": 1, "thickness_mm": 0.5}, {"site": [0, 1], "remove": True}]},
        "border": {"rings": 1},
        "pins": [{"corners": [0, 2, 4], "scale": 0.75}],
        "mesh": {"edge_mm": 5.0},
    },
    "square": {
        "lattice": {"kind": "square", "spacing_mm": 18.0, "arms": 4, "orientation_deg": 45.0},
        "stars": {"length_fraction": 0.45, "width_mm": {"formula": "1 + x/200"}},
        "border": {"rectangle_mm": [60.0, 50.0]},
        "mesh": {"edge_mm": 5.0},
    },
    "outline": {
        "fabric": {"stretch": 1.35, "thickness_mm": 0.8, "modulus_mpa": 7.0},
        "stars": {"length_mm": 8.0, "branch": "up"},
        "border": {"polygon_mm": SIX_CORNERS, "star_margin_mm": 8.0},
        "gravity": {"on": True, "direction": [0, 0, -1]},
        "pins": [{"points_mm": [[-30.0, -25.0], [30.0, -25.0], [30.0, 25.0]]}, {"edges": [4], "step": 1}],
        "mesh": {"edge_mm": 6.0, "kind": "delaunay"},
        "solver": {"start": "bump", "seed": 1},
    },
}
MATERIAL = {
    "name": "measured",
    "fabric": {"thickness_mm": 0.8, "stretch": 1.35},
    "plastic": {"modulus_ratio": 3200.0, "rest_curvature": "paper", "kappa_bar_per_mm": 0.0},
}
OUTLINE_CSV = "x_mm,y_mm\n-9,-5\n0,-10\n9,-5\n9,5\n0,10\n-9,5\n"
OUTLINE_SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="30mm" height="30mm" viewBox="0 0 30 30">\n'
    '<path d="M 6 10 L 15 5 L 24 10 L 24 20 L 15 25 L 6 20 Z"/>\n<circle cx="3" cy="3" r="1"/>\n</svg>\n'
)


@dataclass(frozen=True)
class Case:
    """A case: its number, the kind of input that is mutated, and the words of the command line."""

    number: int
    kind: str
    words: tuple[str, ...]


def make_case(number: int, kit: Path, folder: Path, kind: str | None = None) -> Case:
    """Write the files of a case into an empty folder, and return it; by default of any kind."""
    rng = np.random.default_rng([SEED, number])
    kind = kind or pick(rng, KINDS)
    return Case(number, kind, tuple(MAKERS[kind](rng, kit, folder)))


def _strips_csv() -> str:
    rng = np.random.default_rng(0)
    lines = ["strip,thickness_mm,length_mm,stretch,fabric_thickness_mm,curvature_per_mm,peeled_curvature_per_mm"]
    for number in range(24):
        thickness, bent = ((0.3, 0.0302), (0.35, 0.0228), (0.4, 0.0175))[number % 3]
        with_fabric, peeled = rng.normal([bent, 0.003], [0.0004, 0.0002])
        lines.append(f"{number + 1},{thickness},60,1.35,0.8,{with_fabric:.5f},{peeled:.5f}")
    return "\n".join(lines) + "\n"


def make_kit(folder: Path) -> None:
    """Write all intact files, and a shape for comparisons with scans."""
    import trimesh

    import asterism
    from asterism.homogenize.law.law_file import PAPER_LAW

    shape = asterism.preview(asterism.Design.from_dict(DESIGNS["star"]))
    asterism.write_results(shape, folder / "shape")
    scan = trimesh.Trimesh(shape.positions, shape.triangles, process=False)
    for suffix in ("obj", "stl", "ply"):
        scan.export(folder / f"scan.{suffix}")
    (folder / "text.ply").write_bytes(scan.export(file_type="ply", encoding="ascii"))
    (folder / "text.stl").write_text(scan.export(file_type="stl_ascii"))
    (folder / "outline.csv").write_text(OUTLINE_CSV)
    (folder / "outline.svg").write_text(OUTLINE_SVG)
    (folder / "strips.csv").write_text(_strips_csv())
    (folder / "law.npz").write_bytes(PAPER_LAW.read_bytes())
    profiles = Path(asterism.__file__).parent / "print" / "data"
    (folder / "printer.toml").write_bytes((profiles / "printers" / "ultimaker2.toml").read_bytes())
    (folder / "plastic.toml").write_bytes((profiles / "plastics" / "tpu95a.toml").read_bytes())


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


def _exact_is_small(name: str, folder: Path, edge_mm: str = "") -> bool:
    """Whether the exact model takes a second or two, or refuses the design; with the option --edge if it is given."""
    from asterism.cli.command import with_overrides
    from asterism.equilibrium.errors import Error
    from asterism.exact.cost import exact_cost
    from asterism.pattern.layout.build import load_design

    try:
        changed = with_overrides(load_design(folder / name), edge=float(edge_mm) if edge_mm else None)
        return exact_cost(changed).vertices <= MAX_VERTICES
    except (Error, ValueError):
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
    command = pick(rng, ["preview", "export", "simulate"])
    return [command, _design(rng, folder, intact=True), "--material", "material.toml"]


def _strips(rng: Rng, kit: Path, folder: Path) -> list[str]:
    text = mutated_cells((kit / "strips.csv").read_text(), rng)
    (folder / "strips.csv").write_bytes(mutated_bytes(text.encode(), rng) if rng.random() < 0.3 else text.encode())
    kinds = ("zero", "constant", "per-thickness")
    options = ["--kappa-bar", pick(rng, kinds)] if rng.random() < 0.5 else []
    return ["strips", "fit", "strips.csv", *options]


def _laws(rng: Rng, kit: Path, folder: Path) -> list[str]:
    content = (kit / "law.npz").read_bytes()
    mutated = mutated_archive if rng.random() < 0.8 else mutated_bytes
    (folder / "law.npz").write_bytes(mutated(content, rng))
    if rng.random() < 0.5:
        return ["law", "show", "law.npz"]
    return ["preview", _design(rng, folder, intact=True), "--law", "law.npz"]


def _mutated(rng: Rng, kit: Path, folder: Path, names: list[str]) -> str:
    name: str = pick(rng, names)
    (folder / name).write_bytes(mutated_bytes((kit / name).read_bytes(), rng))
    return name


def _scans(rng: Rng, kit: Path, folder: Path) -> list[str]:
    names = ["scan.obj", "scan.stl", "scan.ply", "text.ply", "text.stl"]
    return ["compare", str(kit / "shape"), _mutated(rng, kit, folder, names)]


def _targets(rng: Rng, kit: Path, folder: Path) -> list[str]:
    """A surface for which a design is fitted, without the exact check."""
    name = _mutated(rng, kit, folder, ["scan.obj", "scan.stl", "text.ply"])
    return ["fit", name, "--no-exact", "--needles", pick(rng, ["0", "3"])]


def _drawings(rng: Rng, kit: Path, folder: Path) -> list[str]:
    name = _mutated(rng, kit, folder, ["outline.svg", "outline.csv"])
    return ["compare", str(kit / "shape"), name, "--view", pick(rng, ["above", "front", "side"])]


def _nested(rng: Rng, kit: Path, folder: Path) -> list[str]:
    """A drawing of nested groups or blocks, whose lines are compared with those of another reader."""
    drawing = write_nested(int(rng.integers(2**31)), folder)
    (folder / "design.json").write_text(json_text(DESIGNS["star"] | {"border": {"file": drawing.name}}))
    return ["export", "design.json"]


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
    name = _mutated(rng, kit, folder, ["printer.toml", "plastic.toml"])
    return ["export", _design(rng, folder, intact=True), f"--{Path(name).stem}", name]


def _sweeps(rng: Rng, kit: Path, folder: Path) -> list[str]:
    """A sweep of a few designs, whose parameters may be wrong."""
    name = _design(rng, folder, intact=rng.random() < 0.8)
    words = ["sweep", name, *(word for _ in range(int(rng.integers(1, 3))) for word in ("--vary", _varied(rng)))]
    if rng.random() < 0.4:
        words += ["--samples", pick(rng, ["2", "3", "5", "1", "0", "-1", "nan", "x", "20000"])]
    if rng.random() < 0.2:
        words += _with_value(rng, pick(rng, OPTIONS["sweep"][1:]))
    if rng.random() < 0.1 and _exact_is_small(name, folder):
        words.append("--exact")
    return words


def _varied(rng: Rng) -> str:
    """Words of one parameter: an entry of a design with values that it may have, or that with changed characters."""
    text: str = pick(rng, SWEPT)
    return text if rng.random() < 0.5 else mutated_bytes(text.encode(), rng).decode(errors="replace").replace("\0", "")


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
        words += _with_value(rng, pick(rng, OPTIONS["compare-designs"]))
    if rng.random() < 0.1 and all(_exact_is_small(name, folder) for name in names):
        words.append("--exact")
    return words


def _with_value(rng: Rng, option: str) -> list[str]:
    return [option] if option in FLAGS else [option, pick(rng, ODD_OPTIONS)]


def _options(rng: Rng, kit: Path, folder: Path) -> list[str]:
    command = pick(rng, OPTIONS)
    words = command.split()
    inputs: dict[str, Callable[[], list[str]]] = {
        "strips fit": lambda: [str(shutil.copy(kit / "strips.csv", folder))],
        "compare": lambda: [str(kit / "shape"), str(shutil.copy(kit / "scan.obj", folder))],
        "law show": lambda: [str(shutil.copy(kit / "law.npz", folder))],
        "new": lambda: [pick(rng, ["tube", "dome", "nothing", ""])],
        "strips new": list,
        "printers": list,
        "sweep": lambda: [_design(rng, folder, intact=True), "--vary", "stars.thickness_mm=0.3,0.4"],
        "compare-designs": lambda: 2 * [_design(rng, folder, intact=True)],
    }
    words += inputs[command]() if command in inputs else [_design(rng, folder, intact=True)]
    for _ in range(int(rng.integers(1, 3))):
        known = [option for option in OPTIONS[command] if option not in words]
        words += _with_value(rng, pick(rng, [*known, "--colour"]) if known else "--colour")
    if command in ("simulate", "verify") and "--edge" in words:
        edge = words.index("--edge") + 1
        words[edge] = words[edge] if not words[edge] or _exact_is_small(words[1], folder, words[edge]) else "3"
    return words


MAKERS: dict[str, Callable[[Rng, Path, Path], list[str]]] = {
    "design": _designs, "material": _materials, "strips": _strips, "law": _laws, "scan": _scans, "target": _targets,
    "drawing": _drawings, "nested": _nested, "shape": _shapes, "profile": _profiles, "sweep": _sweeps,
    "comparison": _comparisons, "option": _options,
}  # fmt: skip
# how often each kind comes
KINDS = (
    ["design"] * 8
    + ["option"] * 4
    + ["strips", "scan", "drawing", "nested"] * 2
    + ["material", "law", "shape", "profile", "target", "sweep", "comparison"]
)
