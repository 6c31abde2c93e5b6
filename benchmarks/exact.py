"""The exact model's cost: the paper's four timed designs, more vertices, more stars, graded meshes with the plate.

python -m benchmarks.exact [table1|vertices|stars|plate ...]

Every case runs in a process of its own, so that its memory is its own; the compiled loops are warm.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from typing import Any

import numpy as np

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from benchmarks.report import markdown, number, write_report

# Table 1 of the paper: seconds on one thread of a Xeon Gold 5118; and edges (mm) that make meshes of about its size
TABLE1 = {"roof": (1047.7, 2.12), "u-shape": (1702.7, 2.0), "tunnel": (1437.8, 2.0), "doubly-curved": (2400.4, 1.95)}
EDGES = [17.3205 / k for k in (5, 7, 9, 12, 13, 16, 25, 36)]
PLATE_EDGES = [17.3205 / k for k in (9, 12, 16, 19, 26)]
RINGS = [3, 4, 5, 6, 7, 8]
HEADER = [
    "case", "vertices", "stars", "seconds", "ms per vertex", "coarse it/fact", "finest it/fact", "finest s: Newton",
    "certificate", "peak MB", "paper s",
]  # fmt: skip


GROUPS: dict[str, list[dict[str, Any]]] = {
    "table1": [{"name": n, "design": n, "mesh": {"edge_mm": e}, "paper_s": s} for n, (s, e) in TABLE1.items()],
    "vertices": [{"name": f"tube, edge {e:.2f} mm", "design": "tube", "mesh": {"edge_mm": e}} for e in EDGES],
    "stars": [{"name": f"tube, {n} rings", "design": "tube", "border": {"rings": n}} for n in RINGS],
    "plate": [
        {"name": f"graded tube, edge {e:.2f} mm", "design": "tube", "mesh": {"edge_mm": e, "graded": True}}
        | {"fabric": {"bending": "consistent"}}
        for e in PLATE_EDGES
    ],
}


def run(case: dict[str, Any]) -> dict[str, Any]:
    """One case, here and now."""
    data = gallery.load(case["design"]).to_dict()
    for section in ("mesh", "border", "fabric"):
        data[section] = data[section] | case.get(section, {})
    summary = dict(exact_shape(Design.from_dict(data)).summary)
    del summary["design"]
    return case | summary | {"peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0}


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    *coarse, finest = r["levels"]
    work = f"{sum(c['iterations'] for c in coarse)}/{sum(c['factorisations'] for c in coarse)}" if coarse else "-"
    newton = sum(finest["seconds"].get(stage, 0.0) for stage in ("release", "equilibrium", "saddle"))
    return [
        r["name"] + ("" if r["is_minimum"] else " (no minimum)"), str(r["vertices"]), str(r["stars_total"]),
        f"{r['wall_s']:.1f}", f"{1000 * r['wall_s'] / r['vertices']:.2f}", work,
        f"{finest['iterations']}/{finest['factorisations']}", f"{newton:.1f}",
        f"{finest['seconds']['certificate']:.1f}", f"{r['peak_mb']:.0f}", number(r.get("paper_s"), ".0f"),
    ]  # fmt: skip


def main(words: list[str]) -> None:
    if words[:1] == ["--case"]:
        print(json.dumps(run(json.loads(words[1]))))
        return
    if unknown := [word for word in words if word not in GROUPS]:
        print(f"{unknown[0]!r} is none of {', '.join(GROUPS)}", file=sys.stderr)
        raise SystemExit(2)
    tables: list[str] = []
    run({"name": "warm up", "design": "star"})
    for group in words or GROUPS:
        found: list[dict[str, Any]] = []
        for case in GROUPS[group]:
            command = [sys.executable, "-m", "benchmarks.exact", "--case", json.dumps(case)]
            out = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
            found.append(json.loads(out.splitlines()[-1]))
            print("  ".join(row(found[-1])), flush=True)
        tables.append(f"### {group}\n\n{markdown(HEADER, [row(r) for r in found])}")
        if group != "table1":
            size, seconds = np.log([r["vertices"] for r in found]), np.log([r["wall_s"] for r in found])
            power = np.polyfit(size, seconds, 1)[0]
            tables.append(f"Seconds grow like vertices to the power {power:.2f} over this range.")
            print(tables[-1])
    if not words:
        write_report("exact", "\n\n".join(tables))


if __name__ == "__main__":
    main(sys.argv[1:])
