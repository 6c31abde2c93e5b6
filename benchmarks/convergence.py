"""How the exact model's answer depends on the mesh: tube and dome, paper's hinges, plate, plate on graded meshes.

python -m benchmarks.convergence [FILE]

Distances are those of star centres and of the surface (at the same printed points) to the finest mesh of the same
design, after a rigid motion, and up to the symmetries of the pattern: a tube may roll about any of three axes. FILE
keeps finished cases, one a line, and spares them the next time. Every case runs in a process of its own.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.shape.diameter import diameter
from asterism.shape.shape import Shape
from benchmarks.convergence_tables import GROUPS, report

SPACING = 17.3205
CUTS = (5, 7, 9, 12, 16, 20, 25, 36)
GRADED = (7, 9, 12, 16, 19, 26, 36)


def cases() -> list[dict[str, Any]]:
    """The aligned meshes, and Delaunay meshes of the tube; small ones first."""
    sizes = {"aligned": CUTS, "graded": GRADED}
    chosen: list[tuple[int, str, str, dict[str, Any]]] = [
        (k, design, bending, {"kind": "aligned"} | ({"graded": True} if graded else {}))
        for design, bending, graded in GROUPS
        for k in sizes["graded" if graded else "aligned"]
    ]
    for k, seed in ((9, 0), (9, 1), (16, 0)):
        chosen += [(k, "tube", bending, {"kind": "delaunay", "seed": seed}) for bending in ("paper", "consistent")]
    chosen += [(5, "tube", "consistent", {"kind": "delaunay", "seed": seed, "graded": True}) for seed in (0, 1)]
    return [
        {"design": design, "bending": bending, "mesh": {"edge_mm": SPACING / k} | mesh}
        for k, design, bending, mesh in sorted(chosen, key=lambda case: case[0])
    ]


def run(case: dict[str, Any]) -> dict[str, Any]:
    """One case, here and now."""
    data = gallery.load(case["design"]).to_dict()
    data["mesh"] = data["mesh"] | case["mesh"]
    data["fabric"] = data["fabric"] | {"bending": case["bending"]}
    shape = exact_shape(Design.from_dict(data))
    stars, surface = (
        [shape.at(points @ turn.T).tolist() for turn in symmetries()] for points in probes(case["design"])
    )
    summary = {key: value for key, value in shape.summary.items() if key not in ("design", "levels")}
    radius = cylinder_radius(shape) if case["design"] == "tube" else None
    return summary | case | {"radius_mm": radius, "diameter_mm": diameter(shape.positions), "at": [stars, surface]}


def probes(design: str) -> tuple[np.ndarray, np.ndarray]:
    """Printed places that are compared: star centres, and the vertices of a coarse mesh drawn in by a thousandth."""
    plan = layout(gallery.load(design))
    return plan.centres, 0.999 * mesh_layout(plan, SPACING / 5, "aligned").points


def symmetries() -> list[np.ndarray]:
    """(2, 2) turns by 120 degrees and mirrors of the printed pattern, turns first."""
    c, s = -0.5, np.sqrt(0.75)
    turn, mirror = np.array([[c, -s], [s, c]]), np.diag([-1.0, 1.0])
    turns = [np.eye(2), turn, turn.T]
    return turns + [mirror @ t for t in turns]


def cylinder_radius(shape: Shape) -> float:
    """mm, of the circular cylinder closest to the star centres in the sense of least squares."""
    points = shape.positions[shape.star_vertices]
    points = points - points.mean(axis=0)

    def across(a: np.ndarray, axes: np.ndarray) -> np.ndarray:
        axis = axes[0] + a[0] * axes[1] + a[1] * axes[2]
        axis /= np.linalg.norm(axis)
        return np.linalg.norm(np.cross(points - a[2] * axes[1] - a[3] * axes[2], axis), axis=1)

    principal = np.linalg.svd(points)[2]
    fits = [
        least_squares(lambda a, axes=axes: across(a, axes) - a[4], [0.0, 0.0, *offset, 20.0])
        for axes in (np.roll(principal, -i, axis=0) for i in range(3))
        for offset in ((0.0, 0.0), (10.0, 0.0), (-10.0, 0.0), (0.0, 10.0), (0.0, -10.0))
    ]
    return float(abs(min(fits, key=lambda fit: fit.cost).x[4]))


def main(words: list[str]) -> None:
    if words[:1] == ["--case"]:
        print(json.dumps(run(json.loads(words[1]))))
        return
    kept = Path(words[0]) if words else None
    rows = [json.loads(line) for line in kept.read_text().splitlines()] if kept and kept.exists() else []
    for case in cases():
        if any(all(r[key] == value for key, value in case.items()) for r in rows):
            continue
        command = [sys.executable, "-m", "benchmarks.convergence", "--case", json.dumps(case)]
        line = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1]
        rows.append(json.loads(line))
        if kept:
            with kept.open("a") as file:
                file.write(line + "\n")
        r = rows[-1]
        print(r["design"], r["bending"], r["mesh"], r["vertices"], r["energy_n_mm"], f"{r['wall_s']:.1f} s", flush=True)
    report(rows)


if __name__ == "__main__":
    main(sys.argv[1:])
