"""Whole solves of the tube on fine meshes, by factorisation and by multigrid: seconds, memory, and how far they came.

python -m benchmarks.whole [DIVISIONS ...]

DIVISIONS: edges between two stars; with some, the other cases are kept from the last report. Each case has a process of
its own, and is stopped after a quarter of an hour.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from typing import Any

from asterism.equilibrium.newton.minimise import Iteration
from asterism.exact.simulation import exact_shape
from benchmarks.large import DIVISIONS, built, tube
from benchmarks.report import RESULTS, markdown, peak_memory_mb, write_report

BACKENDS = ("auto", "amg")
PATIENCE = 900.0  # s
KEYS = ("vertices", "wall_s", "is_minimum", "smallest_eigenvalue", "eigenvalue_error", "energy_n_mm", "levels")
HEADER = ["vertices", "backend", "seconds", "on the finest", "iterations", "factorisations", "minimum", "peak MB"]


class OutOfTimeError(Exception):
    """A solve has taken too long."""


def run(divisions: int, backend: str) -> dict[str, Any]:
    """One case, here and now. `reached`: the last iteration of every stage of every mesh, and when that was."""
    begun = time.perf_counter()
    reached: dict[str, dict[str, Any]] = {}

    def watch(stage: str, iteration: Iteration) -> None:
        spent = time.perf_counter() - begun
        reached[stage] = {"stage": stage, "until_s": spent, **vars(iteration)}
        if spent > PATIENCE:
            raise OutOfTimeError

    summary: dict[str, Any] = {}
    try:
        summary = dict(exact_shape(tube(divisions), backend, report=watch).summary)
    except OutOfTimeError:
        summary = {"wall_s": time.perf_counter() - begun, "vertices": built(tube(divisions)).n_vertices}
    found = {key: summary.get(key) for key in KEYS}
    return {"backend": backend} | found | {"reached": list(reached.values()), "peak_mb": peak_memory_mb()}


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    start, end = [str(r["vertices"]), r["backend"], f"{r['wall_s']:.0f}"], f"{r['peak_mb']:.0f}"
    if r["levels"] is None:
        last = r["reached"][-1]
        return [*start, "-", "-", "-", f"stopped at {last['stage']}, iteration {last['number']}", end]
    last = r["levels"][-1]
    finest = f"{sum(last['seconds'].values()):.0f}"
    return [
        *start,
        finest,
        str(last["iterations"]),
        str(last["factorisations"]),
        "yes" if r["is_minimum"] else "no",
        end,
    ]


def main(words: list[str]) -> None:
    if words[:1] == ["--case"]:
        print(json.dumps(run(int(words[1]), words[2])))
        return
    rows = json.loads((RESULTS / "whole.json").read_text())["rows"] if words else []
    for divisions in map(int, words or DIVISIONS):
        for backend in BACKENDS:
            command = [sys.executable, "-m", "benchmarks.whole", "--case", str(divisions), backend]
            out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
            found = json.loads(out.splitlines()[-1])
            rows = [r for r in rows if (r["vertices"], r["backend"]) != (found["vertices"], backend)] + [found]
            print("  ".join(row(found)), flush=True)
            rows.sort(key=lambda r: (r["vertices"], BACKENDS.index(r["backend"])))
            write_report("whole", rows, markdown(HEADER, [row(r) for r in rows]))


if __name__ == "__main__":
    main(sys.argv[1:])
