"""The law that comes with the package: time to evaluate it for a whole sheet, and its errors.

python -m benchmarks.law
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from benchmarks.report import markdown, write_report

STARS, TIMES = 200, 500


def main() -> None:
    law = load_law()
    rng = np.random.default_rng(0)
    rows = []
    for table in law.tables:
        sizes = (rng.uniform(4, 7, STARS), rng.uniform(0.3, 0.5, STARS), rng.uniform(0.8, 1.6, STARS))
        table(*sizes)
        seconds = []
        for _ in range(TIMES):
            start = time.perf_counter()
            table(*sizes)
            seconds.append(time.perf_counter() - start)
        held = law.residuals[f"{table.stretch:g}"]["held_out"]
        errors = {name: held["errors"][name]["rms_percent"] for name in QUANTITY_NAMES}
        row = {"stretch": table.stretch, "median_ms": 1e3 * float(np.median(seconds)), "rms_percent": errors}
        row["membrane_percent"] = 100 * max(
            _off(cell) for cell in held["cells"] if cell["inside"] and not cell["tight"]
        )
        cell_s = law.made["cell_seconds"] / len(law.samples)
        rows.append({**row, "cell_s": cell_s, "solved": float(table.solved.mean())})
    header = ["stretch", f"ms for {STARS} stars", "cells with an answer", "s a cell", "membrane tensor largest %"]
    header += [*(f"{n} rms %" for n in QUANTITY_NAMES)]
    body = [
        [f"{r['stretch']:g}", f"{r['median_ms']:.2f}", f"{100 * r['solved']:.0f} %", f"{r['cell_s']:.1f}"]
        + [f"{r['membrane_percent']:.2f}"]
        + [f"{r['rms_percent'][n]:.2f}" for n in QUANTITY_NAMES]
        for r in rows
    ]
    table_text = markdown(header, body)
    write_report("law", rows, table_text)
    print(table_text)


def _off(cell: dict[str, Any]) -> float:
    """Distance of a held-out cell's membrane stiffness from the law's, over its own size."""
    law, own = (_tensor(cell[which]["a11"], cell[which]["a12"]) for which in ("law", "cell"))
    return float(np.linalg.norm(law - own) / np.linalg.norm(own))


def _tensor(a11: float, a12: float) -> np.ndarray:
    """(4, 4) of an isotropic sheet, acting on (E11, E22, E12, E21)."""
    shear = 0.5 * (a11 - a12)
    return np.array([[a11, a12, 0, 0], [a12, a11, 0, 0], [0, 0, shear, shear], [0, 0, shear, shear]])


if __name__ == "__main__":
    main()
