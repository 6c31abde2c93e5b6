"""Minima of every design of the gallery: the default start from three seeds, and other starts.

python -m benchmarks.branches [FILE.jsonl] [NAME ...]    (with names: these only, no report is written)

FILE keeps finished designs, one a line, and spares them the next time.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.forms import ExactForm, distinct_forms, find_minima
from asterism.discrete.release.levels import coarser_models
from asterism.discrete.release.release_start import ReleaseStart
from asterism.discrete.release.single_mesh import solve_on_mesh
from asterism.exact.minima import many_minima
from asterism.pattern import gallery
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout
from benchmarks.report import markdown, write_report

SEEDS = (0, 1, 2)
STARTS = 10
# fabric without bending stiffness wrinkles without end: every start ends elsewhere, at many times the cost
FEWER = {"fig5-no-fabric-bending": 3}
HEADER = [
    "design", "from 3 seeds", "minima", "reported N mm", "rolled about deg", "default start N mm",
    "others: N mm (% higher, % away, stars up)", "starts lost", "seconds",
]  # fmt: skip


def main(words: list[str]) -> None:
    kept = Path(words[0]) if words and words[0].endswith(".jsonl") else None
    names = words[1:] if kept else words
    # the gallery has some designs under several names
    known = {r["design"]: r for r in map(json.loads, kept.read_text().splitlines())} if kept and kept.exists() else {}
    rows: list[dict[str, Any]] = []
    for name in names or gallery.names():
        design = json.dumps(gallery.load(name).to_dict() | {"name": ""})
        if design not in known:
            known[design] = run(name) | {"design": design}
            if kept:
                with kept.open("a") as file:
                    file.write(json.dumps(known[design]) + "\n")
        rows.append({key: value for key, value in known[design].items() if key != "design"} | {"name": name})
        print("  ".join(row(rows[-1])), flush=True)
    if not names:
        fewer = ", ".join(f"{count} for {name}" for name, count in FEWER.items())
        note = f"{STARTS} starts on the coarse mesh ({fewer}), minima carried to edges of 2 mm."
        write_report("branches", rows, f"{note}\n\n{markdown(HEADER, [row(r) for r in rows])}")


def run(name: str) -> dict[str, Any]:
    """Seeds on the coarse mesh; other starts there, and what they found on the fine one."""
    design = gallery.load(name)
    plan = layout(design)
    model = DiscreteModel(
        design, plan, mesh_layout(plan, design.mesh.edge_mm, design.mesh.kind, design.mesh.seed, design.mesh.graded)
    )
    begun = time.perf_counter()
    coarse = next(iter([*coarser_models(model), model]))
    seeds = [ExactForm(solve_on_mesh(coarse, ReleaseStart(seed=s)), coarse, (f"seed {s}",), s == 0) for s in SEEDS]
    starts = FEWER.get(name, STARTS)
    minima = find_minima(model, starts)
    return {
        "name": name,
        "seed_energies_n_mm": [b.equilibrium.energy for b in seeds],
        "seed_minima": len(distinct_forms(seeds, symmetries(design, plan))),
        **many_minima(minima, starts),
        "instabilities_passed": [b.equilibrium.instabilities_passed for b in minima.fine],
        "seconds": time.perf_counter() - begun,
    }


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    first, *others = r["minima"]
    default = next((m for m in r["minima"] if m["default"]), None)
    axis = first["roll_axis_deg"]
    return [
        r["name"],
        "one minimum" if r["seed_minima"] == 1 else f"{r['seed_minima']} minima",
        str(r["minima_seen"]),
        f"{first['energy_n_mm']:.2f}",
        "-" if axis is None else f"{axis:.0f}",
        "-" if default is None else f"{default['energy_n_mm']:.2f}",
        "; ".join(
            f"{m['energy_n_mm']:.2f} ({100 * (m['energy_n_mm'] / first['energy_n_mm'] - 1):.2f}, "
            f"{m['distance_percent']:.1f}, {m['stars_up']})"
            for m in others
        )
        or "none",
        str(r["starts_lost"]),
        f"{r['seconds']:.0f}",
    ]


if __name__ == "__main__":
    main(sys.argv[1:])
