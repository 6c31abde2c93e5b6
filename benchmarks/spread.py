"""The range of shapes against exact shapes of random materials: fourteen designs, 40 materials each.

python -m benchmarks.spread [NAME ...]

Materials are drawn from the intervals of `[spread]`, by their defaults, and solved exactly from the shape of the
design, on one mesh. The method was chosen on the last four designs (`CHOSEN_ON`) and on others; the first ten judge.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from typing import Any

import numpy as np

from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.levels import model_on
from asterism.discrete.release.prolongation import fit_to_surface
from asterism.exact.spread import HALF_INTERVAL_SIGMAS, check_spread, spread, varied_model
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.layout.build import layout, load_design
from asterism.verification.simulate import simulate
from benchmarks.frozen.draw import GROUPS, frozen
from benchmarks.report import ROOT, chosen, markdown, write_report

MATERIALS = 40
ONE_MESH = {"mesh.edge_mm": 3.0}  # on finer ones the 560 exact shapes take hours
GRAIN = {"fabric.modulus_mpa": [11.36, 4.55], "fabric.grain_deg": 30.0}
FROZEN: dict[str, dict[str, Any]] = {
    "fourth-free-04": {},
    "fourth-supported-07": {},
    "fourth-canopy-07": {},
    "fourth-weight-02": {},
    "fourth-arms-04": {},
    "fourth-supported-09": GRAIN,
    "third-free-05": {},
    "third-supported-05": {},
    "third-weight-01": {},
    "frozen-supported-01": {},
    "fourth-supported-14": GRAIN,
}
PATTERN = "parallel-lines"
CHOSEN_ON = ("tube", "frozen-supported-01", "fourth-supported-14", "dome")
HEADER = [
    "design", "stars", "vertices", "height, mm", "nine in ten, mm", "in it", "median error, %", "solves",
    "range, s", "shape, s", "warned",
]  # fmt: skip


def designs() -> dict[str, Design]:
    """The designs by name; the tube with fewer stars than that of the gallery."""
    known = {design.name: design for group in GROUPS for _, design in frozen(group)}
    known |= {"dome": gallery.load("dome"), "tube": changed(gallery.load("tube"), {"border.rings": 2})}
    known[PATTERN] = load_design(ROOT / "pattern" / "patterns" / f"{PATTERN}.toml")
    judging = [name for name in (*FROZEN, PATTERN) if name not in CHOSEN_ON]
    return {name: changed(known[name], ONE_MESH | FROZEN.get(name, {})) for name in (*judging, *CHOSEN_ON)}


def changed(design: Design, values: dict[str, Any]) -> Design:
    """The design with other entries."""
    return Design.from_dict(with_entries(design.to_dict(), values))


def run(name: str, design: Design, number: int) -> tuple[list[str], int]:
    """The row of a design; how many materials its range holds."""
    begin = time.perf_counter()
    shape = simulate(design)
    found, plan = spread(shape), layout(design)
    record = found.summary.spread  # type: ignore[union-attr]
    base_s = time.perf_counter() - begin - record.wall_s
    model = model_on(design, plan, shape.summary.edge_mm)  # type: ignore[union-attr]
    start, names = fit_to_surface(model, shape.at(model.mesh.points, plan.spacing_mm)), check_spread(design, plan)
    draws = np.random.default_rng(number).standard_normal((MATERIALS, len(names))) / HALF_INTERVAL_SIGMAS
    heights = []
    for t in draws:
        found_there = solve_on_mesh(varied_model(model, dict(zip(names, t.tolist(), strict=True))), start)
        moved = replace(shape, positions=found_there.state.positions)
        heights.append((moved if shape.held else moved.aligned()).height_mm)
    low, high = record.height_low_mm, record.height_high_mm
    held = int(sum(low <= each <= high for each in heights))
    off = 100.0 * abs(record.height_median_mm / np.median(heights) - 1.0)
    warned = len(found.summary["warnings"]) - len(shape.summary["warnings"])
    cells = [
        name, str(len(plan.centres)), str(model.n_vertices), f"{shape.height_mm:.1f}", f"{low:.1f} to {high:.1f}",
        f"{held} of {MATERIALS}", f"{off:.1f}", str(record.solves),
        f"{record.wall_s:.0f}", f"{base_s:.0f}", str(warned),
    ]  # fmt: skip
    return cells, held


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.spread")
    parser.add_argument("name", nargs="*", help="of a design; by default all")
    names, known = parser.parse_args().name, designs()
    rows, counts = [], {}
    numbered = {name: (name, design, number) for number, (name, design) in enumerate(known.items())}
    for name, design, number in chosen(parser, names, numbered):
        cells, counts[name] = run(name, design, number)
        rows.append(cells)
        print("  ".join(cells), flush=True)
    if not names:
        judged = [counts[name] for name in known if name not in CHOSEN_ON]
        heights = f"{sum(judged)} of {MATERIALS * len(judged)} heights"
        text = f"The method was chosen on {', '.join(CHOSEN_ON)}; of the others {heights} are in it."
        write_report("spread", f"{markdown(HEADER, rows)}\n\n{text}")


if __name__ == "__main__":
    main()
