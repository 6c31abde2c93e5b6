"""Minima of every design of the gallery: the default start from three seeds, and other starts.

python -m benchmarks.branches [NAME ...]    (with names: these only, nothing is written)
"""

from __future__ import annotations

import sys
import time
from typing import Any

from asterism.minima import many_minima
from benchmarks.report import markdown, write_report
from discrete.branches import Branch, distinct, find_minima
from discrete.levels import coarser
from discrete.model import Model
from discrete.solve import relax
from discrete.starts import Beginning
from pattern import gallery
from pattern.build import layout
from pattern.meshing import mesh_layout
from pattern.symmetries import symmetries

SEEDS = (0, 1, 2)
STARTS = 10
# fabric without bending stiffness wrinkles without end: every start ends elsewhere, at many times the cost
FEWER = {"fig5-no-fabric-bending": 3}
HEADER = [
    "design", "from 3 seeds", "minima", "reported N mm", "rolled about deg", "default start N mm",
    "others: N mm (% higher, % away, stars up)", "starts lost", "seconds",
]  # fmt: skip


def main(names: list[str]) -> None:
    rows: list[dict[str, Any]] = []
    for name in names or gallery.names():
        rows.append(run(name))
        print("  ".join(row(rows[-1])), flush=True)
    if not names:
        fewer = ", ".join(f"{count} for {name}" for name, count in FEWER.items())
        note = f"{STARTS} starts on the coarse mesh ({fewer}), minima carried to edges of 2 mm."
        write_report("branches", rows, f"{note}\n\n{markdown(HEADER, [row(r) for r in rows])}")


def run(name: str) -> dict[str, Any]:
    """Seeds on the coarse mesh; other starts there, and what they found on the fine one."""
    design = gallery.load(name)
    plan = layout(design)
    model = Model(
        design, plan, mesh_layout(plan, design.mesh.edge_mm, design.mesh.kind, design.mesh.seed, design.mesh.graded)
    )
    begun = time.perf_counter()
    coarse = next(iter([*coarser(model), model]))
    seeds = [Branch(relax(coarse, Beginning(seed=s)), coarse, (f"seed {s}",), s == 0) for s in SEEDS]
    starts = FEWER.get(name, STARTS)
    minima = find_minima(model, starts)
    return {
        "name": name,
        "seed_energies_n_mm": [b.found.energy for b in seeds],
        "seed_minima": len(distinct(seeds, symmetries(design, plan))),
        **many_minima(minima, starts),
        "instabilities_passed": [b.found.instabilities_passed for b in minima.fine],
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
