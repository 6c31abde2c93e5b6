"""One Newton system of large sheets by factorisation and by multigrid: seconds, and memory of a process of its own.

python -m benchmarks.large [DIVISIONS]    (edges between two stars; with it this mesh only, no report)

The Hessian of the convex model (b = 1) where the equilibrium of a coarse mesh is carried to the fine one, which is
Newton's first system there.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.release.continuation import solve_on_mesh
from asterism.discrete.release.prolongation import prolong
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.factor import IterativeFactor
from asterism.equilibrium.linear.sparse_pattern import stiffen
from asterism.equilibrium.newton.minimise import CONVEX_STIFFNESS_FRACTION
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.mesh.meshing import mesh_layout
from benchmarks.report import in_new_process, markdown, write_report

SPACING = 17.3205  # mm, of the tube's stars
DIVISIONS = [12, 25, 36, 52, 81]
BACKENDS = {"pardiso": 81, "amg": 81, "superlu": 12}  # and the finest mesh worth waiting for
HEADER = ["vertices", "unknowns", "backend", "Hessian s", "prepare s", "solve s", "iterations", "MB"]
TOLERANCE = 1e-6  # of the iterative solve: what a step near the minimum asks for


def tube(divisions: int) -> Design:
    """The gallery's tube with so many edges between two stars."""
    data = gallery.load("tube").to_dict()
    data["mesh"]["edge_mm"] = SPACING / divisions
    return Design.from_dict(data)


def built(design: Design) -> DiscreteModel:
    """Its exact model."""
    plan = layout(design)
    return DiscreteModel(design, plan, mesh_layout(plan, design.usual_edge_mm, design.mesh.kind, design.mesh.seed))


def memory_mb(field: str, reset: bool = False) -> float:
    """Memory of this process now (VmRSS) or at its largest (VmHWM); `reset` forgets the largest so far (Linux)."""
    if reset:
        Path("/proc/self/clear_refs").write_text("5")
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith(field))
    return int(line.split()[1]) / 1024.0


def system(divisions: int, backend: str) -> list[str]:
    """One line of the table, here and now."""
    coarse, model = built(tube(5)), built(tube(divisions))
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
    assert factor.factorise(data)
    prepared = time.perf_counter()
    _ = factor.solve(b, TOLERANCE) if isinstance(factor, IterativeFactor) else factor.solve(b)
    times = [hessian_s, prepared - begun, time.perf_counter() - prepared]
    ends = [str(getattr(factor, "iterations", "-")), f"{memory_mb('VmHWM') - before:.0f}"]
    counts = [str(model.n_vertices), str(model.pattern.size), factor.name]
    return [*counts, *(f"{seconds:.2f}" for seconds in times), *ends]


def main(words: list[str]) -> None:
    rows = []
    for divisions in map(int, words) if words else DIVISIONS:
        for backend, finest in BACKENDS.items():
            if divisions <= finest:
                rows.append(in_new_process(system, divisions, backend))
                print("  ".join(rows[-1]), flush=True)
    if not words:
        write_report("large", markdown(HEADER, rows))


if __name__ == "__main__":
    main(sys.argv[1:])
