"""The range of shapes against exact shapes of random materials: eleven designs, 40 materials each.

python -m benchmarks.spread [NAME ...]

Materials are drawn from the intervals of `[spread]`, by their defaults. The method was chosen on three of the
designs (`CHOSEN_ON`); the others judge it. Each material is solved exactly from the shape of the design, and a few also
from the flat print, which may end in another form.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from typing import Any

import numpy as np

from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.equilibrium import Equilibrium
from asterism.discrete.release.ladder import model_on
from asterism.discrete.release.prolongation import fit_to_surface
from asterism.exact.spread import HALF_INTERVAL_SIGMAS, check_spread, spread, varied_model
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.layout.build import layout, load_design
from asterism.shape.shape import Shape
from asterism.verification.both_starts import simulate
from benchmarks.frozen.draw import GROUPS, frozen
from benchmarks.report import ROOT, chosen, markdown, write_report

MATERIALS = 40
FROM_PRINT = 2
COARSE = {"mesh.tolerance_percent": 3.0}
GRAIN = {"fabric.modulus_mpa": [11.36, 4.55], "fabric.grain_deg": 30.0}
FROZEN = {
    "frozen-supported-01": {},
    "fourth-free-00": {},
    "fourth-supported-05": {},
    "fourth-canopy-04": {},
    "fourth-weight-05": {},
    "fourth-arms-00": {},
    "fourth-supported-14": GRAIN,
    "frozen-supported-02": {},
}
CHOSEN_ON = ("dome", "tube", "frozen-supported-02")
HEADER = [
    "design", "stars", "vertices", "height, mm", "nine in ten, mm", "in it from the shape", "from the print",
    "median error, %", "solves", "range, s", "shape, s", "warned",
]  # fmt: skip


def designs() -> dict[str, Design]:
    """The designs by name; those of the gallery and of the patterns with a coarser mesh or fewer stars."""
    found = {
        "dome": changed(gallery.load("dome"), COARSE),
        "tube": changed(gallery.load("tube"), {"border.rings": 2, "mesh.edge_mm": 3.0}),
        "skew grid": changed(load_design(ROOT / "pattern" / "patterns" / "skew-grid.toml"), COARSE),
    }
    known = {design.name: design for group in GROUPS for _, design in frozen(group)}
    found |= {name: changed(known[name], COARSE | values) for name, values in FROZEN.items()}
    return {name: found[name] for name in ("dome", "tube", "frozen-supported-01", *found)}


def changed(design: Design, values: dict[str, Any]) -> Design:
    """The design with other entries."""
    return Design.from_dict(with_entries(design.to_dict(), values))


def run(name: str, design: Design, number: int) -> tuple[list[str], int, int]:
    """The row of a design; how many materials its range holds, and of how many."""
    begin = time.perf_counter()
    shape = simulate(design)
    found, plan = spread(shape), layout(design)
    record = found.summary.spread  # type: ignore[union-attr]
    base_s = time.perf_counter() - begin - record.wall_s
    model = model_on(design, plan, shape.summary.edge_mm)  # type: ignore[union-attr]
    start, names = fit_to_surface(model, shape.at(model.mesh.points, plan.spacing_mm)), check_spread(design, plan)
    draws = np.random.default_rng(number).standard_normal((MATERIALS, len(names))) / HALF_INTERVAL_SIGMAS
    near, printed = [], []
    for count, t in enumerate(draws):
        varied = varied_model(model, dict(zip(names, t.tolist(), strict=True)))
        near.append(height(shape, solve_on_mesh(varied, start)))
        if count < FROM_PRINT:
            printed.append(height(shape, solve_on_mesh(varied)))
    low, high = record.height_low_mm, record.height_high_mm
    held, of_print = (int(sum(low <= each <= high for each in heights)) for heights in (near, printed))
    off = 100.0 * abs(record.height_median_mm / np.median(near) - 1.0)
    warned = len(found.summary["warnings"]) - len(shape.summary["warnings"])
    cells = [
        name, str(len(plan.centres)), str(model.n_vertices), f"{shape.height_mm:.1f}", f"{low:.1f} to {high:.1f}",
        f"{held} of {len(near)}", f"{of_print} of {len(printed)}", f"{off:.1f}", str(record.solves),
        f"{record.wall_s:.0f}", f"{base_s:.0f}", str(warned),
    ]  # fmt: skip
    return cells, held, len(near)


def height(shape: Shape, found: Equilibrium) -> float:
    """mm, of a shape on the mesh of another one."""
    moved = replace(shape, positions=found.state.positions)
    return (moved if shape.held else moved.aligned()).height_mm


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.spread")
    parser.add_argument("name", nargs="*", help="of a design; by default all")
    names, known = parser.parse_args().name, designs()
    rows, counts = [], {}
    numbered = {name: (name, design, number) for number, (name, design) in enumerate(known.items())}
    for name, design, number in chosen(parser, names, numbered):
        cells, *counts[name] = run(name, design, number)
        rows.append(cells)
        print("  ".join(cells), flush=True)
    if not names:
        judged = np.array([counts[name] for name in known if name not in CHOSEN_ON]).sum(axis=0)
        text = f"Materials within the range, of the designs that were not used to choose the method: {judged[0]} of"
        write_report("spread", f"{markdown(HEADER, rows)}\n\n{text} {judged[1]}, {100 * judged[0] / judged[1]:.0f} %.")


if __name__ == "__main__":
    main()
