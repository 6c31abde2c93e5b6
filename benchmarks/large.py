"""One Newton system of large sheets by factorisation and by multigrid: seconds, and memory of a process of its own.

python -m benchmarks.large [system|laplacian ...]

system: the Hessian of the convex model (b = 1) where the equilibrium of a coarse mesh is carried to the fine one,
which is Newton's first system there. laplacian: the one that puts steps together again.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.prolongation import prolong
from asterism.discrete.release.single_mesh import solve_on_mesh
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.factor import IterativeFactor
from asterism.equilibrium.linear.rigid_support import stiffen
from asterism.equilibrium.newton.regularisation import CONVEX_STIFFNESS_FRACTION
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from benchmarks.report import markdown, write_report

SPACING = 17.3205  # mm, of the tube's stars
DIVISIONS = [12, 25, 36, 52, 81]
BACKENDS = {"pardiso": 81, "amg": 81, "superlu": 12}  # and the finest mesh worth waiting for
TOLERANCE = 1e-6  # of the iterative solve: what a step near the minimum asks for


def tube(divisions: int) -> Design:
    """The gallery's tube with so many edges between two stars."""
    data = gallery.load("tube").to_dict()
    data["mesh"]["edge_mm"] = SPACING / divisions
    return Design.from_dict(data)


def built(design: Design) -> DiscreteModel:
    """Its exact model."""
    plan = layout(design)
    return DiscreteModel(design, plan, mesh_layout(plan, design.mesh.edge_mm, design.mesh.kind, design.mesh.seed))


def memory_mb(field: str, reset: bool = False) -> float:
    """Memory of this process now (VmRSS) or at its largest (VmHWM); `reset` forgets the largest so far (Linux)."""
    if reset:
        Path("/proc/self/clear_refs").write_text("5")
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(field))
    return int(line.split()[1]) / 1024.0


def system(divisions: int, backend: str) -> dict[str, Any]:
    """One linear system, here and now."""
    coarse = built(tube(5))
    begun = time.perf_counter()
    model = built(tube(divisions))
    pattern_s = time.perf_counter() - begun
    state = prolong(coarse, solve_on_mesh(coarse).state, model)
    model.hessian(state, 1.0)
    begun = time.perf_counter()
    data = model.hessian(state, 1.0)
    hessian_s = time.perf_counter() - begun
    diagonal = model.pattern.diagonal
    data[diagonal] += CONVEX_STIFFNESS_FRACTION * np.median(data[diagonal])
    stiffen(model.pattern, data, model.support(state))
    b = model.gradient(state)
    before = memory_mb("VmRSS", reset=True)
    begun = time.perf_counter()
    factor = make_factor(model.pattern, backend)
    if isinstance(factor, IterativeFactor):
        factor.set_near_nullspace(*model.near_nullspace(state))
    accepted = factor.factorise(data)
    prepared = time.perf_counter()
    x = factor.solve(b, TOLERANCE) if isinstance(factor, IterativeFactor) else factor.solve(b)
    done = time.perf_counter()
    return {
        "vertices": model.n_vertices,
        "unknowns": model.pattern.size,
        "entries": model.pattern.nnz,
        "backend": factor.name,
        "accepted": accepted,
        "model_s": pattern_s,
        "hessian_s": hessian_s,
        "prepare_s": prepared - begun,
        "solve_s": done - prepared,
        "iterations": getattr(factor, "iterations", 0),
        "residual": float(np.linalg.norm(b - model.pattern.product(data, x)) / np.linalg.norm(b)),
        "mb_before": before,
        "mb_for_it": memory_mb("VmHWM") - before,
    }


def laplacian(divisions: int, backend: str) -> dict[str, Any]:
    """The scalar Laplacian with which steps are put together again, one of them with three right hand sides."""
    model = built(tube(divisions))
    everything, data = model.reconstruction.laplacian(np.arange(model.n_vertices))
    data[everything.diagonal[0]] *= 2.0  # one vertex held
    b = np.random.default_rng(0).standard_normal((everything.size, 3))
    before = memory_mb("VmRSS", reset=True)
    begun = time.perf_counter()
    factor = make_factor(everything, backend)
    accepted = factor.factorise(data)
    prepared = time.perf_counter()
    x = factor.solve(b)
    done = time.perf_counter()
    return {
        "vertices": model.n_vertices,
        "unknowns": everything.size,
        "entries": everything.nnz,
        "backend": factor.name,
        "accepted": accepted,
        "prepare_s": prepared - begun,
        "solve_s": done - prepared,
        "iterations": getattr(factor, "iterations", 0) // 3,
        "residual": float(np.linalg.norm(b - everything.product(data, x)) / np.linalg.norm(b)),
        "mb_for_it": memory_mb("VmHWM") - before,
    }


CASES = {"system": system, "laplacian": laplacian}


def row(kind: str, r: dict[str, Any]) -> list[str]:
    """One line of a table."""
    numbers = [f"{r['prepare_s']:.2f}", f"{r['solve_s']:.2f}", str(r["iterations"] or "-"), f"{r['mb_for_it']:.0f}"]
    start = [str(r["vertices"]), str(r["unknowns"]), r["backend"]]
    return start + ([f"{r['hessian_s']:.2f}"] if kind == "system" else []) + numbers


HEADERS = {
    "system": ["vertices", "unknowns", "backend", "Hessian s", "prepare s", "solve s", "iterations", "MB"],
    "laplacian": ["vertices", "unknowns", "backend", "prepare s", "solve s", "iterations", "MB"],
}


def main(words: list[str]) -> None:
    if words[:1] == ["--case"]:
        print(json.dumps(CASES[words[1]](int(words[2]), words[3])))
        return
    rows: list[dict[str, Any]] = []
    tables: list[str] = []
    for kind in words or list(CASES):
        found = []
        for divisions, backend in cases():
            command = [sys.executable, "-m", "benchmarks.large", "--case", kind, str(divisions), backend]
            out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
            found.append(json.loads(out.splitlines()[-1]) | {"kind": kind})
            print(kind, "  ".join(row(kind, found[-1])), flush=True)
        rows += found
        tables.append(f"### {kind}\n\n{markdown(HEADERS[kind], [row(kind, r) for r in found])}")
    if not words:
        write_report("large", rows, "\n\n".join(tables))


def cases() -> list[tuple[int, str]]:
    """Edges between two stars, and the backend."""
    return [(k, backend) for k in DIVISIONS for backend, finest in BACKENDS.items() if k <= finest]


if __name__ == "__main__":
    main(sys.argv[1:])
